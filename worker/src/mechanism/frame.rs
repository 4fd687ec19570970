//! Position and motion of a body, and of all bodies of an island, at one instant; the ends of joints and loads on bodies.
//!
//! # Prescribed
//! Bodies with prescribed motion: fixed, or turned about their reference point by a drive.
//!
//! # Island frames
//! Indices of the frames of one island: its free bodies, then the prescribed bodies that its joints and loads
//! touch.

use super::piecewise_cubic::{Jet, PiecewiseCubic};
use crate::lanes::{Real, lanewise, sincos};
use crate::plane::{turned, turned_back};
use common::scene::{Attachment, Body, Drive, Motion, Scene};

/// Position and motion of a body's reference point (the centre of mass of a free body).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Frame<R = f64> {
    /// Position `(2,)` [m].
    pub x: [R; 2],
    /// Angle of the body [rad].
    pub angle: R,
    /// Cosine and sine of the angle [1].
    pub cs: [R; 2],
    /// Velocity `(2,)` [m/s].
    pub v: [R; 2],
    /// Angular velocity [rad/s].
    pub omega: R,
}

impl<R: Real> Frame<R> {
    /// Frame of a free body with coordinates q = (x, y, angle) and their rates v.
    #[inline(always)]
    pub(crate) fn free(q: &[R], v: &[R]) -> Self {
        let (sin, cos) = sincos(q[2]);
        Frame { x: [q[0], q[1]], angle: q[2], cs: [cos, sin], v: [v[0], v[1]], omega: v[2] }
    }

    /// Frame of a body that turns about its reference point `position` [m], at the angle with derivatives
    /// `jet`.
    #[inline(always)]
    pub(crate) fn turning(position: [R; 2], jet: &Jet<R>) -> Self {
        let [angle, omega, ..] = *jet;
        let (sin, cos) = sincos(angle);
        Frame { x: position, angle, cs: [cos, sin], v: [angle.zero(); 2], omega }
    }

    /// A vector of the body's frame in global axes.
    #[inline(always)]
    pub(crate) fn turn(&self, s: [R; 2]) -> [R; 2] {
        turned(s, self.cs)
    }

    /// A global vector in the body's axes.
    #[inline(always)]
    pub(crate) fn turn_back(&self, a: [R; 2]) -> [R; 2] {
        turned_back(a, self.cs)
    }

    /// Position of a point of the body given in its frame [m].
    #[inline(always)]
    pub(crate) fn point(&self, s: [R; 2]) -> [R; 2] {
        let a = self.turn(s);
        [self.x[0] + a[0], self.x[1] + a[1]]
    }

    /// Velocity of a point of the body given in its frame [m/s].
    #[inline(always)]
    pub(crate) fn velocity(&self, s: [R; 2]) -> [R; 2] {
        let a = self.turn(s);
        [self.v[0] - self.omega * a[1], self.v[1] + self.omega * a[0]]
    }
}

/// One end of a joint or load: a point of a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct End<R = f64> {
    /// Index of the frame.
    pub frame: usize,
    /// Vector from the frame's reference point, in the body's axes `(2,)` [m].
    pub arm: [R; 2],
}

lanewise!(End { frame, arm });

/// Time [s], positions `(n,)` [m, rad] and velocities `(n,)` [m/s, rad/s] of an island's free bodies.
pub type TimedState<'a> = (f64, &'a [f64], &'a [f64]);

/// State of an island's bodies, free ones first.
#[derive(Clone, Copy)]
pub struct Placed<'a, R = f64> {
    /// Frames of the free bodies, then of the prescribed ones.
    pub frames: &'a [Frame<R>],
    /// Angle and derivatives of the prescribed bodies.
    pub jets: &'a [Jet<R>],
}

impl<'a, R: Real> Placed<'a, R> {
    /// Angle and derivatives of the prescribed body of frame `index`; `None` for a free body.
    #[inline(always)]
    pub(super) fn jet(&self, index: usize) -> Option<&'a Jet<R>> {
        let free = self.frames.len() - self.jets.len();
        if index < free { None } else { Some(&self.jets[index - free]) }
    }

    /// Frames of the two bodies of these ends of a joint.
    #[inline(always)]
    pub(super) fn pair(&self, ends: &[End<R>; 2]) -> [&'a Frame<R>; 2] {
        [&self.frames[ends[0].frame], &self.frames[ends[1].frame]]
    }
}

/// A prescribed motion: the reference point stands still, the angle is a function of time.
#[derive(Debug, Clone, PartialEq)]
pub struct Prescribed {
    pub(crate) position: [f64; 2],
    angle: Angle,
}

#[derive(Debug, Clone, PartialEq)]
enum Angle {
    Still,
    Constant { start: f64, speed: f64 },
    Table(PiecewiseCubic),
    Integral { start: f64, speed: PiecewiseCubic },
}

impl Prescribed {
    /// The prescribed motion of `body`; `None` for a free body.
    pub fn from_body(body: &Body) -> Option<Self> {
        let (position, drive) = match &body.motion {
            Motion::Fixed => return Some(Prescribed { position: [0.0; 2], angle: Angle::Still }),
            Motion::Driven { position, drive, .. } => (*position, drive),
            Motion::Free { .. } => return None,
        };
        Some(Prescribed { position, ..Self::stroke(drive) })
    }

    /// A drive by itself: the distance of a linear drive [m] in the place of the angle.
    pub(super) fn stroke(drive: &Drive) -> Self {
        let angle = match drive {
            Drive::ConstantSpeed { start_angle, speed } => {
                Angle::Constant { start: *start_angle, speed: *speed }
            }
            Drive::Angle(table) => Angle::Table(PiecewiseCubic::spline(table)),
            Drive::Speed { start_angle, table } => {
                Angle::Integral { start: *start_angle, speed: PiecewiseCubic::monotone(table) }
            }
        };
        Prescribed { position: [0.0; 2], angle }
    }

    /// Angle and its first three derivatives at time `t` [s] [rad, rad/s, rad/s^2, rad/s^3].
    #[inline(always)]
    pub(crate) fn jet(&self, t: f64) -> Jet {
        match &self.angle {
            Angle::Still => [0.0; 4],
            Angle::Constant { start, speed } => [start.plus_product(*speed, t), *speed, 0.0, 0.0],
            Angle::Table(angle) => angle.jet(t),
            Angle::Integral { start, speed } => {
                let [omega, alpha, jerk, _] = speed.jet(t);
                [start + speed.integral(t) - speed.integral(0.0), omega, alpha, jerk]
            }
        }
    }

    /// Angle [rad] at time `t` [s].
    pub fn angle(&self, t: f64) -> f64 {
        self.jet(t)[0]
    }

    /// Frame of the body at time `t` [s].
    pub(crate) fn frame(&self, t: f64) -> Frame {
        Frame::turning(self.position, &self.jet(t))
    }

    /// Angle at time zero [rad] and angular velocity [rad/s] of a body that turns evenly or is fixed.
    pub(crate) fn even_rotation(&self) -> Option<[f64; 2]> {
        match self.angle {
            Angle::Still => Some([0.0; 2]),
            Angle::Constant { start, speed } => Some([start, speed]),
            Angle::Table(_) | Angle::Integral { .. } => None,
        }
    }

    /// Whether the body is fixed.
    pub(crate) fn is_still(&self) -> bool {
        self.angle == Angle::Still
    }
}

/// The frames of an island under construction.
pub struct IslandFrames<'a> {
    scene: &'a Scene,
    /// Number of free bodies.
    free: usize,
    /// Bodies of the scene by frame.
    frames: Vec<usize>,
}

impl<'a> IslandFrames<'a> {
    /// The frames of the free bodies `bodies` of a scene.
    pub(crate) fn new(scene: &'a Scene, bodies: Vec<usize>) -> Self {
        IslandFrames { scene, free: bodies.len(), frames: bodies }
    }

    /// Free bodies, all of which have a frame.
    pub(super) fn bodies(&self) -> &[usize] {
        &self.frames[..self.free]
    }

    /// Prescribed bodies that have a frame.
    pub(crate) fn touched(&self) -> &[usize] {
        &self.frames[self.free..]
    }

    /// Motions of the prescribed bodies that have a frame.
    pub(crate) fn prescribed(&self) -> Vec<Prescribed> {
        self.touched().iter().filter_map(|&b| Prescribed::from_body(&self.scene.bodies[b])).collect()
    }

    /// Index of the frame of a body of the scene.
    pub(super) fn frame(&mut self, body: usize) -> usize {
        self.frames.iter().position(|&b| b == body).unwrap_or_else(|| {
            self.frames.push(body);
            self.frames.len() - 1
        })
    }

    /// End of a joint or load at a point of a body of the scene.
    pub(super) fn end(&mut self, at: &Attachment) -> End {
        End { frame: self.frame(at.body), arm: self.scene.arm(at) }
    }
}
