//! Lives of units of a population, some of them known only in part: the Weibull distribution of largest likelihood with its bounds, and
//! the same data against a curve of reliability that was computed without them.
//!
//! | file | computes |
//! |---|---|
//! | `weibull` | fit, Fisher bounds and likelihood-ratio bounds |
//! | `against_curve` | likelihood under a curve, and a test of the curve |
//! | `product_limit` | estimate of Kaplan and Meier, and a test of the Weibull distribution by it |

mod against_curve;
mod product_limit;
mod weibull;

pub use against_curve::{evidence_of_curve, ln_likelihood, test_of_curve};
pub use product_limit::{censored_anderson_darling, kaplan_meier};
pub use weibull::{FitBounds, NoMaximum, WeibullFit, WeibullLaw};

/// What is known of the life of one unit [cycles].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum UnitLife {
    /// It failed at this life, above 0.
    Failed(f64),
    /// It had not failed by this life: a suspension.
    Running(f64),
    /// It failed after the first life, from 0 on, and by the second one.
    Interval(f64, f64),
}

impl UnitLife {
    /// True if the unit has failed.
    pub fn has_failed(&self) -> bool {
        !matches!(self, Self::Running(_))
    }

    /// Life by which it had failed, or until which it has run.
    pub fn last(&self) -> f64 {
        match *self {
            Self::Failed(t) | Self::Running(t) | Self::Interval(_, t) => t,
        }
    }

    /// The datum on another scale of time, which rises with the life.
    #[must_use]
    pub fn mapped(self, of: impl Fn(f64) -> f64) -> Self {
        match self {
            Self::Failed(t) => Self::Failed(of(t)),
            Self::Running(t) => Self::Running(of(t)),
            Self::Interval(from, to) => Self::Interval(of(from), of(to)),
        }
    }
}
