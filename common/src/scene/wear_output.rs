//! Quantities of the wear of joints that an evaluation returns.

use super::joint::WearingSurfaces;
use super::output_unit::OutputUnit;
use serde::{Deserialize, Serialize};

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

    /// True if it is not zero by definition for a joint of which these surfaces wear.
    pub(super) fn is_of(self, wears: WearingSurfaces) -> bool {
        match self {
            Self::BushingDepth => wears != WearingSurfaces::Journal,
            Self::JournalDepth => wears != WearingSurfaces::Bushing,
            _ => true,
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
