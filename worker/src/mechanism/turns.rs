//! Whole turns of the bodies per cycle, from the ideal motion: a cycle that begins again at an earlier time begins with every angle
//! less the turns in between, as the drives, which are functions of time, have them.
//!
//!   turns = round((angle(T) - angle(0)) / 2 pi), T the period of the cycle [s].

use super::coupling::JointInput;
use super::{Pose, Prescribed};
use common::failure::SimulationFailure;
use common::scene::{JointKind, Load, OutputKind, Scene};
use std::f64::consts::TAU;

/// Whole turns of every body of `scene` per cycle `(bodies,)` [1], from the `poses` of its ideal motion at both ends of the cycle;
/// zero for free bodies if the first pose is the only one, because drives and joints leave the motion open.
///
/// # Errors
/// [`SimulationFailure::NotModelled`] if cycle follows cycle and a torsion spring or the difference of two angles would differ from
/// one to the next by whole turns, or by turns that the drives leave open, if wheels make no whole turns, and if a lift does not end as it
/// begins.
pub fn turns_per_cycle(scene: &Scene, poses: &[Pose]) -> Result<Vec<f64>, SimulationFailure> {
    let period = scene.life.period;
    let (first, last) = (&poses[0], &poses[poses.len() - 1]);
    let angles = |body: usize| match Prescribed::from_body(&scene.bodies[body]) {
        Some(given) => Some([given.angle(0.0), given.angle(period)]),
        None => (poses.len() > 1).then(|| [first, last].map(|pose| pose.q[body].map_or(0.0, |q| q[2]))),
    };
    let of_body = |body: usize| angles(body).map(|angles| ((angles[1] - angles[0]) / TAU).round());
    let turns: Vec<Option<f64>> = (0..scene.bodies.len()).map(of_body).collect();
    if !scene.life.is_single_cycle() {
        check_differences(scene, &turns)?;
        check_lifts(scene, angles)?;
        if poses.len() > 1 {
            check_wheels(scene, poses)?;
        }
    }
    Ok(turns.into_iter().map(Option::unwrap_or_default).collect())
}

/// Change of a lift from one cycle to the next up to which it is rounding, over the lift itself [1].
const SAME_LIFT: f64 = 1e-6;

/// Checks that the lift at the end of a cycle, at `angles` at both ends of it [rad], is that at which the next one begins.
fn check_lifts(scene: &Scene, angles: impl Fn(usize) -> Option<[f64; 2]>) -> Result<(), SimulationFailure> {
    for joint in &scene.joints {
        let JointKind::Cam { lift, .. } = &joint.kind else { continue };
        let cam = joint.bushing.body;
        let (Some(ends), Some(input)) = (angles(cam), JointInput::new(&joint.kind)) else { continue };
        let [begins, ends] = ends.map(|angle| input.jet(0.0, angle)[0]);
        if !lift.repeat && (ends - begins).abs() > SAME_LIFT * begins.abs().max(ends.abs()) {
            return Err(SimulationFailure::NotModelled {
                what: format!(
                    "cycles that begin with a lift of {begins:.6} m of the joint {} and end with {ends:.6} m, so that its follower would jump: write \
                     a lift that repeats, or see it once with cycles = 1, checkpoint_every = 1, settle_cycles = 0",
                    joint.name
                ),
            });
        }
    }
    Ok(())
}

/// Turns of a wheel in a cycle up to which it counts as whole [1]: six digits of a radius.
const WHOLE: f64 = 1e-6;

/// Checks that wheels of gear pairs, belts and racks turn by whole turns in a cycle, so that cycles are alike.
fn check_wheels(scene: &Scene, poses: &[Pose]) -> Result<(), SimulationFailure> {
    let (first, last) = (&poses[0], &poses[poses.len() - 1]);
    for joint in &scene.joints {
        let JointKind::Mesh(_) = &joint.kind else { continue };
        for body in [joint.journal.body, joint.bushing.body] {
            let (Some(from), Some(to)) = (first.q[body], last.q[body]) else { continue };
            let turns = (to[2] - from[2]) / TAU;
            if (turns - turns.round()).abs() > WHOLE * turns.abs().max(1.0) {
                return Err(SimulationFailure::NotModelled {
                    what: format!(
                        "cycles in which {} of the joint {} makes {turns:.6} turns: write a [life] period after which every wheel has made \
                         whole turns, or see it once with cycles = 1, checkpoint_every = 1, settle_cycles = 0",
                        scene.bodies[body].name, joint.name
                    ),
                });
            }
        }
    }
    Ok(())
}

/// Checks that every angle between two bodies that a spring or an output depends on is that of the cycle before.
fn check_differences(scene: &Scene, turns: &[Option<f64>]) -> Result<(), SimulationFailure> {
    let refuse = |what: String| Err(SimulationFailure::NotModelled { what });
    // The angle between them is that of a cycle before only if neither turns, or both are known.
    let is_open = |a: usize, b: usize| match (turns[a], turns[b]) {
        (None, Some(turns)) | (Some(turns), None) => turns != 0.0,
        _ => false,
    };
    let loads = scene.loads.iter().filter_map(|load| match load {
        Load::TorsionSpring { name, a, b, .. } | Load::AngleStop { name, a, b, .. } => {
            Some(("load", name, *a, *b))
        }
        _ => None,
    });
    let outputs = scene.outputs.iter().filter_map(|output| match &output.kind {
        OutputKind::AngleDifference { a, b } => Some(("output", &output.name, a.body, b.body)),
        _ => None,
    });
    for (what, name, a, b) in loads.chain(outputs) {
        let bodies = format!("{} and {}", scene.bodies[a].name, scene.bodies[b].name);
        if is_open(a, b) {
            return refuse(format!(
                "the {what} {name}: by how many turns {bodies} differ after a cycle is left open by the drives"
            ));
        }
        let more = turns[a].unwrap_or_default() - turns[b].unwrap_or_default();
        if what == "load" && more != 0.0 {
            let more = more * 360.0;
            return refuse(format!(
                "the load {name} between {bodies}, which every cycle winds up by {more} deg: no cycle repeats"
            ));
        }
    }
    Ok(())
}
