//! Values of the keys of outputs: where drives are held, measures over a cycle, bodies with a sign.

use serde::{Deserialize, Serialize};

/// Position in which the drives of a mechanism are held.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct HeldInput {
    /// Index of a driven body.
    pub body: usize,
    /// Its angle, whole turns not counted [rad].
    pub angle: f64,
}

/// Measure of an error over a cycle.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum ErrorMeasure {
    /// Largest size of the error.
    #[default]
    Largest,
    /// Root of the mean over time of its square.
    RootMeanSquare,
}

impl ErrorMeasure {
    /// Every measure by its word in a scene.
    pub const WORDS: [(&str, Self); 2] = [("largest", Self::Largest), ("rms", Self::RootMeanSquare)];

    /// The measure in a description.
    pub(super) fn description(self) -> &'static str {
        match self {
            Self::Largest => "largest",
            Self::RootMeanSquare => "r.m.s.",
        }
    }
}

/// Measure of the energies of the impacts of a cycle.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum ImpactMeasure {
    /// Sum over all impacts.
    #[default]
    Total,
    /// Energy of the hardest impact.
    Largest,
}

impl ImpactMeasure {
    /// Every measure by its word in a scene.
    pub const WORDS: [(&str, Self); 2] = [("total", Self::Total), ("largest", Self::Largest)];

    /// The measure in a description.
    pub(super) fn description(self) -> &'static str {
        match self {
            Self::Total => "impacts per cycle",
            Self::Largest => "hardest impact",
        }
    }
}

/// A body with the sense in which its angle is reported.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SignedBody {
    /// Index into [`super::Scene::bodies`].
    pub body: usize,
    /// +1 or -1.
    pub sign: f64,
    /// Name in texts, e.g. `right`.
    pub label: String,
}
