//! Settings of the learning from a fleet.

use crate::analyses::update::FleetSettings;
use crate::statistics::updating::SequentialMonteCarlo;

/// Settings of the learning.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LearnSettings {
    /// Updating of the single units; its population is that of a pass.
    pub units: FleetSettings,
    /// Sets of parameters.
    pub sets: usize,
    /// Points of the population by which R is counted.
    pub points: usize,
    /// Confidence C in (0, 1) [1].
    pub confidence: f64,
    /// Whether the value of further data is computed.
    pub ranks: bool,
}

impl LearnSettings {
    /// Defaults for a study with this seed.
    pub fn new(seed: u64) -> Self {
        let monte_carlo = SequentialMonteCarlo { particles: 400, least: 150.0 };
        let units = FleetSettings { population: 6000, monte_carlo, ..FleetSettings::new(seed) };
        Self { units, sets: 500, points: 16_000, confidence: 0.9, ranks: true }
    }
}
