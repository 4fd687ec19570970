//! The Weibull distribution of two parameters by maximum likelihood, from failures, suspensions and intervals.
//!
//! With R(t) = exp(-H), H = (t / eta)^beta, u = ln eta and v = ln beta, the logarithm of the likelihood is the sum of
//!
//! ```text
//! failed at t      v + beta (ln t - u) - ln t - H(t)
//! running at t     -H(t)
//! within (a, b]    ln(exp(-H(a)) - exp(-H(b)))
//! ```
//!
//! Its maximum is found by damped Newton steps in (u, v). FitBounds of a quantity x at the two-sided confidence C:
//!
//! - Fisher: ln x -+ z sd(ln x), where z is the quantile of (1 + C) / 2 and sd follows from the inverse of the matrix of second
//!   derivatives. For the life t at R, ln t = u + ln(-ln R) / beta;
//! - likelihood ratio: all x with 2 (L_max - L(x)) <= z^2, where L(x) is the largest value with this x. With few failures these are the
//!   better ones.
//!
//! # Source
//! IEC 61649:2008, Weibull analysis; Lawless (2003), Statistical Models and Methods for Lifetime Data, Wiley, chapter 5; Meeker,
//! Escobar (1998), Statistical Methods for Reliability Data, Wiley, chapter 8.

use super::UnitLife;
use statrs::distribution::{ContinuousCDF, Normal};
use thiserror::Error;

/// Largest and smallest shape of a fit [1]: beyond, the maximum lies at the end of the parameters' range.
const SHAPES: (f64, f64) = (0.02, 2000.0);
/// Relative change of both parameters at which the steps end [1].
const CONVERGED: f64 = 1e-11;
/// Step of the differences of the gradient [1]; truncation and rounding are both about 1e-10.
const STEP: f64 = 1e-5;
/// FitBounds beyond this number of standard deviations of a Fisher bound count as absent.
const FARTHEST: f64 = 64.0;

/// The likelihood of these data has no maximum.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error(
    "no Weibull distribution has the largest likelihood with the {failed} failed units at these lives; allowed: failures at different lives, or \
     one and a unit that has run longer"
)]
pub struct NoMaximum {
    /// Number of failures.
    pub failed: usize,
}

/// A Weibull distribution of lives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WeibullLaw {
    /// Shape beta [1].
    pub shape: f64,
    /// Scale eta: the life that exp(-1) = 36.8 % of the units reach [cycles].
    pub scale: f64,
}

impl WeibullLaw {
    /// Reliability at a life [1].
    pub fn reliability(&self, life: f64) -> f64 {
        (-(life / self.scale).powf(self.shape)).exp()
    }

    /// Life at which the reliability has fallen to `r` [cycles].
    pub fn life_at(&self, r: f64) -> f64 {
        self.scale * (-r.ln()).powf(1.0 / self.shape)
    }

    /// Parameters (u, v).
    fn place(&self) -> [f64; 2] {
        [self.scale.ln(), self.shape.ln()]
    }

    fn at([u, v]: [f64; 2]) -> Self {
        Self { shape: v.exp(), scale: u.exp() }
    }

    /// Logarithm of the likelihood of the data.
    pub fn ln_likelihood(&self, data: &[UnitLife]) -> f64 {
        ln_likelihood(self.place(), data).0
    }
}

/// A quantity of a fit with its bounds; a bound that does not exist is `None`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FitBounds {
    /// Value at the maximum of the likelihood.
    pub value: f64,
    /// Lower and upper Fisher bounds.
    pub fisher: [f64; 2],
    /// Lower and upper likelihood-ratio bounds.
    pub likelihood_ratio: [Option<f64>; 2],
}

/// The distribution of largest likelihood.
#[derive(Debug, Clone, PartialEq)]
pub struct WeibullFit {
    /// The distribution found.
    pub law: WeibullLaw,
    /// Logarithm of its likelihood.
    pub ln_likelihood: f64,
    /// Covariance of (u, v) by the second derivatives `(2, 2)`.
    covariance: [[f64; 2]; 2],
    data: Vec<UnitLife>,
}

/// Logarithm of the likelihood at (u, v) and its gradient.
fn ln_likelihood([u, v]: [f64; 2], data: &[UnitLife]) -> (f64, [f64; 2]) {
    let shape = v.exp();
    // H and its derivatives by u and v.
    let hazard = |t: f64| {
        let z = shape * (t.ln() - u);
        let h = z.exp();
        if t > 0.0 { (z, h, [-shape * h, z * h]) } else { (0.0, 0.0, [0.0; 2]) }
    };
    let (mut sum, mut gradient) = (0.0, [0.0; 2]);
    for unit in data {
        let (value, slope) = match *unit {
            UnitLife::Failed(t) => {
                let (z, h, by) = hazard(t);
                (v + z - t.ln() - h, [-shape - by[0], 1.0 + z - by[1]])
            }
            UnitLife::Running(t) => {
                let (_, h, by) = hazard(t);
                (-h, by.map(|d| -d))
            }
            UnitLife::Interval(from, to) => {
                let ((_, a, by_a), (_, b, by_b)) = (hazard(from), hazard(to));
                let share = 1.0 / (b - a).exp_m1();
                let along = |k: usize| (by_b[k] - by_a[k]) * share - by_a[k];
                (-a + (-(a - b).exp_m1()).ln(), [along(0), along(1)])
            }
        };
        sum += value;
        gradient = [gradient[0] + slope[0], gradient[1] + slope[1]];
    }
    (sum, gradient)
}

/// Second derivatives of the logarithm of the likelihood, by differences of its gradient: uu, uv, vv.
fn curvature(at: [f64; 2], data: &[UnitLife]) -> [f64; 3] {
    let by = |k: usize| {
        let beside = |step: f64| {
            let mut place = at;
            place[k] += step;
            ln_likelihood(place, data).1
        };
        let (above, below) = (beside(STEP), beside(-STEP));
        [0, 1].map(|i| (above[i] - below[i]) / (2.0 * STEP))
    };
    let (by_u, by_v) = (by(0), by(1));
    [by_u[0], 0.5 * (by_u[1] + by_v[0]), by_v[1]]
}

/// Quantile of (1 + C) / 2 of the standard normal distribution [1].
fn reach(confidence: f64) -> f64 {
    Normal::standard().inverse_cdf(0.5 * (1.0 + confidence))
}

impl WeibullFit {
    /// The fit to data with lives above 0.
    ///
    /// # Errors
    /// [`NoMaximum`] without failures, or if one life lies within all intervals, equals all failures, and no suspension is later.
    pub fn new(data: &[UnitLife]) -> Result<Self, NoMaximum> {
        let failed = data.iter().filter(|unit| unit.has_failed()).count();
        let (mut first, mut last) = (0.0_f64, f64::INFINITY);
        for unit in data {
            let (from, to) = match *unit {
                UnitLife::Failed(t) => (t, t),
                UnitLife::Running(t) => (t, f64::INFINITY),
                UnitLife::Interval(from, to) => (from, to),
            };
            (first, last) = (first.max(from), last.min(to));
        }
        if failed == 0 || first <= last {
            return Err(NoMaximum { failed });
        }
        // Lives are measured in their geometric mean, so that u begins at 0.
        let ln_lives = data.iter().map(|unit| unit.last().ln());
        let mut place = [ln_lives.sum::<f64>() / data.len() as f64, 0.0];
        let (mut value, mut gradient) = ln_likelihood(place, data);
        let mut damping = 1e-3 * data.len() as f64;
        for _ in 0..500 {
            let [uu, uv, vv] = curvature(place, data);
            let (a, d, [by_u, by_v]) = (damping - uu, damping - vv, gradient);
            let determinant = a * d - uv * uv;
            let step = [(d * by_u + uv * by_v) / determinant, (uv * by_u + a * by_v) / determinant];
            let next = [place[0] + step[0], place[1] + step[1]];
            let found = ln_likelihood(next, data);
            let is_better = a > 0.0 && determinant > 0.0 && found.0 >= value && step[1].abs() < 2.0;
            if !is_better {
                // Rounding hides any further rise.
                if damping > 1e12 {
                    break;
                }
                damping = damping.max(1e-9) * 10.0;
                continue;
            }
            (place, (value, gradient)) = (next, found);
            damping *= 0.1;
            if step[0].abs().max(step[1].abs()) < CONVERGED {
                break;
            }
        }
        let law = WeibullLaw::at(place);
        let [uu, uv, vv] = curvature(place, data);
        let determinant = uu * vv - uv * uv;
        if !(SHAPES.0..SHAPES.1).contains(&law.shape) || uu.is_nan() || uu >= 0.0 || determinant <= 0.0 {
            return Err(NoMaximum { failed });
        }
        let covariance = [[-vv, uv], [uv, -uu]].map(|row| row.map(|x| x / determinant));
        Ok(Self { law, ln_likelihood: value, covariance, data: data.to_vec() })
    }

    /// The shape with its bounds [1].
    pub fn shape(&self, confidence: f64) -> FitBounds {
        self.bounds([0.0, 1.0], confidence, |v, u| [u, v])
    }

    /// The life at which the reliability has fallen to `r` [cycles]; that of exp(-1) is the scale.
    pub fn life(&self, r: f64, confidence: f64) -> FitBounds {
        let w = (-r.ln()).ln();
        self.bounds([1.0, -w / self.law.shape], confidence, |x, v| [x - w * (-v).exp(), v])
    }

    /// Fisher bounds of R at a life [1]: those of ln(-ln R).
    pub fn reliability(&self, life: f64, confidence: f64) -> [f64; 2] {
        let z = self.law.shape * (life / self.law.scale).ln();
        let half = reach(confidence) * self.deviation([-self.law.shape, z]);
        [half, -half].map(|half| (-(z + half).exp()).exp())
    }

    /// Standard deviation of a quantity with this gradient by (u, v).
    fn deviation(&self, slope: [f64; 2]) -> f64 {
        let row = |k: usize| self.covariance[k][0] * slope[0] + self.covariance[k][1] * slope[1];
        (slope[0] * row(0) + slope[1] * row(1)).max(0.0).sqrt()
    }

    /// FitBounds of exp(x) for a quantity x with the gradient `slope` by (u, v); `place` is (u, v) for x and the other parameter,
    /// which is u if x does not depend on it, else v.
    fn bounds(&self, slope: [f64; 2], confidence: f64, place: impl Fn(f64, f64) -> [f64; 2]) -> FitBounds {
        let [u, v] = self.law.place();
        let w = if slope[0] > 0.0 { -slope[1] * self.law.shape } else { 0.0 };
        let (best, other) = if slope[0] > 0.0 { (u + w * (-v).exp(), v) } else { (v, u) };
        let (deviation, z) = (self.deviation(slope), reach(confidence));
        let profile = |x: f64| highest(other, |y| ln_likelihood(place(x, y), &self.data).0);
        let is_within = |x: f64| 2.0 * (self.ln_likelihood - profile(x)) <= z * z;
        let limit = |sign: f64| {
            let at = |k: f64| best + sign * k * deviation;
            let mut outside = z;
            while is_within(at(outside)) {
                outside *= 2.0;
                if outside > FARTHEST {
                    return None;
                }
            }
            let mut inside = if outside > z { 0.5 * outside } else { 0.0 };
            for _ in 0..40 {
                let middle = 0.5 * (inside + outside);
                if is_within(at(middle)) { inside = middle } else { outside = middle }
            }
            Some(at(inside).exp())
        };
        FitBounds {
            value: best.exp(),
            fisher: [-z, z].map(|z| (best + z * deviation).exp()),
            likelihood_ratio: [limit(-1.0), limit(1.0)],
        }
    }
}

/// Largest value of a function with one maximum, sought from `start`.
fn highest(start: f64, of: impl Fn(f64) -> f64) -> f64 {
    // Downhill on both sides.
    let (mut low, mut middle, mut high) = (start - 0.25, start, start + 0.25);
    let (mut f_low, mut f_middle, mut f_high) = (of(low), of(middle), of(high));
    for _ in 0..60 {
        if f_low > f_middle {
            (high, f_high, middle, f_middle) = (middle, f_middle, low, f_low);
            low = middle - 1.6 * (high - middle);
            f_low = of(low);
        } else if f_high > f_middle {
            (low, f_low, middle, f_middle) = (middle, f_middle, high, f_high);
            high = middle + 1.6 * (middle - low);
            f_high = of(high);
        } else {
            break;
        }
    }
    // Golden section.
    let golden = 0.5 * (3.0 - 5.0_f64.sqrt());
    let (mut a, mut b) = (low + golden * (high - low), high - golden * (high - low));
    let (mut f_a, mut f_b) = (of(a), of(b));
    while high - low > 1e-8 {
        if f_a >= f_b {
            (high, b, f_b) = (b, a, f_a);
            a = low + golden * (high - low);
            f_a = of(a);
        } else {
            (low, a, f_a) = (a, b, f_b);
            b = high - golden * (high - low);
            f_b = of(b);
        }
    }
    f_a.max(f_b)
}

#[cfg(test)]
#[path = "weibull_tests.rs"]
mod tests;
