//! Moment of joints and loads on a driven body over a cycle, at the times of the integrator.

use super::trace::before;

/// Moment on a driven body about its axis, at increasing times.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MomentTrack {
    /// Time `(n,)` [s].
    pub time: Vec<f64>,
    /// Moment `(n,)` [N m].
    pub moment: Vec<f64>,
}

impl MomentTrack {
    /// Removes all instants.
    pub(crate) fn clear(&mut self) {
        self.time.clear();
        self.moment.clear();
    }

    /// Removes the instants up to a time [s], as far as two are left.
    pub(crate) fn drop_until(&mut self, time: f64) {
        let dropped = before(&self.time, time);
        self.time.drain(..dropped);
        self.moment.drain(..dropped);
    }

    /// Adds the moment [N m] at a time [s].
    pub(crate) fn push(&mut self, time: f64, moment: f64) {
        self.time.push(time);
        self.moment.push(moment);
    }

    /// Moment at time `t` [s], by linear interpolation [N m].
    pub(crate) fn moment_at(&self, t: f64) -> f64 {
        let n = self.time.len();
        if n < 2 {
            return self.moment.first().copied().unwrap_or(0.0);
        }
        let k = self.time.partition_point(|&x| x <= t).clamp(1, n - 1) - 1;
        let s = ((t - self.time[k]) / (self.time[k + 1] - self.time[k])).clamp(0.0, 1.0);
        self.moment[k] + s * (self.moment[k + 1] - self.moment[k])
    }
}
