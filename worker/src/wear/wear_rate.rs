//! Wear of either kind of joint with clearance: bushing and journal, or guide and slider.
//!
//! # Source
//! Archard (1953), J. Appl. Phys. 24, 981-988: wear is linear in the work of a contact.

use super::amounts::SurfaceSizes;
use super::archard::BoreWearRate;
use super::equilibrium::NoEquilibrium;
use super::interval::ContactHistory;
use super::rail_history::RailHistory;
use super::rail_rate::RailWearRate;
use super::wear_law::WearLaw;

/// Contact history of a joint that wears.
#[derive(Debug, Clone, PartialEq)]
pub enum WearHistory {
    /// Of a journal in its bushing.
    Bore(ContactHistory),
    /// Of a slider in its guide.
    Rail(RailHistory),
}

/// Evaluates an expression with the history inside.
macro_rules! with_history {
    ($history:expr, $bound:ident => $value:expr) => {
        match $history {
            WearHistory::Bore($bound) => $value,
            WearHistory::Rail($bound) => $value,
        }
    };
}

impl WearHistory {
    /// The history of a journal in its bushing.
    pub(crate) fn bore(&self) -> Option<&ContactHistory> {
        match self {
            WearHistory::Bore(history) => Some(history),
            WearHistory::Rail(_) => None,
        }
    }

    /// The history of a journal in its bushing.
    pub(crate) fn bore_mut(&mut self) -> Option<&mut ContactHistory> {
        match self {
            WearHistory::Bore(history) => Some(history),
            WearHistory::Rail(_) => None,
        }
    }

    /// The history of a slider in its guide.
    pub(crate) fn rail_mut(&mut self) -> Option<&mut RailHistory> {
        match self {
            WearHistory::Bore(_) => None,
            WearHistory::Rail(history) => Some(history),
        }
    }

    /// Removes all samples, for a new cycle.
    pub(crate) fn clear(&mut self) {
        with_history!(self, history => history.clear());
    }

    /// Ends the current interval; to be called at the end of the cycle.
    pub(crate) fn close_interval(&mut self) {
        with_history!(self, history => history.close_interval());
    }

    /// Appends the samples of a further cycle of the same joint.
    pub(crate) fn append(&mut self, further: &WearHistory) {
        match (self, further) {
            (WearHistory::Bore(own), WearHistory::Bore(further)) => own.append(further),
            (WearHistory::Rail(own), WearHistory::Rail(further)) => own.append(further),
            _ => debug_assert!(false, "histories of two joints"),
        }
    }

    /// Turns the history of several cycles into that of their mean: the same contacts, each with its share of the work.
    pub(crate) fn divide_work(&mut self, cycles: usize) {
        match self {
            WearHistory::Bore(history) => history.divide_work(cycles),
            WearHistory::Rail(history) => history.scale_work(1.0 / cycles as f64),
        }
    }

    /// Multiplies the work of every contact by `factor` [1].
    pub(crate) fn scale_work(&mut self, factor: f64) {
        with_history!(self, history => history.scale_work(factor));
    }

    /// Work of all contacts [N m].
    pub(crate) fn work(&self) -> f64 {
        with_history!(self, history => history.work())
    }
}

/// Wear rate of a joint under a frozen contact history.
#[derive(Debug, Clone)]
pub enum WearRate {
    /// Of bushing and journal.
    Bore(Box<BoreWearRate>),
    /// Of guide and slider.
    Rail(Box<RailWearRate>),
}

impl WearLaw for WearRate {
    type History = WearHistory;

    fn freeze(&mut self, history: &WearHistory) {
        match (self, history) {
            (WearRate::Bore(rate), WearHistory::Bore(history)) => rate.freeze(history),
            (WearRate::Rail(rate), WearHistory::Rail(history)) => rate.freeze(history),
            _ => debug_assert!(false, "history of another joint"),
        }
    }

    fn sizes(&self) -> SurfaceSizes {
        match self {
            WearRate::Bore(rate) => WearLaw::sizes(&**rate),
            WearRate::Rail(rate) => rate.sizes(),
        }
    }

    fn rate(&mut self, depth: &[f64], rates: &mut [f64]) -> Result<(), NoEquilibrium> {
        match self {
            WearRate::Bore(rate) => rate.rate(depth, rates),
            WearRate::Rail(rate) => rate.rate(depth, rates),
        }
    }
}
