//! Error of the depth that wear steps, blocks and control points leave: a second bore, worn more exactly.
//!
//! Three approximations separate the depth h [m] of a bore from that of its contact histories: sub-steps of finite
//! length, a history held fixed over a block (`step.rs`), and wear shared out over control points by hat functions,
//! which smears a contact arc that is not much wider than their spacing. A second profile wears beside the first, with
//! twice as many control points, wear steps of half the tolerance, and under each history over half of the block before it and half
//! of the block after it, which is of second order in the length of the blocks where the first is of first order. With
//! its depths h_f [m], the estimate at life n is
//!
//! e(n) = 2 max over the blocks that end in [n/4, n] of |max h - max h_f|
//!
//! An early difference heals as a scar widens its own arc, and the two may cross, so that neither the last nor the
//! largest difference would do. Sums of the local errors of sub-steps and blocks would not do either: most of them heal
//! too, and were they added up, they would state ten and more times the true error. A bore with fewer control points
//! would cost less, but its difference depends on how its points happen to lie to the arc.
//!
//! # Source
//! Comparison with a finer grid, without the extrapolation of Richardson (1911), Phil. Trans. R. Soc. A 210,
//! 307-357; `stated_wear_errors_of_random_loads` compares with a converged bore.

use super::archard::WearRate;
use super::history::ContactHistory;
use super::step::{WearStep, WearStepStats};
use crate::bore::Profile;
use crate::contact::Contact;
use crate::extremum::largest;

/// Error over the largest difference [1]: 2 where it halves with the spacing, as at the edge of a scar, 4/3 where the
/// profile is smooth.
const SAFETY: f64 = 2.0;
/// Share of the life behind over which differences count [1].
const RECENT: f64 = 0.75;
/// Tolerance of the copy's wear steps over that of the bore, and its lower bound [1]: at 0.01 they err by 0.1 %
/// (`the_local_law_takes_tight_tolerances_and_keeps_them`); below it, narrow arcs under the local law take a thousand times
/// as many sub-steps at twice the control points.
const TIGHTER: f64 = 0.5;
const TIGHTEST: f64 = 0.01;

/// The bore of one joint, worn more exactly.
#[derive(Debug, Clone)]
pub struct FinerBore {
    rate: WearRate,
    step: WearStep,
    /// Depth at its control points `(points,)` [m], up to the middle of the last block.
    depth: Vec<f64>,
    /// Cycles from there to the end of that block.
    behind: f64,
    /// Life at the end of that block [cycles].
    life: f64,
    /// Largest depth of the bore there [m].
    deepest: f64,
    /// True if the wear steps to the middle of that block failed.
    failed: bool,
    /// Wear of the half blocks over which wear steps failed [m].
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
            step: WearStep::new(points, (TIGHTER * tolerance).max(TIGHTEST)),
            depth: vec![0.0; points],
            behind: 0.0,
            life: 0.0,
            deepest: 0.0,
            failed: false,
            missed: 0.0,
            differences: Vec::new(),
        }
    }

    /// Compares the copy with the bore at the end of the block behind, where the largest depth of the bore is `deepest`
    /// [m] and the contact history was measured, and wears it to the middle of the next block of `cycles`, which is
    /// zero at the end of life.
    pub(crate) fn advance(&mut self, history: &ContactHistory, cycles: f64, deepest: f64) {
        self.rate.freeze(history);
        let mut uncounted = WearStepStats::default();
        let (behind, mut copy) = (self.behind, largest(self.depth.iter().copied()));
        let growth = deepest - self.deepest;
        // Wear steps that failed miss the half blocks on both sides of a history.
        self.missed += if self.failed { 0.5 * growth } else { 0.0 };
        let to_compare = |_: usize, depth: &[f64]| copy = largest(depth.iter().copied());
        let (step, rate) = (&mut self.step, &mut self.rate);
        let advanced =
            step.advance(rate, &mut self.depth, behind + 0.5 * cycles, &[behind], to_compare, &mut uncounted);
        self.failed = advanced.is_err();
        self.missed += if self.failed { 0.5 * growth } else { 0.0 };
        self.differences.push((self.life, (deepest - copy).abs()));
        self.life += cycles;
        self.behind = 0.5 * cycles;
        self.deepest = deepest;
    }

    /// Estimated error of the largest depth of the bore where it was compared last [m].
    pub(crate) fn error(&self) -> f64 {
        let now = self.differences.last().map_or(0.0, |(life, _)| *life);
        let recent = self.differences.iter().filter(|(life, _)| *life >= (1.0 - RECENT) * now);
        SAFETY * largest(recent.map(|(_, difference)| *difference)) + self.missed
    }
}
