//! Frames of an animated cycle.

use crate::presentation::report::mechanism::Pose;
use common::outputs::CycleHistory;

/// Frames per cycle.
pub const FRAMES: usize = 120;

/// A cycle to be animated.
pub struct AnimatedCycle<'a> {
    /// Name in the list of cycles.
    pub name: &'static str,
    /// True if the bores are those at the end of life.
    pub worn: bool,
    /// Motion over the cycle.
    pub cycle: &'a CycleHistory,
    /// Poses of all bodies at its instants `(n, bodies)`.
    pub poses: Vec<Vec<Pose>>,
}

impl AnimatedCycle<'_> {
    /// Poses of all bodies in the frames, which are evenly spread over the cycle.
    pub fn frames(&self) -> impl Iterator<Item = &[Pose]> {
        let last = self.poses.len() - 1;
        (0..FRAMES).map(move |frame| self.poses[frame * last / FRAMES].as_slice())
    }
}
