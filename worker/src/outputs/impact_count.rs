//! Number and energy of the impacts of one joint over a cycle; `impacts.rs` defines both.

/// Impacts of one joint so far.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ImpactCount {
    /// Number of impacts [1].
    pub number: u32,
    /// Sum of their energies [J].
    pub energy: f64,
    /// Energy of the hardest one [J].
    pub hardest: f64,
}

impl ImpactCount {
    /// Adds an impact of this energy [J].
    pub(crate) fn add(&mut self, energy: f64) {
        self.number += 1;
        self.energy += energy;
        self.hardest = self.hardest.max(energy);
    }
}
