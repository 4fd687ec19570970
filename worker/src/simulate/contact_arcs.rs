//! Contact arcs of the joints that wear, against the spacing of their control points.
//!
//! `wear/contact_arc.rs` has the arc of a contact history. An arc of fewer than about one and a half spacings is smeared over the points next to it, and the
//! largest wear falls short.

use super::island_state::IslandState;
use crate::mechanism::WearingPair;
use crate::wear::mean_contact_arc;
use std::f64::consts::TAU;

/// Contact arc of a joint whose bore or journal wears, and the spacing of its control points.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactArc {
    /// Index into the scene's joints.
    pub(super) scene_joint: usize,
    /// Name of the joint.
    pub joint: String,
    /// Mean contact arc in the first cycle, on unworn surfaces [rad]; zero without contact.
    pub arc: f64,
    /// Angle between two control points [rad].
    pub spacing: f64,
}

impl ContactArc {
    /// Control points per arc with which the largest wear is within about a per cent [1]: 36 points are 1.6 to 1.8 per arc in the drive and the
    /// four-bar and leave 0.1 to 1.0 %, 18 points up to 3.3 % (`coordinator/doc/validation.md`).
    pub const ENOUGH: f64 = 1.5;

    /// Control points with which the arc has [`Self::ENOUGH`] of them.
    pub fn enough_points(&self) -> usize {
        (Self::ENOUGH * TAU / self.arc).ceil() as usize
    }

    /// Takes the arc of the same joint under another operating condition if that is narrower.
    pub(super) fn join(&mut self, other: &ContactArc) {
        if other.arc > 0.0 && (self.arc <= 0.0 || other.arc < self.arc) {
            self.arc = other.arc;
        }
    }
}

/// The arcs of the joints that wear in the cycle recorded last, on unworn surfaces, in the scene's order.
pub(super) fn contact_arcs(islands: &[IslandState]) -> Vec<ContactArc> {
    let mut found = Vec::new();
    for state in islands {
        let joints = state.island.joints.iter().zip(&state.recorder.histories);
        for (joint, history) in joints.filter(|(joint, _)| joint.wears()) {
            let radii = [joint.profile.initial_radius(), joint.contact.surface().journal_radius];
            found.push(ContactArc {
                scene_joint: joint.scene_joint,
                joint: joint.name.clone(),
                arc: history.bore().map_or(0.0, |history| mean_contact_arc(history, radii)),
                spacing: TAU / joint.profile.points() as f64,
            });
        }
    }
    found.sort_by_key(|arc| arc.scene_joint);
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_narrower_arc_of_two_conditions_counts_unless_it_is_none() {
        let arc = |arc| ContactArc { scene_joint: 0, joint: "pin".into(), arc, spacing: 0.1 };
        for (one, other, expected) in [(0.3, 0.2, 0.2), (0.2, 0.3, 0.2), (0.0, 0.3, 0.3), (0.3, 0.0, 0.3)] {
            let mut joined = arc(one);
            joined.join(&arc(other));
            assert_eq!(joined.arc, expected);
        }
        // Fifteen points per turn have one and a half per arc of 36 degrees.
        assert_eq!(arc(TAU / 10.0).enough_points(), 15);
    }
}
