//! Estimate of the numerical error of an evaluation, for every output at every checkpoint.
//!
//! For an output of the motion with value y at life N [cycles] the estimate is
//!
//!   2.5 d(N) + (s + 1e-4) |y| + |y - l(N)| + c r + |dy/dN| e(N) N
//!
//! - d, largest change of y in the [`Probe`]s around N: time steps, and what had not settled;
//! - s, share of a peak missed between two time steps ([`crate::outputs::Sampling`]);
//! - l, straight line between the simulated lives: interpolation between them;
//! - r, irregularity: the largest distance of a value of y from the straight line through its neighbours, over the simulated lives at which
//!   the motion does not repeat itself, c = 2, and over all of them if there are few since the quasi-static model drives the wear, c = 1;
//!   at least, with c = 2, that at lives where y goes up and down from one to the next, since it depends on details of the bores;
//! - e, relative error of the wear, which displaces the life by e N.
//!
//! To it is added what more control points change (`partial_life.rs`, `probe.rs`), unless the scene declares their number a part of its model.
//!
//! For a wear depth it is the root of the sum of squares of two: the error of wear steps, blocks and control points, from a bore
//! that wears more exactly beside it (`finer_bore.rs`), and twice the relative change of the wear rate in the probes times the depth.
//! No value has a relative error below 1e-10, rounding.
//!
//! Where no cycle repeats the one before, several motions wear the bores (`several_cycles.rs`). Of such a motion y is the mean,
//! and its estimate is `SCATTER` times the standard deviation of single cycles plus s |y|, and |dy/dN| e(N) N if it follows from the bores alone; for a wear depth as many times the standard
//! error of the mean of what the motions have worn takes the place of the change in the probes.
//!
//! Under several operating conditions each has its own estimate of y, and the value of the evaluation is the worst of them
//! (`blocks.rs`). Relative errors of the wear rates add up with the share of the volume that each condition has worn.
//!
//! Valid as an estimate, not as a bound: `MOTION_SAFETY` in `motion_estimate.rs` lists how often it held.
//!
//! # Source
//! Factors: measured here, as stated with each constant. Interpolation: de Boor, A Practical Guide to Splines (1978).

use super::motion_estimate::{MeasuredLives, MotionEstimate};
use super::probe::SURFACES;
use super::run::Run;
use crate::outputs::missed_peak;
use crate::wear::{WornAmounts, wear_output};
use common::scene::{Scene, WearQuantity};
use std::f64::consts::TAU;

/// Highest harmonic of the cycle whose peaks between two time steps count [1]. How much of such an error a probe shows depends on
/// where the steps happen to fall, so it is added.
const HARMONICS: f64 = 15.0;
/// Lower bound of the relative error of a value: rounding of some million steps [1].
const ROUNDING: f64 = 1e-10;

/// Wear of a joint, and its estimated error from wear steps, blocks and control points.
type WornJoint = [WornAmounts; 2];

/// Probes and wear of an evaluation, from which its error is estimated.
#[derive(Clone)]
pub struct ErrorEstimate {
    /// What the cycles under each operating condition show, at least one `(conditions,)`.
    pub conditions: Vec<MotionEstimate>,
    /// Lives at the ends of the blocks [cycles].
    lives: Vec<u32>,
    /// Wear at these lives of every joint of the scene, zero for joints that do not wear `(lives, joints)`.
    worn: Vec<Vec<WornJoint>>,
}

impl ErrorEstimate {
    /// An estimate for a life under this number of `conditions` whose first checkpoint is at `first_checkpoint` [cycles].
    pub(crate) fn new(first_checkpoint: u32, conditions: usize) -> Self {
        let conditions = (0..conditions).map(|_| MotionEstimate::new(first_checkpoint)).collect();
        ErrorEstimate { conditions, lives: vec![], worn: vec![] }
    }

    /// Adds the wear at `life` [cycles], the end of a block, where the joints of `run` have been compared with their copies and were
    /// worn by `amounts` `(joints,)`.
    pub(crate) fn add_wear(&mut self, run: &Run, life: u32, amounts: &[WornAmounts]) {
        let mut worn: Vec<WornJoint> = amounts.iter().map(|&worn| [worn, WornAmounts::default()]).collect();
        for state in &run.islands {
            for (pair, finer) in state.island.pairs().zip(&state.finer) {
                worn[pair.scene_joint()][1] = finer.errors();
            }
        }
        self.lives.push(life);
        self.worn.push(worn);
    }

    /// Error of every output at every checkpoint `(outputs, m)` [SI] under condition number `condition`, given the `histories` there
    /// and the outputs in the simulated cycles; `largest_step` is a fraction of the cycle [1].
    pub(crate) fn errors(
        &self,
        condition: usize,
        scene: &Scene,
        histories: &[Vec<f64>],
        measured: &MeasuredLives,
        largest_step: f64,
    ) -> Vec<Vec<f64>> {
        let phase = TAU * HARMONICS * largest_step;
        let checkpoints = scene.life.checkpoints();
        let mut errors = Vec::with_capacity(scene.outputs.len());
        for (k, output) in scene.outputs.iter().enumerate() {
            let error: Vec<f64> = match output.kind.wear() {
                Some(of) => {
                    let values = checkpoints.iter().zip(&histories[k]);
                    values.map(|(&life, &value)| self.wear_error_within(of, life, value)).collect()
                }
                None => {
                    let values = (&*checkpoints, &*histories[k]);
                    let behind = |life| self.relative_wear_error(scene, life);
                    let missed_peak = missed_peak(&output.kind, phase);
                    let of_motion = &self.conditions[condition];
                    let mut error = of_motion.motion_errors(k, values, measured, missed_peak, behind);
                    if !scene.control_points_of_model {
                        error
                            .iter_mut()
                            .zip(&checkpoints)
                            .for_each(|(e, &life)| *e += of_motion.points_error(k, life));
                    }
                    error
                }
            };
            errors.push(
                error.iter().zip(&histories[k]).map(|(e, value)| e.max(ROUNDING * value.abs())).collect(),
            );
        }
        errors
    }

    /// Largest relative error of the depth of any surface at `life` [1].
    fn relative_wear_error(&self, scene: &Scene, life: u32) -> f64 {
        let surfaces = [WearQuantity::BushingDepth, WearQuantity::JournalDepth];
        let all = (0..scene.joints.len()).flat_map(|joint| surfaces.map(|surface| (surface, joint)));
        let relative = all.map(|(surface, joint)| match self.wear_error((surface, &[joint]), life) {
            (error, depth) if depth > 0.0 => error / depth,
            _ => 0.0,
        });
        relative.fold(0.0, f64::max)
            + self.conditions.iter().map(MotionEstimate::tier_difference).fold(0.0, f64::max)
    }

    /// Error of the value `value` of a quantity of the wear of some joints at `life`, which may be within a block: that at the end of the
    /// block, and of several motions as large a share of the value as there.
    fn wear_error_within(&self, of: (WearQuantity, &[usize]), life: u32, value: f64) -> f64 {
        match self.wear_error(of, life) {
            (error, reached) if reached > 0.0 && self.has_several_motions() => error * value / reached,
            (error, _) => error,
        }
    }

    /// Error of a quantity of the wear of some joints at `life`, and that quantity.
    ///
    /// The error of the wear is how much larger the quantity would be if every surface were off by its own estimate; that of the
    /// time steps is the probes' relative one of the depths. The two are independent: their squares add.
    fn wear_error(&self, (quantity, joints): (WearQuantity, &[usize]), life: u32) -> (f64, f64) {
        let block = self.lives.partition_point(|&end| end < life).min(self.lives.len().saturating_sub(1));
        let Some(worn) = self.worn.get(block) else { return (0.0, 0.0) };
        let value = |amounts: &dyn Fn(usize) -> WornAmounts| {
            wear_output(quantity, joints.iter().map(|&joint| amounts(joint)))
        };
        let now = value(&|j| worn[j][0]);
        let wear = value(&|j| worn[j][0].with(&worn[j][1], |worn, error| worn + error)) - now;
        let rates =
            value(&|j| worn[j][0].with(&self.relative_rate_errors(j, life), |worn, share| worn * share));
        (libm::hypot(wear, rates), now)
    }

    /// Relative errors of the depths of a joint up to `life` from the cycles that were simulated, and of the volume the larger one [1].
    fn relative_rate_errors(&self, joint: usize, life: u32) -> WornAmounts {
        let depths = [0, 1].map(|k| self.relative_rate_error(SURFACES * joint + k, life));
        WornAmounts { depths: [depths; 2], volume: depths[0].max(depths[1]) }
    }

    /// True if several motions wear the bores under one of the conditions.
    fn has_several_motions(&self) -> bool {
        self.conditions.iter().any(MotionEstimate::has_several_motions)
    }

    /// Relative error of the wear rates of a surface up to `life` from the cycles that were simulated [1]: the mean over all conditions,
    /// weighted by the volume that each has worn.
    fn relative_rate_error(&self, surface: usize, life: u32) -> f64 {
        let [condition] = &self.conditions[..] else {
            let worn = |condition: &MotionEstimate| condition.worn.get(surface).copied().unwrap_or(0.0);
            let all: f64 = self.conditions.iter().map(worn).sum();
            let errors = self.conditions.iter().map(|c| (worn(c), c)).filter(|(worn, _)| *worn > 0.0);
            return errors.map(|(worn, c)| worn / all * c.relative_rate_error(surface, life)).sum();
        };
        condition.relative_rate_error(surface, life)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::probe::Probe;

    fn condition(wear: f64, volume: f64) -> MotionEstimate {
        let probe =
            Probe { life: 100, motion: vec![0.0], wear: vec![wear; 4], aperiodic: false, rattles: false };
        let mut condition = MotionEstimate::new(100);
        condition.add_probe(probe);
        condition.worn = vec![volume; 4];
        condition
    }

    fn estimate(conditions: Vec<MotionEstimate>) -> ErrorEstimate {
        let bore = |depth| WornAmounts { depths: [[depth, 0.0], [0.0; 2]], volume: 0.0 };
        let worn = [(10.0, 0.1), (9.0, 1.3)].map(|(depth, error)| [bore(depth), bore(error)]).to_vec();
        ErrorEstimate { conditions, lives: vec![0, 100], worn: vec![vec![], worn] }
    }

    #[test]
    fn wear_error_joins_that_of_the_deepest_joint_with_the_rate() {
        // The second joint might be the deepest, by 0.3; the rate is off by 2 %, counted twice.
        let estimate = estimate(vec![condition(0.02, 0.0)]);
        let (error, depth) = estimate.wear_error((WearQuantity::LargestDepth, &[0, 1]), 70);
        assert_eq!(depth, 10.0);
        assert!((error - 0.3_f64.hypot(0.4)).abs() < 1e-12, "{error}");
    }

    #[test]
    fn a_condition_counts_with_the_volume_that_it_has_worn() {
        let rates = |a, b| estimate(vec![condition(0.02, a), condition(0.06, b)]).relative_rate_error(0, 70);
        assert!((rates(3.0, 1.0) - 2.0 * 0.03).abs() < 1e-12);
        assert_eq!((rates(1.0, 0.0), rates(0.0, 0.0)), (0.04, 0.0));
    }
}
