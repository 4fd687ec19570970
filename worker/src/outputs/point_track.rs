//! Path of a point of a body over a cycle, at the times of the integrator.

use super::trace::{Piece, before};

/// Position and velocity of a point, at increasing times.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PointTrack {
    /// Time `(n,)` [s].
    time: Vec<f64>,
    /// Coordinates x, y `(2, n)` [m].
    position: [Vec<f64>; 2],
    /// Their rates `(2, n)` [m/s].
    velocity: [Vec<f64>; 2],
}

impl PointTrack {
    /// Removes all states.
    pub(crate) fn clear(&mut self) {
        self.time.clear();
        self.position.iter_mut().chain(&mut self.velocity).for_each(Vec::clear);
    }

    /// Removes the states up to a time [s], as far as two are left.
    pub(crate) fn drop_until(&mut self, time: f64) {
        let dropped = before(&self.time, time);
        self.time.drain(..dropped);
        self.position.iter_mut().chain(&mut self.velocity).for_each(|values| {
            values.drain(..dropped);
        });
    }

    /// Adds a state: time [s], position [m] and velocity [m/s].
    pub(crate) fn push(&mut self, time: f64, position: [f64; 2], velocity: [f64; 2]) {
        self.time.push(time);
        for k in 0..2 {
            self.position[k].push(position[k]);
            self.velocity[k].push(velocity[k]);
        }
    }

    /// Times of the states `(n,)` [s].
    pub(crate) fn times(&self) -> &[f64] {
        &self.time
    }

    /// Position at time `t` [s] in interval `k`, by cubic Hermite interpolation [m].
    pub(crate) fn position_in(&self, k: usize, t: f64) -> [f64; 2] {
        [0, 1].map(|axis| {
            let velocity = &self.velocity[axis];
            Piece::new(&self.time, &self.position[axis], [velocity[k], velocity[k + 1]], k).at(t).0
        })
    }
}
