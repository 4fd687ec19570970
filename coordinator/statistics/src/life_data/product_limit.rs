//! The estimate of Kaplan and Meier, and the test of Anderson and Darling by it, whether lives with suspensions can come from a Weibull
//! distribution that was fitted to them.
//!
//! With z = 1 - R(t) by the fit and F = 1 - R by the estimate of Kaplan and Meier, a step function, the statistic
//!
//! ```text
//! A^2 = n integral of (F - z)^2 / (z (1 - z)) dz   [1]
//! ```
//!
//! over all z up to that of the last life, or up to 1 if the last unit has failed, is that of complete data where nothing is suspended. Its
//! distribution depends on shape, scale and suspensions: it is simulated. A life of the fit is drawn for every unit, and a life at which it is
//! suspended: its own if it is running, for a failed one a later suspension by the estimate of Kaplan and Meier of these.
//!
//! # Source
//! Kaplan, Meier (1958), Nonparametric estimation from incomplete observations, JASA 53; statistic: Koziol (1980), Goodness-of-fit tests for
//! randomly censored data, Biometrika 67(3); simulation: Davison, Hinkley (1997), Bootstrap Methods and their Application, section 3.5
//! (conditional bootstrap).

use super::{UnitLife, WeibullFit, WeibullLaw};
use crate::goodness_of_fit::{GoodnessOfFit, REPLICATIONS};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// R after each failure (t, R), ascending, one within an interval at its end.
pub fn kaplan_meier(lives: &[UnitLife]) -> Vec<(f64, f64)> {
    let (mut r, ordered) = (1.0, ordered(lives));
    let count = ordered.len();
    let steps = ordered.into_iter().enumerate().filter(|(_, (_, failed))| *failed);
    steps
        .map(|(k, (t, _))| {
            r *= 1.0 - 1.0 / (count - k) as f64;
            (t, r)
        })
        .collect()
}

/// Last lives of the units with whether they failed, ascending; of equal lives failures come first.
fn ordered(lives: &[UnitLife]) -> Vec<(f64, bool)> {
    let mut ordered: Vec<_> = lives.iter().map(|unit| (unit.last(), unit.has_failed())).collect();
    ordered.sort_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
    ordered
}

/// Tests failures and suspensions, to which `law` was fitted.
pub fn censored_anderson_darling(law: &WeibullLaw, data: &[UnitLife]) -> GoodnessOfFit {
    let observed = statistic(law, data);
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    // Data without a fit are drawn again.
    let replications = std::iter::repeat_with(|| {
        let drawn = replicated(law, data, &mut rng);
        WeibullFit::new(&drawn).ok().map(|fit| statistic(&fit.law, &drawn))
    });
    let beyond = replications.flatten().take(REPLICATIONS).filter(|drawn| *drawn >= observed).count();
    GoodnessOfFit { statistic: observed, p: (1 + beyond) as f64 / (REPLICATIONS + 1) as f64 }
}

/// A^2 of the data against a distribution [1].
fn statistic(law: &WeibullLaw, data: &[UnitLife]) -> f64 {
    // z and 1 - z at a life.
    let at = |t: f64| {
        let h = (t / law.scale).powf(law.shape);
        (-(-h).exp_m1(), (-h).exp())
    };
    // Antiderivative of (F - z)^2 / (z (1 - z)) by z.
    let integral = |f: f64, (z, rest): (f64, f64)| {
        let term =
            |factor: f64, p: f64| if factor == 0.0 { 0.0 } else { factor * p.max(f64::MIN_POSITIVE).ln() };
        term(f * f, z) - term((1.0 - f) * (1.0 - f), rest) - z
    };
    let (mut sum, mut f, mut from) = (0.0, 0.0, (0.0, 1.0));
    for (t, r) in kaplan_meier(data) {
        sum += integral(f, at(t)) - integral(f, from);
        (f, from) = (1.0 - r, at(t));
    }
    let last =
        ordered(data).last().map_or((0.0, 1.0), |(t, failed)| if *failed { (1.0, 0.0) } else { at(*t) });
    data.len() as f64 * (sum + integral(f, last) - integral(f, from))
}

/// Data of as many units under a distribution.
fn replicated(law: &WeibullLaw, data: &[UnitLife], rng: &mut impl Rng) -> Vec<UnitLife> {
    let ordered = ordered(data);
    let unit = |k: usize| {
        let (t, failed) = ordered[k];
        let mut later = (k + 1..ordered.len()).filter(|j| !ordered[*j].1);
        let until = if failed {
            later.find(|j| rng.random::<f64>() < 1.0 / (ordered.len() - j) as f64).map(|j| ordered[j].0)
        } else {
            Some(t)
        };
        let life = law.life_at(rng.random_range(f64::MIN_POSITIVE..1.0));
        until.filter(|until| *until < life).map_or(UnitLife::Failed(life), UnitLife::Running)
    };
    (0..ordered.len()).map(unit).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::goodness_of_fit::anderson_darling;
    use common::random::Family;

    /// Lives of a quantile function, suspended at ages that are spread evenly.
    fn fleet(quantile: impl Fn(f64) -> f64, n: usize, rng: &mut impl Rng) -> Vec<UnitLife> {
        let unit = |_| {
            let (life, age) = (quantile(rng.random_range(1e-9..1.0)), rng.random_range(500.0..1500.0));
            if life <= age { UnitLife::Failed(life) } else { UnitLife::Running(age) }
        };
        (0..n).map(unit).collect()
    }

    #[test]
    fn without_suspensions_it_is_the_statistic_of_complete_data() {
        let lives: [f64; 8] = [310.0, 640.0, 1250.0, 150.0, 920.0, 1830.0, 480.0, 770.0];
        let data = lives.map(UnitLife::Failed);
        // Both against the same fit: standard_fit of the family is its own.
        let fit = WeibullFit::new(&data).unwrap().law;
        let mut z = lives.map(|t| 1.0 - fit.reliability(t));
        z.sort_by(f64::total_cmp);
        let term = |i: usize| (2 * i + 1) as f64 * (z[i].ln() + (1.0 - z[7 - i]).ln());
        let exact = -8.0 - (0..8).map(term).sum::<f64>() / 8.0;
        assert!((statistic(&fit, &data) - exact).abs() < 1e-9, "{} {exact}", statistic(&fit, &data));
        let [own, complete] =
            [censored_anderson_darling(&fit, &data).p, anderson_darling(Family::Weibull, &lives).p];
        // Two simulated shares of 999, and two estimates of the parameters.
        assert!((own - complete).abs() < 0.08, "{own} {complete}");
    }

    #[test]
    fn p_is_uniform_under_the_family_with_suspensions_and_another_family_is_rejected() {
        let law = WeibullLaw { shape: 3.0, scale: 1000.0 };
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let test = |data: Vec<UnitLife>| {
            let fit = WeibullFit::new(&data).unwrap();
            censored_anderson_darling(&fit.law, &data).p
        };
        let p: Vec<f64> = (0..60).map(|_| test(fleet(|p| law.life_at(p), 30, &mut rng))).collect();
        let [half, tenth] = [0.5, 0.1].map(|limit| p.iter().filter(|p| **p < limit).count());
        // Binomials of 60: four standard deviations.
        assert!((15..=45).contains(&half) && tenth <= 15, "{half} {tenth}");
        // Half of the units fail early.
        let mixed = |p: f64| if p < 0.5 { 100.0 + 40.0 * p } else { 800.0 + 200.0 * p };
        let rejected = test(fleet(mixed, 60, &mut rng));
        assert!(rejected < 0.01, "{rejected}");
    }
}
