//! What every output that follows from the motion of a cycle provides.

use super::{RecordedCycle, RecordingRequest};

/// How an output reads the motion between two time steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sampling {
    /// On the cubic through values and rates at both ends of the step.
    Cubic,
    /// At the ends of the step alone.
    Steps,
    /// By events, which the steps do not pass over: no peak is missed between two steps.
    Events,
}

impl Sampling {
    /// Largest share of the amplitude of a vibration by which its peak can be missed [1]: x^4 / 384 on a cubic, x^2 / 8 at the
    /// ends of the steps, where `phase` x is the angle of the vibration per time step [rad]. Valid for x below about 1.
    ///
    /// # Source
    /// Error of piecewise Hermite and linear interpolation: de Boor, A Practical Guide to Splines (1978).
    pub(crate) fn missed_peak(self, phase: f64) -> f64 {
        match self {
            Sampling::Cubic => phase * phase * phase * phase / 384.0,
            Sampling::Steps => phase * phase / 8.0,
            Sampling::Events => 0.0,
        }
    }
}

/// An output that follows from the recorded motion of one cycle.
pub trait MotionOutput {
    /// Adds what the output needs recorded.
    fn request(&self, request: &mut RecordingRequest);

    /// Value over the recorded cycle, in the SI unit of the output.
    fn value(&self, cycle: &RecordedCycle) -> f64;

    /// How the output reads the motion between two time steps.
    fn sampling(&self) -> Sampling {
        Sampling::Cubic
    }

    /// True if the value is that of an instant or of single events, and not a mean over the cycle.
    fn is_extreme(&self) -> bool {
        true
    }
}
