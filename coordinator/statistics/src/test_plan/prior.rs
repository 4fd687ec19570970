//! Test plans with a prior distribution of the reliability R at a life.
//!
//! The prior is a beta distribution, R ~ Beta(a, b), with a given mean m = a / (a + b) and at least a given 95 % interval: of all those
//! that contain it the one with the largest a + b, and b >= 1: the density does not grow without bound towards R = 1. Where the
//! interval ends at R = 1, as with no failure in a population, b = 1 and a gives the lower limit alone; where it begins at R = 0, a = 1 and b
//! gives the upper limit. a + b is the number of units
//! that the prior is worth.
//!
//! After c failures of n units over x lives, which see R^k with k = x^shape, the density is that of the prior times
//! (1 - R^k)^c R^(k (n - c)). The plan is the least n after which P(R >= R0 | c failures) >= C. Then fewer failures leave a smaller
//! risk, and P(R < R0 | passed) <= 1 - C: the error of the first kind among campaigns whose R follows the prior. At a fixed R < R0 it
//! is larger than that of a plan without prior: the prior takes the place of the missing units.
//!
//! # Source
//! Martz, Waller (1982), Bayesian Reliability Analysis, Wiley, chapter 10.

use super::plan::{least, pass_probability};
use statrs::function::beta::{beta_reg, ln_beta};

/// Points of the sums over ln(R / (1 - R)) on each side of R0.
const POINTS: usize = 1000;
/// Largest a + b.
const LARGEST: f64 = 1e9;

/// A beta distribution of a reliability.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BetaPrior {
    /// Parameter a: units that have survived [1].
    pub survived: f64,
    /// Parameter b: units that have failed [1].
    pub failed: f64,
}

impl BetaPrior {
    /// The prior with this mean and this 95 % interval at least [1], worth at most `most` units.
    pub fn containing(mean: f64, [lower, upper]: [f64; 2], most: f64) -> Self {
        let most = most.min(LARGEST);
        let of_mean = |sum: f64| Self { survived: mean * sum, failed: (1.0 - mean) * sum };
        let contains = |prior: &Self| prior.below(lower) >= 0.025 && prior.below(upper) <= 0.975;
        // From b = 1 on, or a = 1, the wider the smaller a + b.
        let widest = 1.0 / mean.min(1.0 - mean);
        let found = largest((widest, most), |sum| contains(&of_mean(sum))).map(of_mean);
        found.unwrap_or_else(|| {
            // P(R < lower) = lower^a with b = 1, P(R > upper) = (1 - upper)^b with a = 1.
            let units = |bound: f64| 0.025_f64.ln() / bound.clamp(1e-12, 1.0 - 1e-12).ln();
            let other = |bound: f64| units(bound).clamp(0.0, most - 1.0).max(1.0);
            if mean < 0.5 {
                return Self { survived: 1.0, failed: other(1.0 - upper) };
            }
            Self { survived: other(lower), failed: 1.0 }
        })
    }

    /// P(R < r) [1].
    pub fn below(&self, r: f64) -> f64 {
        beta_reg(self.survived, self.failed, r.clamp(0.0, 1.0))
    }

    /// Integrals of a function of R, times the density, below and above r0.
    fn parts(&self, r0: f64, of: impl Fn(f64) -> f64) -> [f64; 2] {
        let (a, b) = (self.survived, self.failed);
        // Beyond these places the density has fallen by more than exp(-40).
        let (middle, width) = ((a / b).ln(), 12.0 / a.min(b).sqrt() + 40.0 / a.min(b));
        let split = (r0 / (1.0 - r0)).ln();
        let (low, high) = ((middle - width).min(split - 1.0), (middle + width).max(split + 1.0));
        let norm = ln_beta(a, b);
        let density = |y: f64| {
            let (ln_r, ln_rest) = (-(-y).exp().ln_1p(), -y.exp().ln_1p());
            (a * ln_r + b * ln_rest - norm).exp() * of(ln_r.exp())
        };
        // Simpson's rule.
        [(low, split), (split, high)].map(|(from, to)| {
            let step = (to - from) / (2 * POINTS) as f64;
            let weight = |i: usize| if i == 0 || i == 2 * POINTS { 1.0 } else { 2.0 + 2.0 * (i % 2) as f64 };
            (0..=2 * POINTS).map(|i| weight(i) * density(from + step * i as f64)).sum::<f64>() * step / 3.0
        })
    }

    /// Least number of units, with `allowed` failures over a test that sees R^`power`, after which R >= `r0` has at least this
    /// confidence [1]; `None` above [`super::MOST_UNITS`].
    pub fn units_for(&self, r0: f64, allowed: u64, confidence: f64, power: f64) -> Option<u64> {
        let demonstrates = |n: u64| {
            let likelihood = |r: f64| {
                let seen = power * r.ln();
                ((n - allowed) as f64 * seen).exp() * (-seen.exp_m1()).powi(allowed as i32)
            };
            let [below, above] = self.parts(r0, likelihood);
            // A product that is too small for a number tells nothing.
            above + below > 0.0 && above >= confidence * (above + below)
        };
        least(allowed, demonstrates)
    }

    /// Probabilities of what may happen to a test of `units` units with `allowed` failures that sees R^`power`, over the prior [1]: that it
    /// is passed, that R < R0 although it was passed, the error of the first kind, and that it is failed although R >= R0, the error
    /// of the second kind.
    pub fn risks(&self, r0: f64, (units, allowed): (u64, u64), power: f64) -> [f64; 3] {
        let [below, above] = self.parts(r0, |r| pass_probability(units, allowed, r.powf(power)));
        let passed = below + above;
        [passed, below / passed, (1.0 - self.below(r0) - above).max(0.0)]
    }
}

/// The largest number between two for which `holds`, from which on it does not hold; `None` if it never does.
fn largest((least, most): (f64, f64), holds: impl Fn(f64) -> bool) -> Option<f64> {
    // A mean of 1 has no widest one.
    if most < least || !holds(least) {
        return None;
    }
    if holds(most) {
        return Some(most);
    }
    let (mut low, mut high) = (least.ln(), most.ln());
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if holds(middle.exp()) { low = middle } else { high = middle }
    }
    Some(low.exp())
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha12Rng;
    use rand_distr::{Beta, Binomial, Distribution};

    #[test]
    fn the_prior_has_the_mean_and_contains_the_interval() {
        let prior = BetaPrior::containing(0.98, [0.96, 0.992], f64::INFINITY);
        assert!((prior.survived / (prior.survived + prior.failed) - 0.98).abs() < 1e-12);
        let tails = [prior.below(0.96), prior.below(0.992)];
        assert!(tails[0] >= 0.025 - 1e-9 && tails[1] <= 0.975 + 1e-9, "{tails:?}");
        assert!((tails[0] - 0.025).abs().min((tails[1] - 0.975).abs()) < 1e-6, "{tails:?}");
        // No failure in a population: the lower limit alone.
        let none = BetaPrior::containing(1.0, [0.999, 1.0], f64::INFINITY);
        assert!((none.below(0.999) - 0.025).abs() < 1e-12 && none.failed == 1.0);
        let all = BetaPrior::containing(1e-4, [0.0, 4.4e-4], f64::INFINITY);
        assert!((all.below(4.4e-4) - 0.975).abs() < 1e-12 && all.survived == 1.0);
        let units = |prior: BetaPrior| prior.survived + prior.failed;
        assert!((units(BetaPrior::containing(0.98, [0.96, 0.992], 60.0)) - 60.0).abs() < 1e-9);
        assert!(units(BetaPrior::containing(0.98, [0.96, 0.992], 30.0)) <= 30.0);
    }

    /// With R^1 the posterior is beta again; a uniform prior needs one unit less than none.
    #[test]
    fn conjugate_cases_are_exact() {
        let uniform = BetaPrior { survived: 1.0, failed: 1.0 };
        assert_eq!(uniform.units_for(0.99, 0, 0.9, 1.0), Some(229));
        let prior = BetaPrior { survived: 98.0, failed: 2.0 };
        for allowed in [0, 1, 2] {
            let n = prior.units_for(0.97, allowed, 0.9, 1.0).unwrap();
            let risk = |n: u64| {
                let (survived, failed) = ((n - allowed) as f64, allowed as f64);
                BetaPrior { survived: 98.0 + survived, failed: 2.0 + failed }.below(0.97)
            };
            assert!(risk(n) <= 0.1 && risk(n - 1) > 0.1, "{allowed}: {n}");
        }
    }

    /// Errors of both kinds in 1000 simulated campaigns whose R follows the prior.
    #[test]
    fn simulated_campaigns_err_as_stated() {
        let (r0, confidence, power) = (0.99, 0.9, 2.0);
        let prior = BetaPrior::containing(0.991, [0.985, 0.997], f64::INFINITY);
        for allowed in [0, 1] {
            let n = prior.units_for(r0, allowed, confidence, power).unwrap();
            let risks @ [probable, wrongly_passed, wrongly_failed] = prior.risks(r0, (n, allowed), power);
            let mut rng = ChaCha12Rng::seed_from_u64(3);
            let law = Beta::new(prior.survived, prior.failed).unwrap();
            let (mut passed, mut wrongly, mut missed, mut bad) = (0, 0, 0, 0);
            for _ in 0..1000 {
                let r: f64 = law.sample(&mut rng);
                let failures = Binomial::new(n, 1.0 - r.powf(power)).unwrap().sample(&mut rng);
                let passes = failures <= allowed;
                passed += i32::from(passes);
                wrongly += i32::from(passes && r < r0);
                missed += i32::from(!passes && r >= r0);
                bad += i32::from(r < r0);
            }
            // Of the populations with R < R0 at most 1 - C pass; of those that pass the stated share is one of them.
            assert!(f64::from(wrongly) <= (1.0 - confidence) * f64::from(bad), "{wrongly} of {bad}");
            assert!(wrongly_passed <= 1.0 - confidence, "{risks:?}");
            let share = f64::from(wrongly) / f64::from(passed);
            // Four standard errors of shares of 1000, and of those that passed.
            let near = |found: f64, stated: f64, of: f64| {
                (found - stated).abs() < 4.0 * (stated * (1.0 - stated) / of).sqrt()
            };
            assert!(near(share, wrongly_passed, f64::from(passed)), "{share} {risks:?}");
            assert!(near(f64::from(passed) / 1000.0, probable, 1000.0), "{passed} {risks:?}");
            assert!(near(f64::from(missed) / 1000.0, wrongly_failed, 1000.0), "{missed} {risks:?}");
        }
    }
}
