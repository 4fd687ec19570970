//! Control points of the joints that leave their number to the contact arc.
//!
//! A contact arc of fewer than about one and a half spacings of the control points is smeared over the points next to it, and the largest wear falls short. The
//! arc is that of the settled first cycle on unworn surfaces, where it is narrowest, under every operating condition, with the steps of `draft`: the
//! same for every accuracy. With the mean arc a [rad] a profile has
//!
//!   n = 12 ceil(k 2 pi / (12 a)),   36 <= n <= 360,   k = [`ContactArc::ENOUGH`],
//!
//! control points. In steps of twelve, nearly all samples of the random variables have the same number.
//!
//! # Source
//! Error against points per arc: measured here (`cargo bench -p worker --bench control_points`).
//!
//! # Contact arcs
//! Contact arcs of the joints that wear, against the spacing of their control points. `wear/condense.rs` has the arc of a contact history.

use super::island_state::IslandState;
use super::{LaneQueue, Run, Simulated, conditions, join};
use crate::integrate::StepCounts;
use crate::mechanism::WearingPair;
use crate::wear::mean_contact_arc;
use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::scene::{Clearance, ControlPoints, GuideClearance, JointKind, Scene};
use std::f64::consts::TAU;

/// Step between the numbers that are chosen.
const STEP: usize = 12;

/// The scene, all its conditions included, with the control points of the joints that leave them to the arc; steps and number of the cycles in
/// which the arcs were found. `None` if there are no such joints.
///
/// # Errors
/// [`SimulationFailure`] if the first cycle under a condition fails.
pub(crate) async fn with_control_points(
    queue: &LaneQueue,
    scene: &Scene,
) -> Simulated<Option<(Scene, StepCounts, u64)>> {
    if !scene.joints.iter().any(|joint| is_open(&joint.kind)) {
        return Ok(None);
    }
    let accuracy = Accuracy::draft();
    let mut runs = conditions::assemble(queue, scene, &accuracy)?;
    let first = runs.iter_mut().map(async |run: &mut Run<'_>| {
        run.settle().await?;
        run.measure().await?;
        Ok::<_, SimulationFailure>(contact_arcs(run.scene, &run.islands))
    });
    let mut arcs: Vec<ContactArc> = vec![];
    for found in join(first).await {
        let found = found?;
        if arcs.is_empty() {
            arcs = found;
        } else {
            arcs.iter_mut().zip(&found).for_each(|(arc, other)| arc.join(other));
        }
    }
    let (mut counts, mut cycles) = (StepCounts::default(), 0);
    for run in &runs {
        counts.add(&run.counts);
        cycles += run.simulated;
    }
    let mut scene = scene.clone();
    set_control_points(&mut scene, &arcs);
    scene.conditions.iter_mut().for_each(|condition| set_control_points(&mut condition.scene, &arcs));
    Ok(Some((scene, counts, cycles)))
}

/// The scene with `factor` [1] times its control points, on bores and on guides, where intervals of a guide are halved, see
/// [`Accuracy::points`]. `None` if nothing changes: the factor is 1, or the points are a part of the scene's model.
pub(crate) fn with_more_points(scene: &Scene, factor: u32) -> Option<Scene> {
    if factor == 1 || scene.control_points_of_model {
        return None;
    }
    let mut finer = scene.clone();
    multiply(&mut finer, factor as usize);
    finer.conditions.iter_mut().for_each(|condition| multiply(&mut condition.scene, factor as usize));
    Some(finer)
}

fn multiply(scene: &mut Scene, factor: usize) {
    for joint in &mut scene.joints {
        match &mut joint.kind {
            JointKind::Clearance(Clearance { control_points: ControlPoints::Number(points), .. }) => {
                *points *= factor;
            }
            JointKind::Guide(GuideClearance { wear: Some(wear), .. }) => {
                wear.control_points = factor * (wear.control_points - 1) + 1;
            }
            _ => {}
        }
    }
}

fn is_open(kind: &JointKind) -> bool {
    matches!(kind, JointKind::Clearance(clearance) if clearance.control_points == ControlPoints::ByArc)
}

/// Gives the joints of `scene` that leave their control points to the arc the number for theirs among the `arcs`.
fn set_control_points(scene: &mut Scene, arcs: &[ContactArc]) {
    for (index, joint) in scene.joints.iter_mut().enumerate().filter(|(_, joint)| is_open(&joint.kind)) {
        let arc = arcs.iter().find(|arc| arc.scene_joint == index);
        if let JointKind::Clearance(clearance) = &mut joint.kind {
            clearance.control_points = ControlPoints::Number(arc.map_or(ControlPoints::DEFAULT, chosen));
        }
    }
}

/// Control points for this arc; the default ones without contact.
fn chosen(arc: &ContactArc) -> usize {
    if arc.arc <= 0.0 {
        return ControlPoints::DEFAULT;
    }
    let enough = arc.enough_points().min(ControlPoints::MOST).next_multiple_of(STEP);
    enough.clamp(ControlPoints::DEFAULT, ControlPoints::MOST)
}

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
pub(super) fn contact_arcs(scene: &Scene, islands: &[IslandState]) -> Vec<ContactArc> {
    let mut found = Vec::new();
    for state in islands {
        let joints = state.island.joints.iter().zip(&state.recorder.histories);
        for (joint, history) in joints.filter(|(joint, _)| joint.wears()) {
            let radii = [joint.profile.initial_radius, joint.contact.surface().journal_radius];
            found.push(ContactArc {
                scene_joint: joint.scene_joint,
                joint: scene.joints[joint.scene_joint].name.clone(),
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
    fn narrow_arcs_get_more_points_in_steps_within_the_bounds() {
        let points = |degrees: f64| {
            let arc = degrees.to_radians();
            chosen(&ContactArc { scene_joint: 0, joint: "pin".into(), arc, spacing: 0.1 })
        };
        // One and a half per arc: 540 over the arc in degrees.
        assert_eq!([180.0, 15.1, 14.9, 9.0, 7.4, 1.0, 0.0].map(points), [36, 36, 48, 60, 84, 360, 36]);
    }
}

#[cfg(test)]
mod contact_arcs_tests {
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
