//! Age replacement: a unit is replaced at its failure or at the age T, whichever comes first.
//!
//! With the cost c_p of a planned replacement and c_f of a failure, replacement included, the long-run cost per cycle is
//!
//!   g(T) = (c_p R(T) + c_f (1 - R(T))) / integral of R from 0 to T,
//!
//! the mean cost of a renewal over its mean length. Where R is straight, R = R_a - b (T - a), the sign of g' is that of
//!
//!   phi = (c_f - c_p) b D - N R,   D the integral, N the mean cost,
//!
//! which is quadratic in T - a and does not fall, so that every piece has at most one minimum within, and the smallest of all
//! pieces is that of the curve, exactly. Running to failure, T -> infinity, costs c_f / mean life.
//!
//! # Source
//! Barlow, Hunter (1960), Optimum preventive maintenance policies, Operations Research 8(1); Barlow, Proschan (1965),
//! Mathematical Theory of Reliability, Wiley, section 4.2.

use super::SurvivalCurve;

/// Costs of a replacement, in any currency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReplacementCosts {
    /// Cost of a planned replacement, above 0.
    pub planned: f64,
    /// Total cost of a failure, its replacement included, larger than that of a planned one.
    pub failure: f64,
}

/// The age of replacement with the least cost rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AgeReplacement {
    /// Age of replacement [cycles].
    pub age: f64,
    /// Long-run cost of a cycle [currency/cycle].
    pub cost_rate: f64,
    /// True if the cost rate is least at the end of the curve: there is no minimum before it.
    pub at_the_end: bool,
}

impl ReplacementCosts {
    /// Mean cost of a renewal with reliability `r` [1] at the age of replacement.
    pub fn of_renewal(&self, r: f64) -> f64 {
        self.planned * r + self.failure * (1.0 - r)
    }

    /// Cost rate of replacement at `age` [currency/cycle]; infinite at age 0.
    pub fn rate(&self, curve: &SurvivalCurve, age: f64) -> f64 {
        self.of_renewal(curve.at(age)) / curve.mean_until(age)
    }

    /// Cost rate of running to failure [currency/cycle]: exact where R has come to 0 by the end of the curve, else an upper
    /// bound, since the mean life is at least that up to the end.
    pub fn of_failures(&self, curve: &SurvivalCurve) -> f64 {
        self.failure / curve.restricted_mean()
    }

    /// The age with the least cost rate.
    pub fn best_age(&self, curve: &SurvivalCurve) -> AgeReplacement {
        let (times, values, integrals) = (&curve.times, &curve.reliability, &curve.integral);
        let mut best = (curve.end(), self.rate(curve, curve.end()));
        for k in 0..times.len().saturating_sub(1) {
            let (a, width, r, area) = (times[k], times[k + 1] - times[k], values[k], integrals[k]);
            let fall = (r - values[k + 1]) / width;
            let candidates = [Some(a), self.stationary(r, fall, area).map(|past| a + past.min(width))];
            for age in candidates.into_iter().flatten().filter(|age| *age > 0.0) {
                let rate = self.rate(curve, age);
                if rate < best.1 {
                    best = (age, rate);
                }
            }
        }
        AgeReplacement { age: best.0, cost_rate: best.1, at_the_end: best.0 >= curve.end() }
    }

    /// What the points of a curve leave open of its best age: R may fall anywhere between the points beside it. Returns these two times
    /// [cycles], and the cost rate if R keeps the value of the first of them until the second [currency/cycle].
    pub fn unresolved(&self, curve: &SurvivalCurve, age: f64) -> ([f64; 2], f64) {
        let before = curve.times.partition_point(|t| *t < age).max(1) - 1;
        let after = curve.times.partition_point(|t| *t <= age).min(curve.times.len() - 1);
        let [from, to] = [before, after].map(|k| curve.times[k]);
        let r = curve.reliability[before];
        ([from, to], self.of_renewal(r) / (curve.integral[before] + r * (to - from)))
    }

    /// Distance from the beginning of a straight piece to the zero of phi [cycles], if phi is negative at its beginning:
    /// R = `r` there, falling by `fall` per cycle, after the integral `area`.
    fn stationary(&self, r: f64, fall: f64, area: f64) -> Option<f64> {
        let excess = self.failure - self.planned;
        let phi = excess * fall * area - self.of_renewal(r) * r;
        let (linear, quadratic) = (fall * self.of_renewal(r), 0.5 * excess * fall * fall);
        let root = (linear * linear - 4.0 * quadratic * phi).sqrt();
        // The stable form of the positive root; no fall, no root.
        (phi < 0.0 && fall > 0.0).then(|| -2.0 * phi / (linear + root))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use statrs::function::erf::erf;
    use std::f64::consts::PI;

    const SCALE: f64 = 1000.0;

    /// R of a Weibull life of shape 2 at equidistant points.
    fn weibull(points: usize, end: f64) -> SurvivalCurve {
        let times: Vec<f64> = (0..=points).map(|k| end * k as f64 / points as f64).collect();
        let values: Vec<f64> = times.iter().map(|t| (-(t / SCALE).powi(2)).exp()).collect();
        SurvivalCurve::new(&times, &values)
    }

    /// Age and cost rate from the equation h(T) D(T) + R(T) = c_f / (c_f - c_p), with D by the error function.
    fn closed_form(costs: &ReplacementCosts) -> (f64, f64) {
        let integral = |t: f64| 0.5 * SCALE * PI.sqrt() * erf(t / SCALE);
        let hazard = |t: f64| 2.0 * t / SCALE.powi(2);
        let left = |t: f64| hazard(t) * integral(t) + (-(t / SCALE).powi(2)).exp();
        let (mut low, mut high) = (0.0, 10.0 * SCALE);
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if left(middle) < costs.failure / (costs.failure - costs.planned) {
                low = middle;
            } else {
                high = middle;
            }
        }
        (low, (costs.failure - costs.planned) * hazard(low))
    }

    #[test]
    fn a_weibull_life_has_its_closed_form() {
        for (failure, points) in [(3.0, 200), (10.0, 200), (100.0, 2000)] {
            let costs = ReplacementCosts { planned: 1.0, failure };
            let curve = weibull(points, 4.0 * SCALE);
            let found = costs.best_age(&curve);
            let (age, rate) = closed_form(&costs);
            assert!((found.cost_rate / rate - 1.0).abs() < 5e-3, "{failure}: {found:?} {rate}");
            // The minimum is flat: a piece of the curve is as near as the age can be.
            assert!(
                (found.age - age).abs() < 0.5 * 4.0 * SCALE / points as f64 + 1e-9,
                "{failure}: {found:?} {age}"
            );
            assert!(!found.at_the_end);
            // Running to failure costs c_f over the mean life, Gamma(3/2) scale.
            let mean = 0.5 * PI.sqrt() * SCALE;
            assert!((costs.of_failures(&curve) * mean / failure - 1.0).abs() < 1e-4);
        }
    }

    #[test]
    fn the_minimum_is_that_of_a_fine_search() {
        let times = [0.0, 100.0, 250.0, 300.0, 700.0];
        let curve = SurvivalCurve::new(&times, &[1.0, 0.97, 0.9, 0.6, 0.1]);
        for failure in [1.5, 4.0, 30.0] {
            let costs = ReplacementCosts { planned: 1.0, failure };
            let search = (1..=70_000).map(|k| costs.rate(&curve, 0.01 * f64::from(k)));
            let least = search.fold(f64::INFINITY, f64::min);
            let found = costs.best_age(&curve);
            assert!(found.cost_rate <= least && found.cost_rate > 0.9999 * least, "{found:?} {least}");
        }
    }

    #[test]
    fn a_constant_hazard_has_no_minimum_before_the_end() {
        let times: Vec<f64> = (0..=500).map(f64::from).collect();
        let values: Vec<f64> = times.iter().map(|t| (-t / 200.0).exp()).collect();
        let costs = ReplacementCosts { planned: 1.0, failure: 5.0 };
        let found = costs.best_age(&SurvivalCurve::new(&times, &values));
        assert!(found.at_the_end && found.age == 500.0, "{found:?}");
    }
}
