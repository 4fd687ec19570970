//! Error of the depth from the spacing of the control points: the same bore with twice as many.
//!
//! Wear is shared out over the control points by their hat functions, which keeps the worn volume but smears a
//! contact arc that is not much wider than the spacing. A second profile with twice as many control points wears
//! under the same contact histories, block by block. The estimate at life n is
//!
//! e(n) = 2 max over the blocks that end in [n/4, n] of |max h - max h_f|
//!
//! with the depths h [m] of the bore and h_f [m] of its finer copy. An early difference heals as a scar widens its
//! own arc, and the two may cross, so that neither the last nor the largest difference would do. A bore with fewer
//! control points instead would cost less, but its difference depends on how its points happen to lie to the arc.
//!
//! # Source
//! Comparison with a finer grid, without the extrapolation of Richardson (1911), Phil. Trans. R. Soc. A 210,
//! 307-357; `scar_is_converged_within_the_stated_spacing_error` compares with finer control points.

use super::archard::WearRate;
use super::history::ContactHistory;
use super::step::{WearStep, WearStepStats};
use crate::bore::Profile;
use crate::contact::Contact;
use crate::extremum::largest;

/// Error over the largest difference [1]: 2 where it halves with the spacing, as at the edge of a scar, 4/3 where the
/// profile is smooth. Of 768 depths under random loads (`stated_spacing_errors_of_random_loads`) 95 % are within the estimate; with
/// 1.5 it would be 85 %.
const SAFETY: f64 = 2.0;
/// Share of the life behind over which differences count [1].
const RECENT: f64 = 0.75;
/// Tolerance of the copy's wear steps over that of the bore, and its upper bound [1]: at 0.01 they err by 0.1 %
/// (`the_local_law_takes_tight_tolerances_and_keeps_them`).
const LOOSER: f64 = 4.0;
const LOOSEST: f64 = 0.01;

/// The bore of one joint, worn at more control points.
#[derive(Debug, Clone)]
pub struct FinerBore {
    rate: WearRate,
    step: WearStep,
    /// Depth at its control points `(points,)` [m].
    depth: Vec<f64>,
    /// Wear of the blocks over which its wear steps failed [m].
    missed: f64,
    /// Life [cycle] and difference of the largest depths [m] at the end of each block.
    differences: Vec<(f64, f64)>,
}

impl FinerBore {
    /// Copy of the unworn bore `profile` of a joint with this wear coefficient [1/Pa], width [m] and contact,
    /// whose wear steps have the tolerance `tolerance` [1].
    pub(crate) fn new(
        coefficient: f64,
        width: f64,
        contact: &Contact,
        profile: &Profile,
        tolerance: f64,
    ) -> Self {
        let points = 2 * profile.points();
        let finer = Profile::round(profile.initial_radius(), points);
        FinerBore {
            rate: WearRate::new(coefficient, width, contact, &finer),
            step: WearStep::new(points, (LOOSER * tolerance).min(LOOSEST).max(tolerance)),
            depth: vec![0.0; points],
            missed: 0.0,
            differences: Vec::new(),
        }
    }

    /// Wears the copy over a block of `cycles` under `history`, in which the largest depth of the bore grows to
    /// `deepest` by `growth` [m]. A block that the copy's wear steps do not manage counts as error as a whole.
    pub(crate) fn advance(&mut self, history: &ContactHistory, cycles: f64, deepest: f64, growth: f64) {
        self.rate.freeze(history);
        let mut uncounted = WearStepStats::default();
        let step = &mut self.step;
        if step.advance(&mut self.rate, &mut self.depth, cycles, &[], |_, _| {}, &mut uncounted).is_err() {
            self.missed += growth;
        }
        let life = self.differences.last().map_or(0.0, |(life, _)| *life) + cycles;
        self.differences.push((life, (deepest - largest(self.depth.iter().copied())).abs()));
    }

    /// Estimated error of the largest depth of the bore [m].
    pub(crate) fn spacing_error(&self) -> f64 {
        let now = self.differences.last().map_or(0.0, |(life, _)| *life);
        let recent = self.differences.iter().filter(|(life, _)| *life >= (1.0 - RECENT) * now);
        SAFETY * largest(recent.map(|(_, difference)| *difference)) + self.missed
    }
}
