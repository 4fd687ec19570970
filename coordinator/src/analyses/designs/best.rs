//! The best of several designs, and those that cannot be told from it.

use super::answer::DesignAnswer;
use crate::analyses::paired_results::PairedResults;
use crate::presentation::report::life::{LifeAt, life_at};
use crate::statistics::reliability::paired::{Change, OtherErrors};
use serde::Serialize;

/// What makes a design good; both refer to the whole system.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Objective {
    /// The life at which R falls to this level, one of [`LEVELS`](crate::study::LEVELS).
    Life {
        /// Level of R [1].
        level: f64,
    },
    /// R at this checkpoint.
    Reliability {
        /// Checkpoint of life [cycles].
        cycles: u32,
    },
}

/// The best design.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Best {
    /// What was compared.
    pub objective: Objective,
    /// Index of the best design among the answers.
    pub index: usize,
    /// Its objective [cycles, or 1].
    pub value: f64,
    /// Whether the objective of the best design is only known to be at least `value`: its life ends beyond the life studied.
    pub is_bound: bool,
    /// Indices of the designs whose difference from the best one lies within the 95 % interval of the difference.
    pub equal: Vec<usize>,
}

impl Objective {
    /// The objective of a design, and whether it is a lower bound; `None` where it is not known.
    fn value(self, answer: &DesignAnswer) -> Option<(f64, bool)> {
        match self {
            Self::Life { level } => match life_at(&answer.summary, "total", level) {
                LifeAt::Cycles { life, .. } => Some((life, false)),
                LifeAt::Beyond { end, .. } => Some((end, true)),
                LifeAt::Unworn { .. } | LifeAt::Between { .. } => None,
            },
            Self::Reliability { cycles } => {
                let row = answer.summary.reliability.iter().find(|row| row.cycles == cycles)?;
                Some((*row.reliability.get("total")?, false))
            }
        }
    }

    /// The change of the objective from `best` to `other` with its interval; `None` where it is not known.
    fn change(self, best: &DesignAnswer, other: &DesignAnswer) -> Option<Change> {
        let [before, after] = [best, other].map(|answer| answer.first_failures.clone());
        let paired = PairedResults::new(before, after, OtherErrors::Independent);
        match self {
            Self::Life { level } => {
                let rows = paired.lives(&best.summary, &other.summary);
                rows.iter().find(|row| row.is_of("total", level))?.cycles
            }
            Self::Reliability { cycles } => {
                let rows = paired.reliability(&best.summary, &other.summary);
                rows.iter().find(|row| row.cycles == cycles)?.change.get("total").copied()
            }
        }
    }
}

impl Best {
    /// The best of the answers; `None` if the objective of none is known.
    pub fn among(answers: &[DesignAnswer], objective: Objective) -> Option<Self> {
        let values: Vec<Option<(f64, bool)>> = answers.iter().map(|answer| objective.value(answer)).collect();
        let known =
            values.iter().enumerate().filter_map(|(i, value)| value.map(|(value, is)| (i, value, is)));
        // The first of equal ones.
        let (index, value, is_bound) =
            known.reduce(|best, next| if next.1 > best.1 { next } else { best })?;
        let is_equal = |i: &usize| match values[*i] {
            _ if *i == index => true,
            Some((_, true)) => is_bound,
            Some((_, false)) if !is_bound => {
                let change = objective.change(&answers[index], &answers[*i]);
                change.is_some_and(|change| change.upper.is_none_or(|upper| upper >= 0.0))
            }
            _ => false,
        };
        let equal = (0..answers.len()).filter(is_equal).collect();
        Some(Self { objective, index, value, is_bound, equal })
    }
}
