//! Frames of an animated cycle.

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
}

/// Indices of the frames in a cycle, evenly spread.
pub fn frames(cycle: &CycleHistory) -> impl Iterator<Item = usize> {
    let last = cycle.time.len() - 1;
    (0..FRAMES).map(move |frame| frame * last / FRAMES)
}
