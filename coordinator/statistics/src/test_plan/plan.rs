//! Test plans without prior knowledge.
//!
//! If the reliability over the length of the test is R, the number of failures of n units is binomial. R0 is demonstrated with the
//! confidence C by the least n with
//!
//!   P(at most c failures | R0) = sum over i <= c of (n over i) (1 - R0)^i R0^(n - i) <= 1 - C;
//!
//! without failures n = ln(1 - C) / ln R0, rounded up. A test over x times the life, of lives with a Weibull shape b, sees
//! R0^(x^b) in the place of R0.
//!
//! Groups of k units, each up to its first failure (sudden death): with lives of shape b, T^b k (-ln R0) / t0^b is exponential for a
//! group with the reliability R0 at t0. g groups demonstrate R0 if the sum of (T / t0)^b reaches chi2(C; 2 g) / (2 k (-ln R0)), where
//! chi2 is the quantile for 2 g degrees of freedom.
//!
//! # Source
//! Meeker, Escobar (1998), Statistical Methods for Reliability Data, Wiley, chapter 10; Abernethy (2008), The New Weibull Handbook,
//! chapter 6 (Weibayes, zero-failure plans, sudden death).

use statrs::distribution::{Binomial, ChiSquared, ContinuousCDF, DiscreteCDF};

/// Largest number of units of a plan.
pub const MOST_UNITS: u64 = 10_000_000;

/// Probability of at most `allowed` failures of `units` units with the reliability `r` [1].
pub fn pass_probability(units: u64, allowed: u64, r: f64) -> f64 {
    if allowed >= units {
        return 1.0;
    }
    // Without failures the power has all digits.
    if allowed == 0 {
        return (units as f64 * r.ln()).exp();
    }
    Binomial::new(1.0 - r, units).map_or(1.0, |failures| failures.cdf(allowed))
}

/// Least number of units that demonstrates `r` over the length of the test with this confidence [1]; `None` above [`MOST_UNITS`].
pub fn units(r: f64, allowed: u64, confidence: f64) -> Option<u64> {
    // The last digits of a power must not add a unit.
    let demonstrates = |n: u64| pass_probability(n, allowed, r) <= (1.0 - confidence) * (1.0 + 1e-12);
    least(allowed + 1, demonstrates)
}

/// The least number from `first` on for which `holds`, which then holds for all larger ones; `None` above [`MOST_UNITS`].
pub(super) fn least(first: u64, holds: impl Fn(u64) -> bool) -> Option<u64> {
    let (mut low, mut high) = (first, first);
    while !holds(high) {
        (low, high) = (high + 1, 2 * high + 1);
        if high > MOST_UNITS {
            return None;
        }
    }
    while low < high {
        let middle = low + (high - low) / 2;
        if holds(middle) { high = middle } else { low = middle + 1 }
    }
    Some(low)
}

/// Reliability over `length` times a life, from that at the life and the shape [1].
pub fn reliability_over(r: f64, length: f64, shape: f64) -> f64 {
    r.powf(length.powf(shape))
}

/// Reliability of units that pass with this probability [1].
pub fn reliability_passed(units: u64, allowed: u64, probability: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if pass_probability(units, allowed, middle) < probability { low = middle } else { high = middle }
    }
    high
}

/// Mean length of a test that ends at the first of the inspections after which more than `allowed` units have failed, or at its end,
/// the last of the increasing `lives` [of a life], for units with the reliability `r` at that life and this shape.
pub fn mean_length(units: u64, allowed: u64, r: f64, shape: f64, lives: &[f64]) -> f64 {
    let before = std::iter::once(0.0).chain(lives.iter().copied());
    let piece = |(from, to): (f64, &f64)| {
        (to - from) * pass_probability(units, allowed, reliability_over(r, from, shape))
    };
    before.zip(lives).map(piece).sum()
}

/// Groups of units of which each runs to its first failure, `groups` of `size` units, for a reliability, a confidence and a shape [1]:
/// life at which all groups may have their first failure, in lives t0, the mean of (T / t0)^b to the power of 1 / b, and reliability
/// at t0 of units of which 90 % of the tests are passed [1].
pub fn group_plan(groups: u64, size: u64, r: f64, confidence: f64, shape: f64) -> (f64, f64) {
    let chi2 = |p: f64| ChiSquared::new(2.0 * groups as f64).map_or(f64::NAN, |chi2| chi2.inverse_cdf(p));
    let sum = chi2(confidence) / (-2.0 * size as f64 * r.ln());
    ((sum / groups as f64).powf(1.0 / shape), r.powf(chi2(0.1) / chi2(confidence)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha12Rng;

    /// Units of plans without failures by their closed form, and with failures by a sum of binomial terms.
    #[test]
    fn units_are_exact() {
        for r in [0.5, 0.8, 0.9, 0.95, 0.99, 0.999, 0.9999] {
            for confidence in [0.5, 0.6, 0.9, 0.95, 0.99] {
                let closed = ((1.0_f64 - confidence).ln() / f64::ln(r) - 1e-9).ceil() as u64;
                assert_eq!(units(r, 0, confidence), Some(closed.max(1)), "{r} {confidence}");
            }
        }
        let by_terms = |n: u64, c: u64, r: f64| -> f64 {
            let mut term = r.powi(n as i32);
            let mut sum = term;
            for i in 0..c {
                term *= (n - i) as f64 / (i + 1) as f64 * (1.0 - r) / r;
                sum += term;
            }
            sum
        };
        for (r, c, confidence) in
            [(0.9, 1, 0.9), (0.9, 2, 0.95), (0.99, 1, 0.9), (0.99, 3, 0.9), (0.5, 2, 0.9)]
        {
            let n = units(r, c, confidence).unwrap();
            assert!(by_terms(n, c, r) <= 1.0 - confidence && by_terms(n - 1, c, r) > 1.0 - confidence, "{n}");
        }
        // Tables of success-run tests: 22, 38, 52 units for R = 0.9, C = 0.9.
        assert_eq!([0, 1, 2].map(|c| units(0.9, c, 0.9).unwrap()), [22, 38, 52]);
        assert_eq!(units(1.0 - 1e-12, 0, 0.9), None);
        // 1 - 0.81 is not a number of this machine.
        assert_eq!(units(0.9, 0, 1.0 - 0.9 * 0.9), Some(2));
    }

    #[test]
    fn longer_tests_need_fewer_units() {
        // Twice the life with shape 2 counts as four lives.
        let seen = reliability_over(0.99, 2.0, 2.0);
        assert!((seen - 0.99_f64.powi(4)).abs() < 1e-15);
        assert_eq!(units(seen, 0, 0.9), Some(230_u64.div_ceil(4)));
        assert!((pass_probability(58, 0, reliability_passed(58, 0, 0.9)) - 0.9).abs() < 1e-9);
    }

    /// Units that just miss R0, and a test that is passed at R0 as often as 1 - C.
    #[test]
    fn sudden_death_has_its_risk() {
        let (r, confidence, shape, size, groups) = (0.99_f64, 0.9, 2.5_f64, 5, 4_u32);
        let (length, passes) = group_plan(u64::from(groups), size, r, confidence, shape);
        let needed = f64::from(groups) * length.powf(shape);
        let mut rng = ChaCha12Rng::seed_from_u64(8);
        let mut passed = |r: f64| {
            let scale = (-r.ln()).powf(-1.0 / shape);
            let mut unit = || scale * (-f64::ln(rng.random_range(1e-12..1.0))).powf(1.0 / shape);
            let mut first = || (0..size).map(|_| unit()).fold(f64::INFINITY, f64::min);
            (0..1000).filter(|_| (0..groups).map(|_| first().powf(shape)).sum::<f64>() >= needed).count()
        };
        // Binomial of 1000 with standard errors of 9.5: 100 and 900.
        let (at_r, at_good) = (passed(r), passed(passes));
        assert!((72..=128).contains(&at_r) && (872..=928).contains(&at_good), "{at_r} {at_good}");
    }

    #[test]
    fn inspections_end_bad_tests_early() {
        let lives = [0.25, 0.5, 0.75, 1.0];
        assert!((mean_length(230, 0, 0.99, 2.0, &lives[3..]) - 1.0).abs() < 1e-12);
        let mean = mean_length(230, 0, 0.99, 2.0, &lives);
        // R^n at the beginning of every quarter: 0.1^(x^2).
        let closed: f64 =
            [0.0, 0.25, 0.5, 0.75].iter().map(|x: &f64| 0.25 * 0.99_f64.powf(230.0 * x * x)).sum();
        assert!((mean - closed).abs() < 1e-12 && mean < 0.8, "{mean}");
    }
}
