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
//!
//! # Change points
//! Change points of a mechanism whose drives determine its motion: positions in which its ideal joints are dependent although the joints can
//! be closed beyond, as in a parallelogram whose bars are in line.
//!
//! The share of a row of dphi/dq normal to the rows before it vanishes there, linearly in time on every branch. The smallest share is observed
//! at the times of the continuation; where it is small and has a minimum in between, the minimum is sought by sections.
//!
//! Source:
//! Change points of four-bar linkages: Norton (2020), Design of Machinery, section 2.12. Golden sections: Kiefer (1953), Proc. Amer. Math.
//! Soc. 4, 502-506.

use super::closure::Closure;
use super::extent::moved_to_origin;
use common::failure::SimulationFailure;
use common::scene::{Motion, Scene};
use nalgebra::DVector;

/// Positions and velocities of all bodies at one time: coordinates of the centre of mass and angle of free
/// bodies, `None` for prescribed ones.
#[derive(Debug, Clone, PartialEq)]
pub struct Pose {
    /// Time of the pose [s].
    pub time: f64,
    /// (x, y, angle) of each free body, by body of the scene [m, m, rad].
    pub q: Vec<Option<[f64; 3]>>,
    /// Rates of `q` [m/s, m/s, rad/s].
    pub v: Vec<Option<[f64; 3]>>,
}

/// Angles of a cycle at which closure is checked.
const CHECKED: usize = 180;
/// A step of the continuation is halved until the bodies move by no more than this share of the mechanism's
/// size.
const LONGEST: f64 = 0.2;
/// Largest correction by Newton's method in a step, as a share of the motion that velocities predict ...
const CORRECTION_OF_MOTION: f64 = 0.3;
/// ... or as a share of the mechanism's size.
const CORRECTION_OF_SIZE: f64 = 0.01;
/// Shortest step, as a share of the cycle: where even that is too long, the motion ends.
const SHORTEST: f64 = 1e-8;

/// The mechanism with ideal joints at `samples` equal times of one cycle, ends included: its motion in the
/// limit of vanishing clearance, followed by continuation from the approximate start of the scene. Adds the
/// Newton iterations to `iterations`. Returns the start alone where drives and joints do not determine the
/// motion.
///
/// # Errors
/// [`SimulationFailure::CannotAssemble`] if a joint cannot be closed at the start,
/// [`SimulationFailure::StartVelocity`] if a start velocity of the scene cannot hold,
/// [`SimulationFailure::OverConstrained`] if constraints of ideal joints are redundant,
/// [`SimulationFailure::DeadPoint`] with joint and angle where the linkage locks on its way,
/// [`SimulationFailure::ChangePoint`] where its motion may go on in more than one way.
pub fn ideal_cycle(
    scene: &Scene,
    samples: usize,
    iterations: &mut u64,
) -> Result<Vec<Pose>, SimulationFailure> {
    if let Some((local, origin)) = moved_to_origin(scene) {
        let mut poses = ideal_cycle(&local, samples, iterations)?;
        for q in poses.iter_mut().flat_map(|pose| &mut pose.q).flatten() {
            (0..2).for_each(|k| q[k] += origin[k]);
        }
        return Ok(poses);
    }
    let closure = Closure::new(scene);
    let mut q = closure.start();
    let (joint, gap, angle) = closure.contradiction(0.0, &q);
    closure.close(0.0, &mut q, iterations).map_err(|_| SimulationFailure::CannotAssemble {
        joint: scene.joints[joint].name.clone(),
        gap,
        angle,
    })?;
    if let Some(joint) = closure.first_dependent_joint(&q) {
        return Err(SimulationFailure::OverConstrained { joint: scene.joints[joint].name.clone() });
    }
    let intervals = samples.max(2) - 1;
    let refine = CHECKED.div_ceil(intervals);
    let time = |k: usize| scene.life.period * k as f64 / (intervals * refine) as f64;
    let v = closure.start_velocity(&q)?;
    let mut poses = vec![Pose { time: 0.0, q: closure.split(&q), v: closure.split(&v) }];
    if !closure.is_determined(&q) {
        return Ok(poses);
    }
    let orientation = closure.orientation(0.0, &q);
    let mut watch = ChangePoints::new(&closure, &q);
    for k in 1..=intervals * refine {
        let followed = follow(&closure, orientation, time(k - 1), time(k), &mut q, iterations);
        let found = match &followed {
            Ok(()) => watch.passed(time(k), &q),
            Err(stop) => watch.ahead(stop.time, &q),
        };
        if let Some(stop) = found {
            return Err(stopped(scene, stop, true));
        }
        followed.map_err(|stop| stopped(scene, stop, false))?;
        if k % refine == 0 {
            poses.push(pose(&closure, time(k), &q));
        }
    }
    Ok(poses)
}

/// Pose at time `t` [s] and coordinates `q`.
fn pose(closure: &Closure, t: f64, q: &DVector<f64>) -> Pose {
    Pose { time: t, q: closure.split(q), v: closure.split(&closure.velocity(t, q)) }
}

/// Follows the motion from one time to another by continuation with adaptive steps.
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
        let mut fits = far <= LONGEST * closure.size;
        if fits {
            match closure.close(t + ahead, &mut trial, iterations) {
                Ok(()) => {
                    let correction = closure.largest(&(&trial - &*q - &predicted));
                    fits = correction <= (CORRECTION_OF_MOTION * far).max(CORRECTION_OF_SIZE * closure.size)
                        && closure.orientation(t + ahead, &trial) == orientation;
                }
                Err(open) => (fits, culprit) = (false, Some(open)),
            }
        }
        if fits {
            q.copy_from(&trial);
            t = if ahead == to - t { to } else { t + ahead };
            stretch = (2.0 * ahead).min(to - from);
        } else {
            stretch = 0.5 * ahead;
            if stretch < SHORTEST * closure.scene.life.period {
                let joint = culprit.unwrap_or_else(|| closure.weakest_joint(t, q));
                return Err(Stop { time: t, joint });
            }
        }
    }
    Ok(())
}

/// Accelerations of the ideal mechanism in these poses, per body of the scene as in [`Pose`] [m/s^2,
/// rad/s^2]; `None` if joints and drives do not determine the motion in one of them.
pub(crate) fn ideal_accelerations(scene: &Scene, poses: &[Pose]) -> Option<Vec<Vec<Option<[f64; 3]>>>> {
    let closure = Closure::new(scene);
    let acceleration =
        |pose: &Pose| closure.acceleration(pose.time, &closure.joined(&pose.q), &closure.joined(&pose.v));
    poses.iter().map(|pose| acceleration(pose).map(|a| closure.split(&a))).collect()
}

/// The failure at this position, a change point or a dead one, with the first driven body and its angle.
fn stopped(scene: &Scene, Stop { time, joint }: Stop, is_change_point: bool) -> SimulationFailure {
    let ((body, angle), joint) = (drive(scene, time), scene.joints[joint].name.clone());
    if is_change_point {
        return SimulationFailure::ChangePoint { joint, body, angle };
    }
    SimulationFailure::DeadPoint { joint, time, body, angle }
}

/// Name of the first driven body, and its angle at time `t` [s] [rad].
fn drive(scene: &Scene, t: f64) -> (String, f64) {
    let driven = scene.bodies.iter().find(|b| matches!(b.motion, Motion::Driven { .. }));
    let angle = driven.and_then(super::Prescribed::from_body).map_or(0.0, |motion| motion.angle(t));
    (driven.map_or_else(String::new, |b| b.name.clone()), angle)
}

/// Smallest share at a time of the continuation below which a minimum is sought: two degrees of a crank beside a change point leave some 0.03 [1].
const SOUGHT: f64 = 0.3;
/// Share that counts as zero: lengths right to ten digits leave 1e-5 [1].
const ZERO: f64 = 1e-5;
/// Sections of an interval, down to rounding.
const SECTIONS: usize = 60;
/// Time beyond a position at which the motion ends, over the cycle, at which the joints can be closed if it is a change point [1].
const BEYOND: f64 = 1e-4;
/// Largest motion over that time, over the size of the mechanism [1].
const NEARBY: f64 = 0.05;

/// Time at which the motion ends, and index of the joint that could not be closed, or that depends on others.
pub(super) struct Stop {
    pub(super) time: f64,
    pub(super) joint: usize,
}

/// A position of the continuation with its smallest share.
struct Position {
    time: f64,
    q: DVector<f64>,
    share: f64,
}

/// Looks for change points between the times of the continuation.
pub(super) struct ChangePoints<'c> {
    closure: &'c Closure<'c>,
    /// The last two positions.
    before: Option<Position>,
    last: Position,
}

impl<'c> ChangePoints<'c> {
    /// From the start `q` on.
    pub(super) fn new(closure: &'c Closure<'c>, q: &DVector<f64>) -> Self {
        let last = Position { time: 0.0, q: q.clone(), share: closure.independence(0.0, q).1 };
        ChangePoints { closure, before: None, last }
    }

    /// A change point before the next position `q` of the continuation, at `time` [s].
    pub(super) fn passed(&mut self, time: f64, q: &DVector<f64>) -> Option<Stop> {
        let next = Position { time, q: q.clone(), share: self.closure.independence(time, q).1 };
        let last = std::mem::replace(&mut self.last, next);
        let rises = last.share < self.last.share && last.share < SOUGHT;
        let falls = |before: &Position| last.share <= before.share;
        let found = match &self.before {
            Some(before) if rises && falls(before) => self.minimum(before, time),
            _ => None,
        };
        self.before = Some(last);
        found
    }

    /// Whether the position `q` at which the motion ends, at `time` [s], is a change point: the joints can be closed beyond it.
    pub(super) fn ahead(&self, time: f64, q: &DVector<f64>) -> Option<Stop> {
        let (joint, share) = self.closure.independence(time, q);
        let mut beyond = q.clone();
        let closes =
            self.closure.close(time + BEYOND * self.closure.scene.life.period, &mut beyond, &mut 0).is_ok();
        let is_near = self.closure.largest(&(&beyond - q)) < NEARBY * self.closure.size;
        (share < SOUGHT && closes && is_near).then_some(Stop { time, joint })
    }

    /// The smallest share between a position and a later time, if it is zero.
    fn minimum(&self, from: &Position, to: f64) -> Option<Stop> {
        let share = |t: f64| {
            let mut q = &from.q + self.closure.velocity(from.time, &from.q) * (t - from.time);
            match self.closure.close(t, &mut q, &mut 0) {
                Ok(()) => self.closure.independence(t, &q),
                Err(_) => (0, f64::INFINITY),
            }
        };
        const GOLDEN: f64 = 0.618_033_988_749_894_9;
        let (mut low, mut high) = (from.time, to);
        let within = |low: f64, high: f64, part: f64| low + part * (high - low);
        for _ in 0..SECTIONS {
            let (a, b) = (within(low, high, 1.0 - GOLDEN), within(low, high, GOLDEN));
            if share(a).1 < share(b).1 { high = b } else { low = a }
        }
        let time = 0.5 * (low + high);
        let (joint, least) = share(time);
        (least < ZERO).then_some(Stop { time, joint })
    }
}
