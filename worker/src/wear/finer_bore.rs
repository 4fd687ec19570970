//! Error of the depth that wear steps, blocks and control points leave: a second bore, worn more exactly.
//!
//! Three approximations separate the depth h [m] of a bore from that of its contact histories: sub-steps of finite
//! length, a history held fixed over a block (`step.rs`), and wear shared out over control points by hat functions,
//! which smears a contact arc that is not much wider than their spacing. A second profile wears beside the first, with
//! twice as many control points, wear steps of half the tolerance, and under each history over half of the block before it and half
//! of the block after it, which is of second order in the length of the blocks where the first is of first order. With
//! its depths h_f [m], the estimate at life n is
//!
//! e(n) = 2 max over the ends of blocks and the checkpoints up to the end of the block of n of |max h - max h_f|
//!
//! The two may cross, so that the last difference would not do; with the differences since n/4 alone, nine of ten depths of a four-bar
//! were within the stated error late in life. Sums of the local errors of sub-steps and blocks would not do either: most of them heal
//! too, and were they added up, they would state ten and more times the true error. A bore with fewer control points
//! would cost less, but its difference depends on how its points happen to lie to the arc.
//!
//! A journal that wears has its copy too, in that of its bore; the same estimate is made of its largest depth and of the worn volume. So have the
//! faces of guides and of their sliders.
//!
//! # Source
//! Comparison with a finer grid, without the extrapolation of Richardson (1911), Phil. Trans. R. Soc. A 210,
//! 307-357; `stated_wear_errors_of_random_loads` compares with a converged bore.

use super::{StepTolerance, WearLaw, WearStep, WearStepStats, WornAmounts};

/// Error over the largest difference [1]: 2 where it halves with the spacing, as at the edge of a scar, 4/3 where the
/// profile is smooth.
const SAFETY: f64 = 2.0;
/// Tolerance of the copy's wear steps over that of the bore, and its lower bound [1]: at 0.01 they err by 0.1 %
/// (`the_local_law_takes_tight_tolerances_and_keeps_them`), far less than the spacing of the control points.
const TIGHTER: f64 = 0.5;
const TIGHTEST: f64 = 0.01;

/// The bore of one joint, or the faces of one guide, worn more exactly.
#[derive(Debug, Clone)]
pub struct FinerBore<L> {
    rate: L,
    step: WearStep,
    /// Depths of the copy `(depths,)` [m], up to the middle of the last block.
    depth: Vec<f64>,
    /// Cycles from there to the end of that block.
    behind: f64,
    /// Wear of the joint there.
    worn: WornAmounts,
    /// True if the wear steps to the middle of that block failed.
    failed: bool,
    /// Wear of the half blocks over which wear steps failed.
    missed: WornAmounts,
    /// Largest difference of the two at the ends of the blocks and at the marks so far.
    largest: WornAmounts,
    /// Marks within the block behind, and those of the next one, counted from its start [cycle].
    marks: Vec<f64>,
    pub(crate) next_marks: Vec<f64>,
    /// Wear of the joint at the marks within the next block.
    pub next_marked: Vec<WornAmounts>,
    /// Cycles of the next block, and the wear of the joint at its start; `None` if the copy has been worn under its history.
    due: Option<(f64, WornAmounts)>,
    /// Wear of the joint at the marks within the block behind, and that of the copy at those it has passed.
    marked: Vec<WornAmounts>,
    passed: Vec<WornAmounts>,
}

impl<L: WearLaw> FinerBore<L> {
    /// An unworn copy with this many `depths` and this `rate`, of surfaces whose wear steps have this rule.
    pub(crate) fn new(rate: L, depths: usize, tolerance: StepTolerance) -> Self {
        let tolerance = tolerance.map(|tolerance| (TIGHTER * tolerance).max(TIGHTEST));
        FinerBore {
            rate,
            step: WearStep::new(depths, tolerance),
            depth: vec![0.0; depths],
            behind: 0.0,
            worn: WornAmounts::default(),
            failed: false,
            missed: WornAmounts::default(),
            largest: WornAmounts::default(),
            marks: Vec::new(),
            next_marks: Vec::new(),
            next_marked: Vec::new(),
            due: None,
            marked: Vec::new(),
            passed: Vec::new(),
        }
    }

    /// Freezes the contact history measured where the joint is `worn`, at the end of the block behind, for [`FinerBore::advance`]; the next
    /// block has these `cycles`, zero at the end of life.
    pub(crate) fn freeze(&mut self, history: &L::History, cycles: f64, worn: WornAmounts) {
        self.rate.freeze(history);
        self.due = Some((cycles, worn));
    }

    /// Compares the copy with the bore at the end of the block behind, and wears it to the middle of the next one, under the history frozen
    /// last; nothing is left to do where that has been done.
    pub(crate) fn advance(&mut self) {
        let Some((cycles, worn)) = self.due.take() else { return };
        let mut uncounted = WearStepStats::default();
        let sizes = self.rate.sizes();
        let (behind, half) = (self.behind, 0.5 * cycles);
        let growth = worn.with(&self.worn, |now, before| now - before);
        // Wear steps that failed miss the half blocks on both sides of a history.
        let miss = |missed: f64, growth: f64| missed + 0.5 * growth;
        if self.failed {
            self.missed = self.missed.with(&growth, miss);
        }
        // Marks in the second half of the block behind, its end, and marks in the first half of the next one.
        let late = self.marks[self.passed.len()..].iter().map(|mark| mark - behind);
        let next_marks = std::mem::take(&mut self.next_marks);
        let early = next_marks.iter().filter(|mark| **mark <= half).map(|mark| behind + mark);
        let marks: Vec<f64> = late.chain([behind]).chain(early).collect();
        let mut copies = vec![sizes.amounts(&self.depth); marks.len()];
        let to_compare = |mark: usize, depths: [&[f64]; 2]| copies[mark] = sizes.amounts_at(depths);
        let (step, rate) = (&mut self.step, &mut self.rate);
        let advanced = step.advance(rate, &mut self.depth, behind + half, &marks, to_compare, &mut uncounted);
        rate.release();
        self.failed = advanced.is_err();
        if self.failed {
            self.missed = self.missed.with(&growth, miss);
        }
        let difference =
            |worn: &WornAmounts, copy: &WornAmounts| worn.with(copy, |worn, copy| (worn - copy).abs());
        let early = copies.split_off(self.marks.len() - self.passed.len() + 1);
        let end = copies.pop().unwrap_or_default();
        self.passed.append(&mut copies);
        let pairs = self.marked.iter().zip(&self.passed).chain([(&worn, &end)]);
        for (worn, copy) in pairs {
            self.largest = self.largest.with(&difference(worn, copy), f64::max);
        }
        (self.marks, self.passed, self.marked) = (next_marks, early, std::mem::take(&mut self.next_marked));
        self.behind = half;
        self.worn = worn;
    }

    /// Depths of the copy at the end of the block behind, where this contact `history` was measured `(depths,)` [m]; `None` if the wear
    /// steps fail.
    pub(crate) fn depth_at_end(&self, history: &L::History) -> Option<Vec<f64>>
    where
        L: Clone,
    {
        let FinerBore { mut rate, mut step, mut depth, behind, .. } = self.clone();
        rate.freeze(history);
        step.advance(&mut rate, &mut depth, behind, &[], |_, _| {}, &mut WearStepStats::default()).ok()?;
        Some(depth)
    }

    /// Estimated error of the wear of the joint where it was compared last.
    pub(crate) fn errors(&self) -> WornAmounts {
        self.largest.with(&self.missed, |difference, missed| SAFETY * difference + missed)
    }
}
