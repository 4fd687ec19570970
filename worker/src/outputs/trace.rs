//! Angle of a body, path of a point and moment on a driven body over a cycle, at the times of the integrator, with interpolation
//! between them; largest force of a joint.
//!
//! # Source
//! Cubic Hermite interpolation: de Boor, A Practical Guide to Splines (1978), chapter IV.

use crate::interpolate::Cubic;

/// Largest accepted slope over the secants nearby [1]. A sine sampled every x radians has slopes of at most x / (2 sin x) times
/// the secant where it peaks, below this value up to x = 2.2, and x / sin x where it is steepest, below it up to x = 1.5.
const LARGEST_SLOPE: f64 = 1.5;

/// Interval of increasing `times` `(n,)` that contains `time` [s], from interval `k` on, which it replaces.
pub(super) fn interval_at(times: &[f64], k: &mut usize, time: f64) -> usize {
    while *k + 2 < times.len() && times[*k + 1] < time {
        *k += 1;
    }
    *k
}

/// Quantities at increasing times.
#[derive(Debug, Clone, PartialEq)]
pub struct Track<const N: usize> {
    /// Time `(n,)` [s].
    pub time: Vec<f64>,
    /// The quantities `(N, n)` [SI].
    pub values: [Vec<f64>; N],
}

/// Angle of one body [rad] with its first two rates [rad/s], [rad/s^2].
pub type BodyTrack = Track<3>;

/// Coordinates x, y of a point [m], then their rates [m/s].
pub type PointTrack = Track<4>;

/// Moment on a driven body about its axis [N m].
pub type MomentTrack = Track<1>;

impl<const N: usize> Default for Track<N> {
    fn default() -> Self {
        Track { time: vec![], values: std::array::from_fn(|_| vec![]) }
    }
}

impl<const N: usize> Track<N> {
    /// Removes all states.
    pub(crate) fn clear(&mut self) {
        self.time.clear();
        self.values.iter_mut().for_each(Vec::clear);
    }

    /// Removes the states up to a time [s], as far as two are left.
    pub(crate) fn drop_until(&mut self, time: f64) {
        let before = self.time.partition_point(|&t| t <= time).min(self.time.len().saturating_sub(2));
        for values in self.values.iter_mut().chain([&mut self.time]) {
            values.drain(..before);
        }
    }

    /// Adds the quantities at a time [s].
    #[inline]
    pub(crate) fn push(&mut self, time: f64, values: [f64; N]) {
        self.time.push(time);
        self.values.iter_mut().zip(values).for_each(|(all, value)| all.push(value));
    }
}

impl MomentTrack {
    /// Moment at time `t` [s], by linear interpolation [N m].
    pub(crate) fn moment_at(&self, t: f64) -> f64 {
        let Track { time, values: [moment] } = self;
        let n = time.len();
        if n < 2 {
            return moment.first().copied().unwrap_or(0.0);
        }
        let k = time.partition_point(|&x| x <= t).clamp(1, n - 1) - 1;
        moment[k] + share_of([time[k], time[k + 1]], t) * (moment[k + 1] - moment[k])
    }
}

impl PointTrack {
    /// Position at time `t` [s] in interval `k`, by cubic Hermite interpolation [m].
    pub(crate) fn position_in(&self, k: usize, t: f64) -> [f64; 2] {
        let [x, y, vx, vy] = &self.values;
        [(x, vx), (y, vy)].map(|(x, v)| Piece::new(&self.time, x, [v[k], v[k + 1]], k).at(t).0)
    }
}

impl BodyTrack {
    /// Angle in interval `k`, by cubic Hermite interpolation.
    #[inline]
    pub(crate) fn angle_in(&self, k: usize) -> Piece {
        let [angle, omega, _] = &self.values;
        Piece::new(&self.time, angle, [omega[k], omega[k + 1]], k)
    }

    /// Angular velocity in interval `k`, by cubic Hermite interpolation. Accelerations are limited to [`LARGEST_SLOPE`] times the
    /// largest change of velocity over the interval and its two neighbours.
    ///
    /// A step far longer than the period of a contact vibration skips it: little of the vibration remains in the velocity,
    /// but much in the acceleration, and a cubic with that slope would have peaks that do not exist.
    #[inline]
    pub(crate) fn omega_in(&self, k: usize) -> Piece {
        let [_, omega, alpha] = &self.values;
        let change = |k: usize| (omega[k + 1] - omega[k]).abs();
        let around = k.saturating_sub(1)..=(k + 1).min(self.time.len() - 2);
        let most = LARGEST_SLOPE * around.map(change).fold(0.0, f64::max) / (self.time[k + 1] - self.time[k]);
        let slopes = [alpha[k], alpha[k + 1]].map(|a| a.clamp(-most, most));
        Piece::new(&self.time, omega, slopes, k)
    }

    /// Angle [rad] and angular velocity [rad/s] at times `at` [s], increasing and within the track, each by cubic Hermite
    /// interpolation.
    pub(crate) fn resample(&self, at: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let mut k = 0;
        at.iter()
            .map(|&t| {
                let k = interval_at(&self.time, &mut k, t);
                (self.angle_in(k).at(t).0, self.omega_in(k).at(t).0)
            })
            .unzip()
    }
}

/// A quantity between two neighbouring times of a track.
#[derive(Debug, Clone, Copy)]
pub struct Piece {
    /// The times [s].
    pub span: [f64; 2],
    /// The quantity over the fraction of the span.
    cubic: Cubic,
}

impl Piece {
    /// The cubic through values and slopes at both ends of interval `k`.
    #[inline]
    pub(super) fn new(time: &[f64], value: &[f64], slope: [f64; 2], k: usize) -> Self {
        let h = time[k + 1] - time[k];
        let cubic = Cubic::hermite([value[k], value[k + 1]], [slope[0] * h, slope[1] * h]);
        Piece { span: [time[k], time[k + 1]], cubic }
    }

    /// Value and slope at time `t` [s].
    #[inline]
    pub(crate) fn at(&self, t: f64) -> (f64, f64) {
        let [start, end] = self.span;
        let h = end - start;
        let s = (t - start) / h;
        (self.cubic.value(s), self.cubic.slope(s) / h)
    }
}

/// Share of `t` [s] in the span between two times [s], from 0 to 1.
#[inline]
pub(super) fn share_of([start, end]: [f64; 2], t: f64) -> f64 {
    ((t - start) / (end - start)).clamp(0.0, 1.0)
}

/// Force magnitude of one joint over a cycle: its peak, and the time in free flight.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ForceTrack {
    /// Largest magnitude so far [N].
    pub peak: f64,
    /// Time in free flight so far [s].
    pub free: f64,
    /// True if the last instant was one of free flight.
    is_free: bool,
}

impl ForceTrack {
    /// Adds the force [N] at the end of a step of length 2 `half` [s]; the joint is in free flight unless it `touches`.
    pub(crate) fn push(&mut self, force: f64, touches: bool, half: f64) {
        // Trapezoidal rule: each end of a step stands for half of it.
        for free in [std::mem::replace(&mut self.is_free, !touches), !touches] {
            self.free += if free { half } else { 0.0 };
        }
        self.peak = self.peak.max(force);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_vibration_passed_over_shows_no_peaks_and_one_followed_keeps_them() {
        // 1.2 radians a step, then long steps over a slow motion with the noise of a vibration in its accelerations.
        let (mut followed, mut passed) = (BodyTrack::default(), BodyTrack::default());
        for k in 0..60 {
            let t = 1.2 * f64::from(k) + 0.3;
            followed.push(t, [0.0, t.sin(), t.cos()]);
            passed.push(t, [0.0, 1e-3 * t, if k % 2 == 0 { 50.0 } else { -50.0 }]);
        }
        let unlimited = |k: usize, t: f64| {
            let [_, omega, alpha] = &followed.values;
            Piece::new(&followed.time, omega, [alpha[k], alpha[k + 1]], k).at(t)
        };
        for k in 0..59 {
            let t = followed.time[k] + 0.5;
            // An end of the track has a neighbour on one side alone.
            if (1..58).contains(&k) {
                assert_eq!(followed.omega_in(k).at(t), unlimited(k, t));
            }
            // Slopes at the cap differ from the straight line by at most 2.5 times its rise, of which a cubic shows
            // a quarter; with the accelerations as they are it would be 50 * 1.2 / 4.
            assert!((passed.omega_in(k).at(t).0 - 1e-3 * t).abs() < 0.625 * 1.2e-3);
        }
    }

    #[test]
    fn resampling_is_exact_for_cubics() {
        let (mut track, f) = (BodyTrack::default(), |t: f64| (t * t, 2.0 * t, 2.0));
        for k in 0..5 {
            let t = 0.1 * (k * k) as f64;
            let (a, o, al) = f(t);
            track.push(t, [a, o, al]);
        }
        let at = [0.0, 0.05, 0.3, 1.6];
        let (angle, omega) = track.resample(&at);
        for (i, &t) in at.iter().enumerate() {
            assert!((angle[i] - f(t).0).abs() < 1e-14 && (omega[i] - f(t).1).abs() < 1e-14);
        }
    }
}
