//! How the motion of an evaluation repeats itself from cycle to cycle, as settling (`settling.rs`) and the probes (`probe.rs`) find it.

use common::outputs::UnsettledMotion;

/// How a motion repeats itself.
#[derive(Debug, Clone, Default)]
pub struct Repetition {
    /// True if drives and ideal joints leave no freedom, so that the bodies move beside their ideal motion by the clearances alone.
    pub is_determined: bool,
    /// True if no cycle repeats the one before, so that none is measured again.
    pub is_irregular: bool,
    /// Sum of all changes still to come over that of the next cycle, for a motion that came to repeat itself only in further settling cycles;
    /// else zero [1].
    pub slowness: f64,
    /// What is still to come of a motion that has not settled.
    pub to_come: Option<ToCome>,
    /// Output that changes most from cycle to cycle if the motion has not settled, as the result states it.
    pub unsettled: Option<UnsettledMotion>,
}

/// What is still to come of a motion that has not settled.
#[derive(Debug, Clone)]
pub struct ToCome {
    /// For every output of the motion `(outputs,)` [SI].
    pub motion: Vec<f64>,
    /// Relative to the wear rate of every surface of every joint of the scene `(SURFACES joints,)` [1].
    pub wear: Vec<f64>,
}
