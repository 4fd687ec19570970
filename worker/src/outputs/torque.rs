//! The torque that a driven body needs, from the moments that joints and loads exert on it.

/// Moment on a driven body about its axis, at increasing times.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MomentTrack {
    /// Time `(n,)` [s].
    pub time: Vec<f64>,
    /// Moment `(n,)` [N m].
    pub moment: Vec<f64>,
}

impl MomentTrack {
    /// Forgets everything.
    pub fn clear(&mut self) {
        self.time.clear();
        self.moment.clear();
    }

    /// Adds an instant.
    pub fn push(&mut self, time: f64, moment: f64) {
        self.time.push(time);
        self.moment.push(moment);
    }

    /// Moment at `t`, by linear interpolation [N m].
    fn at(&self, t: f64) -> f64 {
        let n = self.time.len();
        if n < 2 {
            return self.moment.first().copied().unwrap_or(0.0);
        }
        let k = self.time.partition_point(|&x| x <= t).clamp(1, n - 1) - 1;
        let s = ((t - self.time[k]) / (self.time[k + 1] - self.time[k])).clamp(0.0, 1.0);
        self.moment[k] + s * (self.moment[k + 1] - self.moment[k])
    }
}

/// max over t of |torque(t)|, torque = own(t) - sum of the moments: `own` is what the body itself needs, its inertia
/// and what acts on it besides [N m]. Looked at whenever one of the moments is known, and at `times`.
pub fn largest_torque(moments: &[&MomentTrack], times: &[f64], own: impl Fn(f64) -> f64) -> f64 {
    let known = moments.iter().flat_map(|m| &m.time);
    known.chain(times).fold(0.0, |largest: f64, &t| {
        let moment: f64 = moments.iter().map(|m| m.at(t)).sum();
        largest.max((own(t) - moment).abs())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_of_two_islands_add_up_at_the_times_of_both() {
        let track = |times: &[f64], f: fn(f64) -> f64| MomentTrack {
            time: times.to_vec(),
            moment: times.iter().map(|&t| f(t)).collect(),
        };
        let (a, b) = (track(&[0.0, 0.5, 1.0], |t| 2.0 * t), track(&[0.0, 0.3, 1.0], |t| 1.0 - t));
        // -(2 t + 1 - t) + 0.5 has its largest size at t = 1: 1.5.
        assert!((largest_torque(&[&a, &b], &[], |_| 0.5) - 1.5).abs() < 1e-15);
        assert_eq!(largest_torque(&[], &[0.0, 2.0], |t| -t), 2.0);
    }
}
