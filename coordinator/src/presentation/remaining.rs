//! The time that a study still takes, from its counts and its rate: in the terminal, in `status` and on the live page.

use super::report::format::duration;

/// Evaluations of a study so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct EvaluationProgress {
    /// Evaluations that have ended.
    pub done: u64,
    /// Evaluations requested so far.
    pub planned: u64,
    /// Largest number of evaluations of the study.
    pub budget: u64,
}

/// Time left in a study.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RemainingTime {
    /// Time until all evaluations are done [s].
    pub seconds: f64,
    /// True if learning may end before its budget is spent.
    pub is_bound: bool,
}

impl EvaluationProgress {
    /// Largest number of evaluations that the study may have.
    pub fn most(&self) -> u64 {
        self.budget.max(self.planned).max(self.done)
    }

    /// The time left at a rate of evaluations [1/s]; none without one, or if nothing is left.
    pub fn remaining(&self, rate: Option<f64>) -> Option<RemainingTime> {
        let left = self.most().checked_sub(self.done).filter(|left| *left > 0)?;
        let rate = rate.filter(|rate| *rate > 0.0)?;
        Some(RemainingTime { seconds: left as f64 / rate, is_bound: self.most() > self.planned })
    }
}

/// As `at most 4 min 03 s left`.
impl std::fmt::Display for RemainingTime {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let bound = if self.is_bound { "at most " } else { "" };
        write!(f, "{bound}{} left", duration(self.seconds))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_budget_is_a_bound_and_a_plan_is_carried_out() {
        let learning = EvaluationProgress { done: 84, planned: 120, budget: 400 };
        let time = learning.remaining(Some(2.0)).unwrap();
        assert_eq!((time.seconds, time.is_bound), (158.0, true));
        assert_eq!(time.to_string().replace('\u{a0}', " "), "at most 2 min 38 s left");
        let direct = EvaluationProgress { done: 84, planned: 400, budget: 400 };
        assert!(!direct.remaining(Some(2.0)).unwrap().is_bound);
        assert_eq!(direct.remaining(None), None);
        assert_eq!(direct.remaining(Some(0.0)), None);
        assert_eq!(EvaluationProgress { done: 400, ..direct }.remaining(Some(2.0)), None);
    }
}
