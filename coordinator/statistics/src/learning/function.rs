//! Learning (acquisition) functions by which the next samples are chosen.
//!
//! # Source
//! U: Echard, Gayton, Lemaire (2011), AK-MCS, Structural Safety 33(2). The coupled one: Cui et al. (2026), China Mechanical
//! Engineering 37(6), 1472-1485, doi 10.3969/j.issn.1004-132X.2026.06.020. The gain is that of [`super::Selection`].

use crate::named::named;

/// Learning function by which the next samples are chosen.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum LearningFunction {
    /// Alternately the largest expected reduction of the variance near the limit and the largest risk of a
    /// wrong classification, see [`super::Selection`].
    #[default]
    Gain,
    /// U, smallest |mean - threshold| / sigma of any limit state.
    U,
    /// U_c: U of each limit state over its weight by dominance, see [`super::dominance`].
    Coupled,
}

named!(LearningFunction { Gain = "gain", U = "u", Coupled = "coupled" });
