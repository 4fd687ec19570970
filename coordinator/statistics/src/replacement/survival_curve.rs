//! A curve of reliability, straight between its points, and what follows from it:
//!
//!   mean life up to t = integral of R from 0 to t,   density f = -dR/dt,   hazard h = f / R,
//!
//! density and hazard as means over intervals: f = -(R_b - R_a) / (b - a), h = -(ln R_b - ln R_a) / (b - a).
//!
//! # Source
//! Barlow, Proschan (1965), Mathematical Theory of Reliability, Wiley, chapter 2.

/// Reliability R(t), straight between points.
#[derive(Debug, Clone, PartialEq)]
pub struct SurvivalCurve {
    /// Times, increasing from 0 `(g,)` [cycles].
    pub times: Vec<f64>,
    /// R `(g,)` [1], not increasing.
    pub reliability: Vec<f64>,
    /// Integral of R from 0 `(g,)` [cycles].
    pub(super) integral: Vec<f64>,
}

impl SurvivalCurve {
    /// The curve through points `(g,)` with increasing times [cycles]. Values are clamped to [0, 1] and to what came before
    /// them: failures do not heal. Without a point at time 0, R(0) is 1.
    pub fn new(times: &[f64], reliability: &[f64]) -> Self {
        let start = times.first().is_none_or(|t| *t > 0.0);
        let mut curve = Self { times: vec![], reliability: vec![], integral: vec![] };
        if start {
            curve.push(0.0, 1.0);
        }
        times.iter().zip(reliability).for_each(|(t, r)| curve.push(*t, *r));
        curve
    }

    fn push(&mut self, time: f64, reliability: f64) {
        let (before, r_before) = (self.end(), self.last());
        let r = reliability.clamp(0.0, 1.0).min(r_before);
        let area = self.restricted_mean() + 0.5 * (time - before) * (r + r_before);
        self.times.push(time);
        self.reliability.push(r);
        self.integral.push(area);
    }

    /// Last time of the curve [cycles].
    pub fn end(&self) -> f64 {
        self.times.last().copied().unwrap_or(0.0)
    }

    /// R at the last time [1].
    pub fn last(&self) -> f64 {
        self.reliability.last().copied().unwrap_or(1.0)
    }

    /// Index of the last point not after `time`, and the distance of `time` from it [cycles]. Times beyond the end count as
    /// the end.
    fn place(&self, time: f64) -> (usize, f64) {
        let time = time.clamp(0.0, self.end());
        let k = self.times.partition_point(|t| *t <= time).clamp(1, self.times.len()) - 1;
        (k, time - self.times[k])
    }

    /// Slope of R after point `k` [1/cycle], at most 0; 0 after the last point.
    fn slope(&self, k: usize) -> f64 {
        let Some(next) = self.times.get(k + 1) else { return 0.0 };
        (self.reliability[k + 1] - self.reliability[k]) / (next - self.times[k])
    }

    /// R at a time [1].
    pub fn at(&self, time: f64) -> f64 {
        let (k, past) = self.place(time);
        self.reliability[k] + past * self.slope(k)
    }

    /// Mean life up to `time` [cycles]: the integral of R from 0 to it.
    pub fn mean_until(&self, time: f64) -> f64 {
        let (k, past) = self.place(time);
        self.integral[k] + past * (self.reliability[k] + 0.5 * past * self.slope(k))
    }

    /// Mean life up to the last time [cycles]: the mean life itself where R has come to 0, else a lower bound of it.
    pub fn restricted_mean(&self) -> f64 {
        self.integral.last().copied().unwrap_or(0.0)
    }

    /// Time at which R falls to `level` [cycles]; `None` if it does not.
    pub fn life_at(&self, level: f64) -> Option<f64> {
        let k = self.reliability.iter().position(|r| *r <= level)?;
        if k == 0 {
            return Some(self.times[0]);
        }
        Some(self.times[k - 1] + (level - self.reliability[k - 1]) / self.slope(k - 1))
    }

    /// Density and hazard over the interval from `from` to `to` [cycles].
    pub fn rate(&self, from: f64, to: f64) -> (f64, Option<f64>) {
        let (before, after, width) = (self.at(from), self.at(to), to - from);
        let hazard = (after > 0.0).then(|| (before / after).ln() / width);
        ((before - after) / width, hazard)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_triangular_curve_has_its_closed_forms() {
        let curve = SurvivalCurve::new(&[0.0, 100.0, 200.0], &[1.0, 1.0, 0.0]);
        assert_eq!((curve.at(150.0), curve.restricted_mean()), (0.5, 150.0));
        assert!((curve.mean_until(150.0) - 137.5).abs() < 1e-12);
        assert_eq!((curve.life_at(0.75), curve.life_at(1.0)), (Some(125.0), Some(0.0)));
        let (density, hazard) = curve.rate(100.0, 150.0);
        assert!((density - 0.01).abs() < 1e-15);
        assert!((hazard.unwrap() - 2f64.ln() / 50.0).abs() < 1e-15);
        assert_eq!(curve.rate(150.0, 200.0).1, None);
        assert_eq!((curve.at(300.0), curve.mean_until(300.0)), (0.0, 150.0));
    }

    #[test]
    fn noise_does_not_heal_failures() {
        let curve = SurvivalCurve::new(&[10.0, 20.0, 30.0], &[0.9, 0.95, 1.2]);
        assert_eq!(curve.reliability, [1.0, 0.9, 0.9, 0.9]);
        assert_eq!((curve.times[0], curve.life_at(0.5)), (0.0, None));
    }
}
