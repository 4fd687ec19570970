//! Stopping rules of active learning, and the guards against a stop on a surrogate with too small predicted
//! variances.
//!
//! (a) [`Rule::Learning`]: U_c >= 2 at every point, and no curve changed by more than 2 % (relative to the
//!     smaller of R and P_f at the governing checkpoint) since the round before.
//! (b) [`Rule::Error`]: the estimated surrogate error of every curve at every checkpoint is below 0.006 (so
//!     that it is within 0.01 with probability 0.9), that of the system at the governing checkpoint also
//!     below 2 % of the smaller of R and P_f, that of every curve below 15 % of its P_f at early lives, where P_f is between
//!     0.004 and 0.04 and the error moves the life by more than 1 %, and no curve changed by more than 0.01 absolute or 5 % relative. This rule ends studies of many variables, where a few of 100 000 points stay uncertain for
//!     ever although their sum is known. Beside the steps of an output ([`super::learned_threshold`]), which the
//!     intervals contain and no simulation removes, a quarter of their shift takes the place of these bounds.
//!
//! Guards: at least 30 results; the rule is met with a fit from several starts to at least nine tenths of the
//! results; and it holds in every round until two rounds have passed and enough new results have been received:
//! eight and two for every variable, 24 at most, 16 of more than twelve variables, whose gaps no number of points fills;
//! where failures are rare eight and four for every variable, forty at most, and forty before the population becomes
//! one near the limit. Half as many suffice where the population only grew. Three of four explore
//! ([`super::explore`], [`super::widest_gap`], [`super::farthest`]), and none of these may contradict its prediction. A stop without any predicted failure is stated by the report.
//!
//! # Source
//! Rule (a): Echard, Gayton, Lemaire (2011), AK-MCS, Structural Safety 33(2); the change between rounds is this project's own.
//! Stops by an estimated error: Wang, Shafieezadeh (2019), ESC: an efficient error-based stopping criterion
//! for kriging-based reliability analysis methods, Structural and Multidisciplinary Optimization 59. The
//! guards and the numbers are this project's own, from the published problems of
//! `coordinator/doc/validation.md`.

use super::SURROGATE_SAFETY;
use crate::reliability::REACH;
use std::ops::Range;

/// Surrogate error, and change of a curve between rounds, over the shift by steps, below which they add nothing to an interval that
/// contains the steps [1].
const BESIDE_STEPS: f64 = 0.25;

/// Failure shares of a curve between which its life is early [1]: the lower one is below that of a life at R = 0.99, at the upper
/// one the bound on the absolute error begins to be the stricter one.
pub const EARLY: (f64, f64) = (4e-3, 4e-2);
/// Variables beyond which exploring fills no gaps.
const MOST_FILLED: usize = 12;
/// Of as many results over which a rule must hold, one is chosen by the learning function and the others explore.
const TURN: usize = 4;

/// Bounds of the stopping rules.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StoppingTargets {
    /// Least U_c of all points, rule (a) [1].
    pub min_u: f64,
    /// Largest relative change of a curve between rounds, rule (a) [1].
    pub relative_change: f64,
    /// Largest surrogate error of any curve, rule (b) [1].
    pub error: f64,
    /// Largest surrogate error of the system at the governing checkpoint over the smaller of R and P_f, rule
    /// (b) [1].
    pub relative_error: f64,
    /// Largest surrogate error of any curve over its P_f at early lives, rule (b) [1].
    pub early_error: f64,
    /// Largest absolute change of a curve between rounds, rule (b) [1].
    pub change: f64,
    /// Largest relative change of a curve between rounds, rule (b) [1].
    pub relative_change_by_error: f64,
    /// Least number of results before any stop.
    pub least_points: usize,
    /// Number of rounds over which a rule must hold.
    pub hold: usize,
    /// Least number of new results over which a rule must hold, see [`StoppingTargets::points_to_hold`].
    pub hold_points: usize,
    /// Coefficient of variation of P_f above which the population is enlarged [1].
    pub cov: f64,
}

impl Default for StoppingTargets {
    fn default() -> Self {
        Self {
            min_u: 2.0,
            relative_change: 0.02,
            error: 0.006,
            relative_error: 0.02,
            early_error: 0.15,
            change: 0.01,
            relative_change_by_error: 0.05,
            least_points: 30,
            hold: 2,
            hold_points: 8,
            cov: 0.05,
        }
    }
}

/// Figures of one round that the stopping rules use.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Figures {
    /// Number of results that the surrogates use.
    pub points: usize,
    /// Smallest U_c of the points that were not requested [1].
    pub min_u: f64,
    /// Largest absolute change of any curve since the round before [1]; `None` in the first round.
    pub change: Option<f64>,
    /// Largest estimated surrogate error of any curve [1].
    pub error: f64,
    /// Estimated surrogate error of the system at the governing checkpoint [1].
    pub governing_error: f64,
    /// The smaller of R and P_f of the system at the governing checkpoint [1].
    pub governing_share: f64,
    /// Largest estimated surrogate error of any curve over its P_f, where that is within [`EARLY`] [1].
    pub early_error: f64,
    /// Shift of the system's curve at the governing checkpoint by the steps of outputs, 0 without steps [1].
    pub steps: f64,
}

/// Stopping rule of learning.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rule {
    /// Rule (a): every point is classified with certainty.
    Learning,
    /// Rule (b): the error of the curves is small enough.
    Error,
}

impl StoppingTargets {
    /// The targets for a half width of the whole 95 % interval of every R(n) [1], half of whose square is left to the surrogates; the
    /// relative ones follow in proportion.
    pub fn from_half_width(half_width: f64) -> Self {
        let error = half_width * 0.5_f64.sqrt() / (REACH * SURROGATE_SAFETY);
        let default = Self::default();
        let scale = error / default.error;
        Self {
            error,
            relative_error: default.relative_error * scale,
            early_error: default.early_error * scale,
            ..default
        }
    }

    /// Number of new results over which a rule must hold, with `d` variables and for `rare` failures or not:
    /// most of them explore, and there are more directions to explore the more variables there are.
    pub fn points_to_hold(&self, d: usize, rare: bool) -> usize {
        let least = self.hold_points;
        let by_dimension = if d > MOST_FILLED { 2 * least } else { (least + 2 * d).min(3 * least) };
        if rare { by_dimension.max(least + 4 * d).min(5 * least) } else { by_dimension }
    }

    /// Number of new results over which a rule must hold before the population is replaced by one near the limit: until then what seems
    /// rare may be a region in a gap of the bulk.
    pub fn points_before_condition(&self) -> usize {
        5 * self.hold_points
    }

    /// The first rule that these figures meet, if any.
    pub fn met(&self, figures: &Figures) -> Option<Rule> {
        let change = figures.change.filter(|_| figures.points >= self.least_points)?;
        let relative = if change == 0.0 { 0.0 } else { change / figures.governing_share };
        if figures.min_u >= self.min_u && relative < self.relative_change {
            return Some(Rule::Learning);
        }
        // No further simulation removes the steps of an output from the interval.
        let enough = BESIDE_STEPS * figures.steps;
        let accurate = figures.error <= self.error.max(enough)
            && figures.governing_error <= (self.relative_error * figures.governing_share).max(enough)
            && (figures.early_error <= self.early_error || figures.steps > 0.0);
        let settled = change <= enough || change <= self.change && relative <= self.relative_change_by_error;
        (accurate && settled).then_some(Rule::Error)
    }
}

/// Counts the rounds and results over which a rule has been met without interruption.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Stopping {
    /// Rounds in which a rule was met, without interruption.
    held: usize,
    /// Number of results in the first of them.
    since: usize,
    /// True if a rule has held before, over a smaller population.
    held_before: bool,
}

impl Stopping {
    /// Records a round with `points` results; returns true once a rule has held over the rounds and results
    /// `needed`, half as many results for a population that only grew.
    pub fn record_round(&mut self, met: Option<Rule>, points: usize, needed: (usize, usize)) -> bool {
        let (rounds, needed) = needed;
        if met.is_none() {
            self.held = 0;
            return false;
        }
        if self.held == 0 {
            self.since = points;
        }
        self.held += 1;
        let needed = if self.held_before { needed.div_ceil(2) } else { needed };
        self.held >= rounds && points - self.since >= needed
    }

    /// True if a rule was met in the last round.
    pub fn is_holding(&self) -> bool {
        self.held > 0
    }

    /// The exploring points among the next `count`, after `points` results, as their numbers since the rule was met: of
    /// every four results the first three; none while no rule is met.
    pub fn exploring(&self, points: usize, count: usize) -> Range<usize> {
        if !self.is_holding() {
            return 0..0;
        }
        let since = points - self.since;
        let explored = |results: usize| results - results / TURN;
        explored(since)..explored(since + count)
    }

    /// Restarts the count, after a contradicted prediction or for another population; over half as many results if that is `similar`.
    pub fn reset(&mut self, similar: bool) {
        *self = Self { held_before: similar, ..Self::default() };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figures() -> Figures {
        Figures {
            points: 40,
            min_u: 2.5,
            change: Some(1e-5),
            error: 1e-5,
            governing_error: 1e-5,
            governing_share: 2e-3,
            early_error: 0.1,
            steps: 0.0,
        }
    }

    #[test]
    fn each_condition_can_forbid_the_stop() {
        let targets = StoppingTargets::default();
        assert_eq!(targets.met(&figures()), Some(Rule::Learning));
        assert_eq!(targets.met(&Figures { min_u: 1.0, ..figures() }), Some(Rule::Error));
        assert_eq!(targets.met(&Figures { points: 29, ..figures() }), None);
        assert_eq!(targets.met(&Figures { change: None, ..figures() }), None);
        assert_eq!(targets.met(&Figures { change: Some(2e-4), ..figures() }), None);
        let uncertain = Figures { min_u: 1.0, ..figures() };
        assert_eq!(targets.met(&Figures { governing_error: 5e-5, ..uncertain }), None);
        assert_eq!(targets.met(&Figures { error: 7e-3, ..uncertain }), None);
        assert_eq!(targets.met(&Figures { early_error: 0.16, ..uncertain }), None);
        // Beside the steps of an output, which the interval contains, a smaller error gains nothing.
        let steps = Figures { error: 7e-3, governing_error: 7e-3, change: Some(7e-3), ..uncertain };
        assert_eq!(targets.met(&Figures { steps: 0.02, ..steps }), None);
        assert_eq!(targets.met(&Figures { steps: 0.03, ..steps }), Some(Rule::Error));
    }

    #[test]
    fn a_rule_must_hold_for_two_rounds_and_twelve_points_running() {
        let targets = (2, StoppingTargets::default().points_to_hold(2, false));
        let mut stopping = Stopping::default();
        assert!(!stopping.record_round(Some(Rule::Error), 40, targets));
        assert!(!stopping.record_round(None, 50, targets));
        assert_eq!(stopping.exploring(50, 1), 0..0);
        assert!(!stopping.record_round(Some(Rule::Error), 56, targets));
        assert!(!stopping.record_round(Some(Rule::Error), 63, targets));
        // Three of four points explore, whether requested one by one or together.
        let one_by_one = [56, 57, 58, 59, 60].map(|points| stopping.exploring(points, 1));
        assert_eq!(one_by_one, [0..1, 1..2, 2..3, 3..3, 3..4]);
        assert_eq!((stopping.exploring(56, 5), stopping.exploring(57, 4)), (0..4, 1..4));
        assert!(stopping.record_round(Some(Rule::Learning), 68, targets));
        // Over a larger population half as many; after a contradiction all of them.
        stopping.reset(true);
        assert!(!stopping.is_holding() && !stopping.record_round(Some(Rule::Error), 68, targets));
        assert!(stopping.record_round(Some(Rule::Error), 74, targets));
        stopping.reset(false);
        assert!(!stopping.record_round(Some(Rule::Error), 76, targets));
        assert!(!stopping.record_round(Some(Rule::Error), 84, targets));
    }

    #[test]
    fn more_variables_and_rare_failures_need_more_points() {
        let targets = StoppingTargets::default();
        let needed = [1, 4, 6, 15, 100].map(|d| targets.points_to_hold(d, false));
        assert_eq!(needed, [10, 16, 20, 16, 16]);
        assert_eq!([1, 2, 6, 15, 100].map(|d| targets.points_to_hold(d, true)), [12, 16, 32, 40, 40]);
        assert_eq!(targets.points_before_condition(), 40);
        assert_eq!(StoppingTargets { hold_points: 0, ..targets }.points_to_hold(9, true), 0);
    }

    /// The points of the initial design do not count: the first round has no change to meet a rule with, and the
    /// count begins with the first round that meets one.
    #[test]
    fn initial_points_do_not_count_for_the_hold() {
        let (targets, mut stopping) = (StoppingTargets::default(), Stopping::default());
        let first = Figures { points: 120, change: None, ..figures() };
        let needed = (2, targets.points_to_hold(2, false));
        assert!(!stopping.record_round(targets.met(&first), 120, needed) && !stopping.is_holding());
        let second = Figures { points: 126, ..figures() };
        assert!(!stopping.record_round(targets.met(&second), 126, needed));
        assert!(!stopping.record_round(targets.met(&second), 132, needed));
        assert!(stopping.record_round(targets.met(&second), 138, needed));
    }
}
