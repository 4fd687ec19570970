//! Archard's law of a pair of surfaces under a frozen contact history, as the wear step and its finer copy need it.
//!
//! # Source
//! Archard (1953), J. Appl. Phys. 24, 981-988.

use super::amounts::SurfaceSizes;
use super::equilibrium::NoEquilibrium;

/// Wear rate of a pair of surfaces whose contact history is held fixed.
pub(crate) trait WearLaw {
    /// Contacts of a cycle.
    type History;

    /// Replaces the frozen history by that of the cycle just simulated.
    fn freeze(&mut self, history: &Self::History);

    /// Sizes of the surfaces.
    fn sizes(&self) -> SurfaceSizes;

    /// Wear rate dh/dN of surfaces worn to `depth` `(depths,)` [m]: `rate` of the same length [m/cycle].
    ///
    /// # Errors
    /// [`NoEquilibrium`] if a frozen force has no equilibrium on these surfaces.
    fn rate(&mut self, depth: &[f64], rate: &mut [f64]) -> Result<(), NoEquilibrium>;
}
