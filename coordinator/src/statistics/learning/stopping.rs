//! When learning may stop, and the guards against stopping on a surrogate that is merely sure of itself.
//!
//! (a) `Learning`: every U_c >= 2, and no curve changed by more than 2 % (relative to the smaller of R and P_f at the
//!     governing checkpoint) since the round before.
//! (b) `Error`: the estimated surrogate error of every curve at every checkpoint is below 0.006 (so that it is within
//!     0.01 with nine chances in ten), that of the system at the governing checkpoint also below 2 % of the smaller of
//!     R and P_f, and no curve changed by more than 0.01 absolute or 5 % relative. This ends studies of many variables, where a few of 100 000 points stay uncertain
//!     for ever though their sum is known.
//!
//! Guards: at least 30 evaluated points; the rule is met with a fit from several starts to all but a tenth of the results; and in every round until at
//! least two have passed and eight new points have been simulated (four where the population only grew), half of them where the surrogates know least ([`super::explore`]), none of which
//! surprised them. Whether any failure is predicted at all is said in words by whoever reports the stop.

/// Bounds of the stopping rules.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Targets {
    /// Smallest coupled learning function, rule (a) [1].
    pub min_u: f64,
    /// Relative change between rounds, rule (a) [1].
    pub relative_change: f64,
    /// Absolute surrogate error of any curve, rule (b) [1].
    pub error: f64,
    /// Surrogate error of the system at the governing checkpoint over the smaller of R and P_f, rule (b) [1].
    pub relative_error: f64,
    /// Absolute change between rounds, rule (b) [1].
    pub change: f64,
    /// Relative change between rounds, rule (b) [1].
    pub relative_change_by_error: f64,
    /// Evaluated points before any stop.
    pub least_points: usize,
    /// Rounds a rule must hold.
    pub hold: usize,
    /// New results over which it must hold; half as many for a population that only grew.
    pub hold_points: usize,
    /// Coefficient of variation of P_f above which the population is enlarged [1].
    pub cov: f64,
}

impl Default for Targets {
    fn default() -> Self {
        Self {
            min_u: 2.0,
            relative_change: 0.02,
            error: 0.006,
            relative_error: 0.02,
            change: 0.01,
            relative_change_by_error: 0.05,
            least_points: 30,
            hold: 2,
            hold_points: 8,
            cov: 0.05,
        }
    }
}

/// What one round of learning showed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Figures {
    /// Points with a result.
    pub points: usize,
    /// Smallest coupled learning function.
    pub min_u: f64,
    /// Largest absolute change of any curve since the round before, if there was one.
    pub change: Option<f64>,
    /// Largest estimated surrogate error of any curve.
    pub error: f64,
    /// That of the system at the governing checkpoint.
    pub governing_error: f64,
    /// The smaller of R and P_f of the system at the governing checkpoint.
    pub governing_share: f64,
}

/// A stopping rule.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rule {
    /// (a): every point is classified with certainty.
    Learning,
    /// (b): the error of the curves is small enough.
    Error,
}

impl Targets {
    /// The usual ones with another surrogate error [1]; that relative to P_f follows in proportion.
    pub fn of_error(error: f64) -> Self {
        let usual = Self::default();
        Self { error, relative_error: usual.relative_error * (error / usual.error), ..usual }
    }

    /// The rule these figures meet, if any.
    pub fn met(&self, figures: &Figures) -> Option<Rule> {
        let change = figures.change.filter(|_| figures.points >= self.least_points)?;
        let relative = if change == 0.0 { 0.0 } else { change / figures.governing_share };
        if figures.min_u >= self.min_u && relative < self.relative_change {
            return Some(Rule::Learning);
        }
        let accurate = figures.error <= self.error
            && figures.governing_error <= self.relative_error * figures.governing_share;
        let settled = change <= self.change && relative <= self.relative_change_by_error;
        (accurate && settled).then_some(Rule::Error)
    }
}

/// Counts how often running a rule was met, and since how many results.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Stopping {
    held: usize,
    since: usize,
    /// Whether the rules have held before, over a smaller population.
    held_before: bool,
}

impl Stopping {
    /// Takes notice of a round with so many results; true once the rules have held long enough.
    pub fn note(&mut self, met: Option<Rule>, points: usize, targets: &Targets) -> bool {
        if met.is_none() {
            self.held = 0;
            return false;
        }
        if self.held == 0 {
            self.since = points;
        }
        self.held += 1;
        let needed = if self.held_before { targets.hold_points.div_ceil(2) } else { targets.hold_points };
        self.held >= targets.hold && points - self.since >= needed
    }

    /// Whether a rule was met in the last round.
    pub fn holding(&self) -> bool {
        self.held > 0
    }

    /// How many of the next `count` points are to explore, with so many results now: every other one, the first to begin with.
    pub fn exploring(&self, points: usize, count: usize) -> usize {
        if !self.holding() {
            return 0;
        }
        let since = points - self.since;
        (since + count).div_ceil(2) - since.div_ceil(2)
    }

    /// Begins counting anew, after a surprise and for a population of rarer events.
    pub fn reset(&mut self) {
        *self = Self::default();
    }

    /// Begins counting anew for a larger population, over half as many results.
    pub fn go_on(&mut self) {
        *self = Self { held_before: true, ..Self::default() };
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
        }
    }

    #[test]
    fn each_condition_can_forbid_the_stop() {
        let targets = Targets::default();
        assert_eq!(targets.met(&figures()), Some(Rule::Learning));
        assert_eq!(targets.met(&Figures { min_u: 1.0, ..figures() }), Some(Rule::Error));
        assert_eq!(targets.met(&Figures { points: 29, ..figures() }), None);
        assert_eq!(targets.met(&Figures { change: None, ..figures() }), None);
        assert_eq!(targets.met(&Figures { change: Some(2e-4), ..figures() }), None);
        let uncertain = Figures { min_u: 1.0, ..figures() };
        assert_eq!(targets.met(&Figures { governing_error: 5e-5, ..uncertain }), None);
        assert_eq!(targets.met(&Figures { error: 7e-3, ..uncertain }), None);
    }

    #[test]
    fn a_rule_must_hold_for_two_rounds_and_eight_points_running() {
        let targets = Targets::default();
        let mut stopping = Stopping::default();
        assert!(!stopping.note(Some(Rule::Error), 40, &targets));
        assert!(!stopping.note(None, 50, &targets));
        assert_eq!(stopping.exploring(50, 1), 0);
        assert!(!stopping.note(Some(Rule::Error), 56, &targets));
        assert!(!stopping.note(Some(Rule::Error), 63, &targets));
        // Every other point explores, whether they are asked for one by one or together.
        assert_eq!([56, 57, 58].map(|points| stopping.exploring(points, 1)), [1, 0, 1]);
        assert_eq!((stopping.exploring(56, 5), stopping.exploring(57, 4)), (3, 2));
        assert!(stopping.note(Some(Rule::Learning), 64, &targets));
        // Over a larger population half as many; after a surprise all of them.
        stopping.go_on();
        assert!(!stopping.holding() && !stopping.note(Some(Rule::Error), 64, &targets));
        assert!(stopping.note(Some(Rule::Error), 68, &targets));
        stopping.reset();
        assert!(!stopping.note(Some(Rule::Error), 70, &targets));
        assert!(!stopping.note(Some(Rule::Error), 74, &targets));
    }
}
