//! Values of the keys of loads and outputs: points on bodies, where drives are held, measures over a cycle, bodies with a sign, quantities of
//! the wear.

use super::output_unit::OutputUnit;
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

/// A quantity of the wear of one or more joints.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum WearQuantity {
    /// Largest wear depth of either surface of any of the joints [m].
    LargestDepth,
    /// Largest wear depth of a bushing, or of a guide on both faces [m].
    BushingDepth,
    /// Largest wear depth of a journal, or of a slider on both faces [m].
    JournalDepth,
    /// Growth of the radial clearance of the joint where it grows most: the sum of the largest depths of its bushing and its journal,
    /// which is the largest growth of the gap over all places and relative angles [m]. For a guide, growth of the clearance on the side where it
    /// grows most: the sum of the largest depths of guide and slider on that face, the largest growth of the gap if they pass each other.
    ClearanceGrowth,
    /// Volume worn from both surfaces of all joints [m^3].
    Volume,
}

impl WearQuantity {
    /// Every quantity of the wear.
    pub(super) const ALL: [Self; 5] =
        [Self::LargestDepth, Self::BushingDepth, Self::JournalDepth, Self::ClearanceGrowth, Self::Volume];

    /// Its word in a scene.
    pub(super) fn word(self) -> &'static str {
        match self {
            Self::LargestDepth => "largest-wear",
            Self::BushingDepth => "bushing-wear",
            Self::JournalDepth => "journal-wear",
            Self::ClearanceGrowth => "clearance-growth",
            Self::Volume => "worn-volume",
        }
    }

    /// Unit of the values.
    pub fn unit(self) -> OutputUnit {
        match self {
            Self::Volume => OutputUnit::Volume,
            _ => OutputUnit::Length,
        }
    }

    /// The quantity in words.
    pub fn description(self) -> &'static str {
        match self {
            Self::LargestDepth => "largest wear depth",
            Self::BushingDepth => "largest wear depth of the bushing or guide",
            Self::JournalDepth => "largest wear depth of the journal or slider",
            Self::ClearanceGrowth => "growth of the clearance",
            Self::Volume => "worn volume",
        }
    }

    /// The surface that must wear, in words.
    pub(super) fn surface(self) -> &'static str {
        match self {
            Self::BushingDepth => "a bushing or a guide",
            Self::JournalDepth => "a journal or a slider",
            _ => "a joint",
        }
    }
}

/// A point of a body, by position in the body's frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Attachment {
    /// Index into [`super::Scene::bodies`].
    pub body: usize,
    /// Position in that body's frame `(2,)` [m].
    pub position: [f64; 2],
}
