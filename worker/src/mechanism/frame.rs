//! Position and motion of a body, and of all bodies of an island, at one instant; the ends of joints and loads on bodies.

use super::piecewise_cubic::Jet;
use crate::lanes::{Real, lanewise, sincos};
use crate::plane::{turned, turned_back};

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
