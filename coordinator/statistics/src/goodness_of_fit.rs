//! The test of Anderson and Darling: whether measured values can come from a family that was fitted to them.
//!
//! With the values ordered, z_1 <= ... <= z_n in the standard form of the family, the statistic
//!
//! ```text
//! A^2 = -n - 1/n sum_i (2 i - 1) (ln F(z_i) + ln(1 - F(z_(n + 1 - i))))   [1]
//! ```
//!
//! is large if the values lie elsewhere, above all in the tails. Since location and scale are estimated from the same values, its
//! distribution is not that of tables for known parameters: it is simulated, with samples of the family that are fitted anew each. It does not
//! depend on location and scale, so that standard samples serve every fit.
//!
//! # Source
//! Anderson, Darling (1954), A test of goodness of fit, JASA 49, 765-769; Stute, Gonzalez Manteiga, Presedo Quindimil (1993), Bootstrap based
//! goodness-of-fit tests, Metrika 40, 243-256.

use common::random::{Family, Tail};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Samples by which the distribution of the statistic is simulated: p to one part in a thousand.
pub const REPLICATIONS: usize = 999;

/// Largest number of values in these samples: the distribution of the statistic hardly changes beyond.
const LARGEST: usize = 400;

/// Result of the test for one family.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GoodnessOfFit {
    /// Statistic A^2 of the test [1].
    pub statistic: f64,
    /// Share of samples of the family that fit no better [1].
    pub p: f64,
}

/// Tests measured values `(n,)`, to which the family can be fitted.
pub fn anderson_darling(family: Family, samples: &[f64]) -> GoodnessOfFit {
    let statistic = fitted_statistic(family, family.transformed(samples));
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let n = samples.len().min(LARGEST);
    let replication = || {
        let uniforms = (0..n).map(|_| rng.random_range(f64::MIN_POSITIVE..1.0));
        fitted_statistic(family, uniforms.map(|p| family.standard().at(p, Tail::Lower)).collect())
    };
    let beyond = std::iter::repeat_with(replication).take(REPLICATIONS).filter(|drawn| *drawn >= statistic);
    GoodnessOfFit { statistic, p: (1 + beyond.count()) as f64 / (REPLICATIONS + 1) as f64 }
}

/// A^2 of values in the form of the family `(n,)` against its fit to them [1].
fn fitted_statistic(family: Family, mut y: Vec<f64>) -> f64 {
    let (location, scale) = family.standard_fit(&y);
    y.sort_by(f64::total_cmp);
    let n = y.len();
    let z = |i: usize| (y[i] - location) / scale;
    // A probability of zero has no logarithm; the smallest number stands for it.
    let log = |p: f64| p.max(f64::MIN_POSITIVE).ln();
    let term = |i: usize| {
        let probability = |i: usize, tail: Tail| family.standard().probability(z(i), tail);
        (2 * i + 1) as f64 * (log(probability(i, Tail::Lower)) + log(probability(n - 1 - i, Tail::Upper)))
    };
    -(n as f64) - (0..n).map(term).sum::<f64>() / n as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::random::{Distribution, Extreme};

    fn drawn(law: &Distribution, n: usize, seed: u64) -> Vec<f64> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        (0..n).map(|_| law.quantile(rng.random_range(1e-12..1.0))).collect()
    }

    /// Stephens (1974, 1986): with estimated parameters, 5 % of normal samples have A^2 (1 + 0.75/n + 2.25/n^2) > 0.752, 5 % of
    /// Gumbel samples A^2 (1 + 0.2/sqrt(n)) > 0.757, 5 % of exponential ones A^2 (1 + 0.6/n) > 1.321.
    #[test]
    fn published_critical_values() {
        let n = 50.0_f64;
        for (family, critical) in [
            (Family::Normal, 0.752 / (1.0 + 0.75 / n + 2.25 / (n * n))),
            (Family::Gumbel(Extreme::Maxima), 0.757 / (1.0 + 0.2 / n.sqrt())),
            (Family::Exponential, 1.321 / (1.0 + 0.6 / n)),
        ] {
            let mut rng = ChaCha8Rng::seed_from_u64(7);
            let total = 4000;
            let beyond = (0..total).filter(|_| {
                let y = (0..50)
                    .map(|_| family.standard().at(rng.random_range(1e-300..1.0), Tail::Lower))
                    .collect();
                fitted_statistic(family, y) > critical
            });
            let share = beyond.count() as f64 / f64::from(total);
            // Three standard errors of a share of 5 %.
            assert!(
                (share - 0.05).abs() < 3.0 * (0.05 * 0.95 / f64::from(total)).sqrt(),
                "{family:?}: {share}"
            );
        }
    }

    #[test]
    fn the_right_family_passes_and_another_one_does_not() {
        let law = Distribution::lognormal(20.0, 12.0).unwrap();
        let samples = drawn(&law, 200, 3);
        let right = anderson_darling(Family::Lognormal, &samples);
        let wrong = anderson_darling(Family::Normal, &samples);
        assert!(right.p > 0.05 && wrong.p < 0.01, "{right:?} {wrong:?}");
        assert!(right.statistic < wrong.statistic);
    }

    /// Samples of the family itself have every p equally often.
    #[test]
    fn p_is_uniform_under_the_family() {
        let law = Distribution::weibull(300.0, 90.0).unwrap();
        let small = (0..60).filter(|seed| anderson_darling(Family::Weibull, &drawn(&law, 30, *seed)).p < 0.5);
        // A binomial of 60 at one half: four standard deviations.
        let count = small.count();
        assert!((15..=45).contains(&count), "{count}");
    }
}
