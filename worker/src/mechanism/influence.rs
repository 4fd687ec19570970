//! Influence of small gaps in the joints on a coordinate of the mechanism with ideal joints while its drives are held.
//!
//! With the closures phi(q, t) = 0 `(m,)` of all joints and the drives held, gaps e of the joints displace the mechanism by dq,
//! (dphi/dq) dq = e, to first order in e. A coordinate y(q) changes by
//!
//!   dy = lambda . e,  (dphi/dq)' lambda = dy/dq,
//!
//! one solve for all joints. By virtual work lambda is the reaction of the joints to a unit force along y: rad/m for an angle, 1 for a
//! position, of the difference between the centres of journal and bushing in global axes.
//!
//! A guide with clearance has the two closures n.d (offset) and theta (angle) of a prismatic joint. A slider of length l has play c to
//! either side at both of its ends, which share the reaction as the forces lambda_0 / 2 +- lambda_1 / l. Between worn faces its play is that
//! of `rail.rs`.
//!
//! Valid for gaps much smaller than the links: neglected is the change of lambda within the gap, of relative size e over a link.
//!
//! # Source
//! Haug (1989), Computer Aided Kinematics and Dynamics of Mechanical Systems. Clearances by virtual work: Innocenti
//! (2002), J. Mech. Design 124, 52-57.

use super::closure::Closure;
use super::{Pose, Prescribed};
use crate::plane::{dot, left};
use common::scene::{HeldInput, Joint, JointKind, OutputKind, Scene};
use nalgebra::DVector;
use std::f64::consts::{PI, TAU};

/// What the gaps of the joints do to a coordinate in one position of the mechanism.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Influence {
    /// For every joint of the scene with clearance its index, lambda in the axes of the bushing's body `(2,)` [rad/m or 1], and the angle of
    /// the journal's body minus that of the bushing's [rad].
    pub joints: Vec<(usize, [f64; 2], f64)>,
    /// Range of the coordinate that the play of all guides that do not wear leaves [rad or m].
    pub guides: f64,
    /// For every guide of the scene that wears its index, (lambda_0, lambda_1) [rad/m or 1, 1 or m] and the position of the slider's middle along
    /// the guide [m].
    pub worn_guides: Vec<(usize, [f64; 2], f64)>,
}

/// Steps of the bisection by which a position of the drive is found: to rounding.
const BISECTIONS: usize = 60;

/// The influence on the coordinate of the backlash `sought`, the angle of a free body or the position of a place on it along a direction, in each of these `poses` of the ideal mechanism; `None` if its joints and drives do not just determine the
/// position in one of them.
pub(crate) fn influences(scene: &Scene, poses: &[Pose], sought: &OutputKind) -> Option<Vec<Influence>> {
    let closure = Closure::new(scene);
    poses.iter().map(|pose| influence(scene, &closure, pose, sought)).collect()
}

fn influence(scene: &Scene, closure: &Closure, pose: &Pose, sought: &OutputKind) -> Option<Influence> {
    let (t, q) = (pose.time, closure.joined(&pose.q));
    let gradient = match *sought {
        OutputKind::Backlash { body, .. } => closure.gradient(body, [0.0, 0.0, 1.0]),
        OutputKind::PositionBacklash { at, direction, .. } => {
            let (sin, cos) = libm::sincos(direction);
            let arm = closure.frame(at.body, t, &q).turn(scene.arm(&at));
            closure.gradient(at.body, [cos, sin, dot([cos, sin], left(arm))])
        }
        _ => None,
    };
    let lambda = closure.multipliers(t, &q, &gradient?)?;
    let mut found = Influence::default();
    for (index, joint) in scene.joints.iter().enumerate() {
        let of_joint = closure.of_joint(index, &lambda);
        match &joint.kind {
            JointKind::Clearance(_) => {
                let [journal, bushing] =
                    [joint.journal.body, joint.bushing.body].map(|body| closure.frame(body, t, &q));
                let along = bushing.turn_back([of_joint[0], of_joint[1]]);
                found.joints.push((index, along, journal.angle - bushing.angle));
            }
            JointKind::Guide(guide) if guide.wear_coefficients() != [0.0; 2] => {
                let s = place_in_guide(closure, joint, guide.axis, (t, &q));
                found.worn_guides.push((index, [of_joint[0], of_joint[1]], s));
            }
            JointKind::Guide(guide) => {
                let (half, couple) = (0.5 * of_joint[0], of_joint[1] / guide.length);
                found.guides += 2.0 * guide.clearance * ((half + couple).abs() + (half - couple).abs());
            }
            _ => {}
        }
    }
    Some(found)
}

/// Position of the middle of the slider of a `joint` along the `axis` of its guide [rad], from the point of the guide [m].
fn place_in_guide(closure: &Closure, joint: &Joint, axis: f64, (t, q): (f64, &DVector<f64>)) -> f64 {
    let [slider, rail] = [&joint.journal, &joint.bushing].map(|at| {
        let frame = closure.frame(at.body, t, q);
        (frame, frame.point(closure.scene.arm(at)))
    });
    let (sin, cos) = libm::sincos(axis);
    let along = rail.0.turn([cos, sin]);
    dot(along, [0, 1].map(|k| slider.1[k] - rail.1[k]))
}

/// That position in each of these poses of the mechanism with ideal joints [m].
pub(crate) fn places_in_guide(scene: &Scene, joint: &Joint, axis: f64, poses: &[Pose]) -> Vec<f64> {
    let closure = Closure::new(scene);
    let place = |pose: &Pose| place_in_guide(&closure, joint, axis, (pose.time, &closure.joined(&pose.q)));
    poses.iter().map(place).collect()
}

/// Positions of the ideal mechanism in which a driven body has the angle of `held`, found between neighbours of the `poses` of a cycle;
/// none if it does not pass that angle. Adds the Newton iterations to `iterations`.
pub(crate) fn held_poses(scene: &Scene, poses: &[Pose], held: &HeldInput, iterations: &mut u64) -> Vec<Pose> {
    let closure = Closure::new(scene);
    let Some(drive) = Prescribed::from_body(&scene.bodies[held.body]) else { return vec![] };
    // Angle beyond the wanted one, without whole turns, within half a turn of zero.
    let beyond = |t: f64| (drive.angle(t) - held.angle + PI).rem_euclid(TAU) - PI;
    let mut found: Vec<Pose> = Vec::new();
    for pair in poses.windows(2) {
        let (mut low, mut high) = (pair[0].time, pair[1].time);
        let (at_low, at_high) = (beyond(low), beyond(high));
        // A jump by a turn is no passage.
        if at_low * at_high > 0.0 || (at_high - at_low).abs() > PI {
            continue;
        }
        if at_low == 0.0 {
            high = low;
        } else if at_high == 0.0 {
            low = high;
        }
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            if beyond(middle) * at_low > 0.0 { low = middle } else { high = middle }
        }
        let share = (high - pair[0].time) / (pair[1].time - pair[0].time);
        let [from, to] = [&pair[0], &pair[1]].map(|pose| closure.joined(&pose.q));
        let mut q: DVector<f64> = &from + (to - &from) * share;
        if closure.close(high, &mut q, iterations).is_ok() {
            let v = closure.split(&closure.velocity(high, &q));
            found.push(Pose { time: high, q: closure.split(&q), v });
        }
    }
    found
}
