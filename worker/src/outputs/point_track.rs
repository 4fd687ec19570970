//! Path of a point of a body over a cycle, at the times of the integrator.

use super::trace::Piece;

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

/// Places within an interval of the integrator at which the distance, which is smooth, is evaluated [1].
const WITHIN: [f64; 3] = [0.25, 0.5, 0.75];

impl PointTrack {
    /// Removes all states.
    pub(crate) fn clear(&mut self) {
        self.time.clear();
        self.position.iter_mut().chain(&mut self.velocity).for_each(Vec::clear);
    }

    /// Adds a state: time [s], position [m] and velocity [m/s].
    pub(crate) fn push(&mut self, time: f64, position: [f64; 2], velocity: [f64; 2]) {
        self.time.push(time);
        for k in 0..2 {
            self.position[k].push(position[k]);
            self.velocity[k].push(velocity[k]);
        }
    }

    /// Position at time `t` [s] in interval `k`, by cubic Hermite interpolation [m].
    fn position_in(&self, k: usize, t: f64) -> [f64; 2] {
        [0, 1].map(|axis| {
            let velocity = &self.velocity[axis];
            Piece::new(&self.time, &self.position[axis], [velocity[k], velocity[k + 1]], k).at(t).0
        })
    }

    /// Largest distance from `other`, whose track covers the same span of time [m].
    pub(crate) fn largest_distance(&self, other: &PointTrack) -> f64 {
        let mut largest: f64 = 0.0;
        let mut j = 0;
        for k in 0..self.time.len().saturating_sub(1) {
            let (from, to) = (self.time[k], self.time[k + 1]);
            let inside = WITHIN.into_iter().map(|share| from + share * (to - from));
            for t in std::iter::once(from).chain(inside).chain(std::iter::once(to)) {
                while j + 2 < other.time.len() && other.time[j + 1] < t {
                    j += 1;
                }
                let (a, b) = (self.position_in(k, t), other.position_in(j, t));
                largest = largest.max(libm::hypot(a[0] - b[0], a[1] - b[1]));
            }
        }
        largest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_distance_between_a_circle_and_a_shifted_one_is_the_shift() {
        let circle = |n: usize, shift: f64, wobble: f64| {
            let mut track = PointTrack::default();
            for k in 0..=n {
                let t = k as f64 / n as f64;
                let ((s, c), tau) = ((std::f64::consts::TAU * t).sin_cos(), std::f64::consts::TAU);
                let bump = wobble * (tau * t).sin();
                track.push(t, [c + shift + bump, s], [-tau * s + wobble * tau * c, tau * c]);
            }
            track
        };
        let (a, b) = (circle(300, 0.0, 0.0), circle(170, 0.01, 0.0));
        assert!((a.largest_distance(&b) - 0.01).abs() < 1e-8);
        let wobbling = circle(170, 0.01, 0.005);
        assert!((a.largest_distance(&wobbling) - 0.015).abs() < 1e-6);
    }
}
