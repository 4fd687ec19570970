//! Two surfaces of a joint that wear each other: bushing and journal, or guide and slider.

use crate::wear::{FinerBore, StepRule, WearHistory, WearRate};

/// A pair of surfaces with their wear depths: those of the first surface, then those of the second if it wears.
pub(crate) trait WearingPair {
    /// Index into the scene's joints.
    fn scene_joint(&self) -> usize;

    /// Wear coefficients K_H, zero for a surface that does not wear `(2,)` [1/Pa].
    fn wear_coefficients(&self) -> [f64; 2];

    /// Number of depths of the first surface.
    fn first_depths(&self) -> usize;

    /// Number of all depths.
    fn depths(&self) -> usize;

    /// Replaces the wear depths by `depth` `(depths,)` [m].
    fn set_depth(&mut self, depth: &[f64]);

    /// Halves the distance between control points this many `times`, if its forces can be computed on that number; the surfaces are unworn
    /// then. True if they can.
    fn refine(&mut self, times: u32) -> bool;

    /// An empty history of its contacts, which cuts a cycle of `period` [s] into about `samples` intervals.
    fn empty_history(&self, period: f64, samples: usize) -> WearHistory;

    /// Wear rate of the surfaces, as worn so far.
    fn wear_rate(&self) -> WearRate;

    /// Unworn copy with twice as many control points, whose wear steps follow from the `rule` of those of this pair.
    fn finer_copy(&self, rule: StepRule) -> FinerBore<WearRate>;

    /// True if one of the surfaces wears.
    fn wears(&self) -> bool {
        self.wear_coefficients().iter().any(|coefficient| *coefficient > 0.0)
    }
}
