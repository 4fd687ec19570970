//! The published active learning, with none of this program's additions, as a plan over the same parts.
//!
//! 1. The population has 100 000 points; 200 of them, nearest to a Latin hypercube, are the initial design of every limit state.
//! 2. Every limit state has a Kriging model of its own with a Gaussian kernel, a constant trend and no noise.
//! 3. With [`LearningFunction::U`] the point of least U_s joins the design of its limit state s, one for each limit state with
//!    min U_s < 2. With [`LearningFunction::Coupled`] the point of least U_c, weighted by the dominance k, joins all designs.
//! 4. Learning stops where U >= 2 everywhere; failures are counted by the predicted means.
//! 5. A coefficient of variation of P_f of 5 % or more asks for a larger population.
//!
//! U is taken over the life, as the publication does not name one: U_s(x) = min over n of U_s(x, n). Its last criterion,
//! |R_k - R_(k-1000)| / R_k < 0.02 with k in cycles, is a property of the reliability, which falls by more than that over
//! 1000 cycles wherever it falls fast; no learning changes it, so it is printed and not waited for.
//!
//! # Source
//! Cui et al. (2026), China Mechanical Engineering 37(6), 1472-1485, doi 10.3969/j.issn.1004-132X.2026.06.020, section 3.3, after
//! Echard, Gayton, Lemaire (2011), AK-MCS, Structural Safety 33(2).

use super::requests::PendingSample;
use super::{Assessment, Campaign, Settings};
use crate::statistics::learning::{Classification, LearningFunction, UNCERTAIN};
use crate::statistics::surrogate::{FormSettings, Kernel, StatedErrors, Trend};
use rayon::prelude::*;

/// Points of the initial design.
const INITIAL: usize = 200;
/// Points of the population.
const POPULATION: usize = 100_000;
/// Budget of evaluations: more than twice the published number.
const BUDGET: usize = 2000;
/// Cycles between the two reliabilities of the printed criterion.
const APART: u32 = 1000;

impl Settings {
    /// Sets what the published method prescribes.
    pub fn make_as_published(&mut self) {
        (self.samples, self.initial, self.batch, self.max_evaluations) = (POPULATION, INITIAL, 1, BUDGET);
        self.learning = LearningFunction::U;
        self.forms = FormSettings { kernel: Some(Kernel::Gaussian), trend: Some(Trend::Constant) };
        self.stated_errors = StatedErrors::Ignored;
    }
}

impl Campaign {
    /// The points that join the designs next, see step 3 of the head of this file.
    pub(super) fn choose_as_published(&mut self) -> Vec<PendingSample> {
        let Self { classified, requests, plan, assessment, .. } = self;
        let assessment = assessment.as_mut().expect("all outcomes have been assessed");
        if plan.settings.learning == LearningFunction::Coupled {
            let Assessment { selection, modes, .. } = assessment;
            return selection.choose(modes).into_iter().map(|j| requests.take(classified, j)).collect();
        }
        let mut chosen = Vec::new();
        for (s, mode) in assessment.modes.iter().enumerate() {
            if let Some((j, u)) = least_u(mode, &requests.requested)
                && u < UNCERTAIN
            {
                chosen.push(PendingSample { mode: Some(s), ..requests.take(classified, j) });
            }
        }
        chosen
    }

    /// The least U [1] over limit states and the points that are not requested yet; infinite without any.
    pub(super) fn least_u_as_published(&self, assessment: &Assessment) -> f64 {
        let of_mode = |mode: &Classification| least_u(mode, &self.requests.requested).map(|(_, u)| u);
        assessment.modes.iter().filter_map(of_mode).fold(f64::INFINITY, f64::min)
    }
}

/// The point with the smallest U over the life that is not `closed` `(N,)`, with this U [1]; the first at a tie.
fn least_u(mode: &Classification, closed: &[bool]) -> Option<(usize, f64)> {
    let of_point = |j: usize| (j, (0..mode.grid()).map(|n| mode.u(j, n)).fold(f64::INFINITY, f64::min));
    let open = (0..closed.len()).into_par_iter().filter(|j| !closed[*j]);
    open.map(of_point).min_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)))
}

/// |R_k - R_(k-1000)| / R_k [1] at checkpoint `k`, from the failure shares `(m,)` at `checkpoints` `(m,)` [cycles]; `None` without a
/// checkpoint 1000 cycles earlier, or where nothing survives.
pub(super) fn change_over_1000_cycles(failed: &[f64], checkpoints: &[u32], k: usize) -> Option<f64> {
    let earlier = checkpoints.iter().position(|cycles| cycles + APART == checkpoints[k])?;
    let (now, before) = (1.0 - failed[k], 1.0 - failed[earlier]);
    (now > 0.0).then(|| (before - now).abs() / now)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_u_is_over_the_life_and_the_open_points() {
        let mode = Classification {
            mean: vec![0.0, 0.9, 0.5, 0.6, 0.99, 1.2],
            variance_factor: vec![1.0, 0.25, 1.0],
            sigma: vec![1.0, 0.5],
            first_failure: vec![2; 3],
            threshold: 1.0,
        };
        // U: 0.2 at point 0, 1.0 at point 1 (0.5 / 0.5), 0.01 at point 2.
        assert_eq!(least_u(&mode, &[false; 3]).map(|(j, _)| j), Some(2));
        let (j, u) = least_u(&mode, &[true, false, true]).unwrap();
        assert!(j == 1 && (u - 1.0).abs() < 1e-12);
        assert_eq!(least_u(&mode, &[true; 3]), None);
    }

    #[test]
    fn the_printed_criterion_compares_lives_and_not_rounds() {
        let (failed, checkpoints) = ([0.0, 0.1, 0.4], [500, 1000, 1500]);
        let change = change_over_1000_cycles(&failed, &checkpoints, 2).unwrap();
        assert!((change - 0.4 / 0.6).abs() < 1e-12);
        assert_eq!(change_over_1000_cycles(&failed, &checkpoints, 1), None);
        assert_eq!(change_over_1000_cycles(&[0.0, 0.5, 1.0], &checkpoints, 2), None);
    }
}
