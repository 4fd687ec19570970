//! Position and velocity analysis with every joint ideal: start of the mechanism, whether its crank can go
//! round, and its motion in the limit of vanishing clearance.
//!
//! Closure phi(q, t) = 0 of every joint by Newton's method with the least-norm step, so that a mechanism with
//! more freedom than closures keeps what its start determines. Velocities solve (dphi/dq) qd = -dphi/dt,
//! accelerations the time derivative of that equation. The motion is followed from time to time by
//! continuation.
//!
//! # Source
//! Haug (1989), Computer Aided Kinematics and Dynamics of Mechanical Systems.

use super::closure::Closure;
use common::failure::SimulationFailure;
use common::scene::{Motion, Scene};
use nalgebra::DVector;

/// Positions and velocities of all bodies at one time: coordinates of the centre of mass and angle for free
/// bodies; nothing for the others.
#[derive(Debug, Clone, PartialEq)]
pub struct Pose {
    /// Time [s].
    pub time: f64,
    /// Per body of the scene: (x, y, angle) of a free body.
    pub q: Vec<Option<[f64; 3]>>,
    /// Their rates.
    pub v: Vec<Option<[f64; 3]>>,
}

/// Angles of a cycle at which closure is checked.
const CHECKED: usize = 180;
/// A stretch of the motion is halved until the bodies move by no more than this share of the mechanism at
/// once...
const LONGEST: f64 = 0.2;
/// ... and Newton's method corrects no more than this share of what velocities predict, or of the mechanism.
const CORRECTION: (f64, f64) = (0.3, 0.01);
/// Shortest stretch, as a share of the cycle: where even that is too long, the motion ends.
const SHORTEST: f64 = 1e-8;

/// The mechanism with ideal joints at `samples` equal times of one cycle, ends included: its motion in the
/// limit of vanishing clearance, followed by continuation from the approximate start of the scene. Adds the
/// Newton iterations to `iterations`. Where drives and joints leave the motion open there is only the start.
///
/// # Errors
/// [`SimulationFailure::CannotAssemble`] where it cannot be closed at the start,
/// [`SimulationFailure::OverConstrained`] if ideal joints forbid a motion twice,
/// [`SimulationFailure::DeadPoint`] with joint and angle where the linkage locks or its motion becomes
/// ambiguous on its way.
pub fn ideal_cycle(
    scene: &Scene,
    samples: usize,
    iterations: &mut u64,
) -> Result<Vec<Pose>, SimulationFailure> {
    let closure = Closure::new(scene);
    let mut q = closure.start();
    closure.close(0.0, &mut q, iterations).map_err(|open| SimulationFailure::CannotAssemble {
        joint: scene.joints[open.joint].name.clone(),
        time: 0.0,
        gap: open.gap,
    })?;
    if let Some(joint) = closure.first_dependent_joint(&q) {
        return Err(SimulationFailure::OverConstrained { joint: scene.joints[joint].name.clone() });
    }
    let intervals = samples.max(2) - 1;
    let refine = CHECKED.div_ceil(intervals);
    let at = |k: usize| scene.life.period * k as f64 / (intervals * refine) as f64;
    let mut poses = vec![pose(&closure, 0.0, &q)];
    if !closure.is_determined(&q) {
        return Ok(poses);
    }
    let orientation = closure.orientation(0.0, &q);
    for k in 1..=intervals * refine {
        follow(&closure, orientation, at(k - 1), at(k), &mut q, iterations)
            .map_err(|stop| dead_point(scene, &stop))?;
        if k % refine == 0 {
            poses.push(pose(&closure, at(k), &q));
        }
    }
    Ok(poses)
}

fn pose(closure: &Closure, t: f64, q: &DVector<f64>) -> Pose {
    Pose { time: t, q: closure.split(q), v: closure.split(&closure.velocity(t, q)) }
}

/// Where the motion ends, and which joint could not follow.
struct Stop {
    time: f64,
    joint: usize,
}

/// Follows the motion from one time to another, in stretches as short as the motion asks for.
fn follow(
    closure: &Closure,
    orientation: Option<bool>,
    from: f64,
    to: f64,
    q: &mut DVector<f64>,
    iterations: &mut u64,
) -> Result<(), Stop> {
    let (mut t, mut stretch) = (from, to - from);
    while t < to {
        let ahead = if to - t <= stretch * 1.5 { to - t } else { stretch };
        let predicted = closure.velocity(t, q) * ahead;
        let far = closure.largest(&predicted);
        let mut trial = &*q + &predicted;
        let mut culprit = None;
        let mut fits = far <= LONGEST * closure.size();
        if fits {
            match closure.close(t + ahead, &mut trial, iterations) {
                Ok(()) => {
                    let correction = closure.largest(&(&trial - &*q - &predicted));
                    fits = correction <= (CORRECTION.0 * far).max(CORRECTION.1 * closure.size())
                        && closure.orientation(t + ahead, &trial) == orientation;
                }
                Err(open) => (fits, culprit) = (false, Some(open.joint)),
            }
        }
        if fits {
            q.copy_from(&trial);
            t = if ahead == to - t { to } else { t + ahead };
            stretch = (2.0 * ahead).min(to - from);
        } else {
            stretch = 0.5 * ahead;
            if stretch < SHORTEST * closure.period() {
                let joint = culprit.unwrap_or_else(|| closure.weakest_joint(t, q));
                return Err(Stop { time: t, joint });
            }
        }
    }
    Ok(())
}

/// Accelerations of the ideal mechanism in these poses, per body of the scene as in [`Pose`] [m/s^2,
/// rad/s^2]; none if the joints and drives leave the motion a freedom in one of them.
pub fn ideal_accelerations(scene: &Scene, poses: &[Pose]) -> Option<Vec<Vec<Option<[f64; 3]>>>> {
    let closure = Closure::new(scene);
    let flat = |x: &[Option<[f64; 3]>]| DVector::from_vec(x.iter().flatten().flatten().copied().collect());
    let of = |pose: &Pose| closure.acceleration(pose.time, &flat(&pose.q), &flat(&pose.v));
    poses.iter().map(|pose| of(pose).map(|a| closure.split(&a))).collect()
}

/// The failure, told by the angle of the first driven body.
fn dead_point(scene: &Scene, stop: &Stop) -> SimulationFailure {
    let driven = scene.bodies.iter().find(|b| matches!(b.motion, Motion::Driven { .. }));
    let angle = driven.and_then(super::Prescribed::of).map_or(0.0, |motion| motion.angle(stop.time));
    SimulationFailure::DeadPoint {
        joint: scene.joints[stop.joint].name.clone(),
        time: stop.time,
        body: driven.map_or_else(String::new, |b| b.name.clone()),
        angle,
    }
}
