//! Value of a response between the checkpoints, by the cubic of Fritsch and Butland, which has no extremum between its points.
//!
//! # Source
//! Fritsch, Butland (1984), A method for constructing local monotone piecewise cubic interpolants, SIAM Journal on Scientific
//! and Statistical Computing 5(2).

use super::crossing::{Track, end_slopes, secant};

impl Track<'_> {
    /// Value at a time between the first known point and the last checkpoint [unit of the output]; `None` outside of them.
    pub fn value_at(&self, time: f64) -> Option<f64> {
        let first = if self.start.is_some() { -1 } else { 0 };
        let reaches = |k: &isize| self.point(*k).is_some_and(|point| point.0 >= time);
        let after = (first..self.times.len() as isize).find(reaches)?;
        let right = self.point(after)?;
        if after == first || right.0 == time {
            return (right.0 == time).then_some(right.1);
        }
        let left = self.point(after - 1)?;
        let h = right.0 - left.0;
        let piece = |a: (f64, f64), b: (f64, f64)| (secant(a, b), b.0 - a.0);
        let middle = piece(left, right);
        let before = self.point(after - 2).map(|point| piece(point, left));
        let behind = self.point(after + 1).map(|point| piece(right, point));
        let [d0, d1] = end_slopes(middle, [before, behind]);
        let (t, u) = ((time - left.0) / h, (right.0 - time) / h);
        let ends = left.1 * (1.0 + 2.0 * t) * u * u + right.1 * t * t * (3.0 - 2.0 * t);
        Some(ends + h * t * u * (d0 * u - d1 * t))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smooth_histories_are_met_between_their_points() {
        let times: Vec<f64> = (1..=10).map(|k| 100.0 * f64::from(k)).collect();
        let growth = |t: f64| 2.0 + t / 500.0 + (t / 1000.0).powi(2);
        let values: Vec<f64> = times.iter().map(|t| growth(*t)).collect();
        for start in [Some(growth(0.0)), None] {
            let track = Track { times: &times, values: &values, start };
            for t in [100.0, 130.0, 455.0, 900.0, 970.0, 1000.0] {
                let found = track.value_at(t).unwrap();
                assert!((found / growth(t) - 1.0).abs() < 2e-4, "{t} {found} {}", growth(t));
            }
            assert_eq!(track.value_at(1000.1), None);
        }
        let track = Track { times: &times, values: &values, start: Some(2.0) };
        assert!((track.value_at(40.0).unwrap() - growth(40.0)).abs() < 1e-3);
        assert_eq!(track.value_at(0.0), Some(2.0));
        assert_eq!(Track { start: None, ..track }.value_at(40.0), None);
    }

    #[test]
    fn a_single_interval_is_straight() {
        let track = Track { times: &[10.0], values: &[3.0], start: Some(1.0) };
        assert!((track.value_at(5.0).unwrap() - 2.0).abs() < 1e-15);
    }
}
