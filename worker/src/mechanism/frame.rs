//! Where a body stands and how it moves at one instant.

/// Position and motion of a body's reference point (the centre of mass of a free body).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Frame {
    /// Position `(2,)` [m].
    pub x: [f64; 2],
    /// Cosine and sine of the angle [1].
    pub cs: [f64; 2],
    /// Velocity `(2,)` [m/s].
    pub v: [f64; 2],
    /// Angular velocity [rad/s].
    pub omega: f64,
}

impl Frame {
    /// Of a free body with coordinates (x, y, angle) and their rates.
    #[inline]
    pub fn free(q: &[f64], v: &[f64]) -> Self {
        let (sin, cos) = libm::sincos(q[2]);
        Frame { x: [q[0], q[1]], cs: [cos, sin], v: [v[0], v[1]], omega: v[2] }
    }

    /// A vector of the body's frame in global axes.
    #[inline]
    pub fn turn(&self, s: [f64; 2]) -> [f64; 2] {
        let [c, d] = self.cs;
        [c * s[0] - d * s[1], d * s[0] + c * s[1]]
    }

    /// A global vector in the body's axes.
    #[inline]
    pub fn turn_back(&self, a: [f64; 2]) -> [f64; 2] {
        let [c, d] = self.cs;
        [c * a[0] + d * a[1], -d * a[0] + c * a[1]]
    }

    /// Position of a point of the body given in its frame [m].
    pub fn point(&self, s: [f64; 2]) -> [f64; 2] {
        let a = self.turn(s);
        [self.x[0] + a[0], self.x[1] + a[1]]
    }
}
