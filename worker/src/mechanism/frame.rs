//! Where a body stands and how it moves at one instant.

use crate::lanes::{Real, sincos};

/// Position and motion of a body's reference point (the centre of mass of a free body).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Frame<R = f64> {
    /// Position `(2,)` [m].
    pub x: [R; 2],
    /// Angle [rad].
    pub angle: R,
    /// Cosine and sine of the angle [1].
    pub cs: [R; 2],
    /// Velocity `(2,)` [m/s].
    pub v: [R; 2],
    /// Angular velocity [rad/s].
    pub omega: R,
}

impl<R: Real> Frame<R> {
    /// Of a free body with coordinates (x, y, angle) and their rates.
    #[inline(always)]
    pub fn free(q: &[R], v: &[R]) -> Self {
        let (sin, cos) = sincos(q[2]);
        Frame { x: [q[0], q[1]], angle: q[2], cs: [cos, sin], v: [v[0], v[1]], omega: v[2] }
    }

    /// A vector of the body's frame in global axes.
    #[inline(always)]
    pub fn turn(&self, s: [R; 2]) -> [R; 2] {
        let [c, d] = self.cs;
        [c * s[0] - d * s[1], d * s[0] + c * s[1]]
    }

    /// A global vector in the body's axes.
    #[inline(always)]
    pub fn turn_back(&self, a: [R; 2]) -> [R; 2] {
        let [c, d] = self.cs;
        [c * a[0] + d * a[1], -d * a[0] + c * a[1]]
    }

    /// Position of a point of the body given in its frame [m].
    #[inline(always)]
    pub fn point(&self, s: [R; 2]) -> [R; 2] {
        let a = self.turn(s);
        [self.x[0] + a[0], self.x[1] + a[1]]
    }

    /// Velocity of a point of the body given in its frame [m/s].
    #[inline(always)]
    pub fn velocity(&self, s: [R; 2]) -> [R; 2] {
        let a = self.turn(s);
        [self.v[0] - self.omega * a[1], self.v[1] + self.omega * a[0]]
    }
}

/// One end of a joint or load: which frame, and where in it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct End<R = f64> {
    /// Index of the frame.
    pub frame: usize,
    /// From the frame's reference point, in the body's axes [m].
    pub arm: [R; 2],
}
