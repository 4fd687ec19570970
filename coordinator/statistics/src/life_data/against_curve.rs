//! Data of a population against a curve of reliability that was computed without them.
//!
//! A failure at t has the density -dR/dt, taken as the mean over t (1 -+ 1 %); a suspension R(t); an interval R(a) - R(b). Where the
//! population of the curve shows no unit, half a unit of it counts.
//!
//! If the curve holds, Lambda = -ln R(t) of the lives is exponential with mean 1, suspensions and intervals alike (residuals of Cox and
//! Snell). The test fits a Weibull distribution to them; twice the logarithm of its likelihood over that of shape and scale 1 has for
//! many failures the chi-square distribution of two degrees of freedom: p = exp(-x / 2).
//!
//! # Source
//! Cox, Snell (1968), A general definition of residuals, Journal of the Royal Statistical Society B 30; Lawless (2003), Statistical
//! Models and Methods for Lifetime Data, Wiley, section 6.2.

use super::{NoMaximum, UnitLife, WeibullFit, WeibullLaw};
use crate::replacement::{CurveBand, SurvivalCurve};
use statrs::distribution::{ContinuousCDF, Normal};

/// Half of the width over which a density is taken, as a share of the life [1].
const WINDOW: f64 = 0.01;

/// Logarithm of the likelihood of the data under a curve that was counted over `points` samples.
pub fn ln_likelihood(curve: &SurvivalCurve, points: usize, data: &[UnitLife]) -> f64 {
    let least = least(points);
    let of = |unit: &UnitLife| match *unit {
        UnitLife::Failed(t) => {
            let (from, to) = (t * (1.0 - WINDOW), (t * (1.0 + WINDOW)).min(curve.end()));
            ((curve.at(from) - curve.at(to)).max(least) / (to - from)).ln()
        }
        UnitLife::Running(t) => curve.at(t).max(least).ln(),
        UnitLife::Interval(from, to) => (curve.at(from) - curve.at(to)).max(least).ln(),
    };
    data.iter().map(of).sum()
}

/// Half a unit of a population as a share [1].
fn least(points: usize) -> f64 {
    0.5 / points.max(1) as f64
}

/// Logarithm of the evidence of a curve: of the mean likelihood over the curves that its errors allow.
pub fn evidence_of_curve(band: &CurveBand, points: usize, data: &[UnitLife]) -> f64 {
    let all: Vec<f64> = band.curves().map(|curve| ln_likelihood(curve, points, data)).collect();
    let largest = all.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    largest + (all.iter().map(|ln| (ln - largest).exp()).sum::<f64>() / all.len() as f64).ln()
}

/// Tests a curve by data with failures: the probability of data that agree no better with it [1], and the failures that it expects until
/// the units' lives, the sum of Lambda. Where the data determine no shape, their number alone is tested against the expected one.
pub fn test_of_curve(curve: &SurvivalCurve, points: usize, data: &[UnitLife]) -> (f64, f64) {
    let least = least(points);
    let residual = |t: f64| (-curve.at(t).max(least).ln()).max(least);
    // A unit on an inspected life of 0 has none.
    let mapped: Vec<UnitLife> =
        data.iter().map(|unit| unit.mapped(|t| if t > 0.0 { residual(t) } else { 0.0 })).map(apart).collect();
    let lives = mapped.iter().map(|unit| match *unit {
        UnitLife::Failed(t) | UnitLife::Running(t) => t,
        UnitLife::Interval(from, to) => 0.5 * (from + to),
    });
    let expected: f64 = lives.sum();
    let exponential = |scale: f64| WeibullLaw { shape: 1.0, scale }.ln_likelihood(&mapped);
    let p = match WeibullFit::new(&mapped) {
        Ok(fit) => (exponential(1.0) - fit.ln_likelihood).min(0.0).exp(),
        Err(NoMaximum { failed }) => {
            let ratio = 2.0 * (exponential(expected / failed.max(1) as f64) - exponential(1.0));
            2.0 * Normal::standard().sf(ratio.max(0.0).sqrt())
        }
    };
    (p, expected)
}

/// An interval over which the curve does not fall is one of least width.
fn apart(unit: UnitLife) -> UnitLife {
    match unit {
        UnitLife::Interval(from, to) if to <= from * (1.0 + 1e-9) => UnitLife::Failed(to),
        unit => unit,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha12Rng;

    fn curve(law: &WeibullLaw) -> SurvivalCurve {
        let times: Vec<f64> = (0..=4000).map(f64::from).collect();
        SurvivalCurve::new(&times, &times.iter().map(|t| law.reliability(*t)).collect::<Vec<_>>())
    }

    /// Units of a fleet with staggered ages, every second one inspected every 100 cycles only.
    fn fleet(law: &WeibullLaw, units: usize, rng: &mut ChaCha12Rng) -> Vec<UnitLife> {
        let unit = |k: usize| {
            let life = law.life_at(rng.random_range(1e-9..1.0));
            let age: f64 = rng.random_range(700.0..1400.0);
            let inspected = (life / 100.0).floor() * 100.0;
            match () {
                () if life > age => UnitLife::Running(age),
                () if k.is_multiple_of(2) => UnitLife::Failed(life),
                () => UnitLife::Interval(inspected, inspected + 100.0),
            }
        };
        (0..units).map(unit).collect()
    }

    #[test]
    fn a_true_curve_is_contradicted_as_rarely_as_stated_and_a_wrong_one_is() {
        let truth = WeibullLaw { shape: 4.0, scale: 1000.0 };
        let (right, wrong) = (curve(&truth), curve(&WeibullLaw { scale: 1400.0, ..truth }));
        let mut rng = ChaCha12Rng::seed_from_u64(11);
        let total = 300;
        let mut contradicted = [0; 2];
        for _ in 0..total {
            let data = fleet(&truth, 30, &mut rng);
            for (count, curve) in contradicted.iter_mut().zip([&right, &wrong]) {
                *count += usize::from(test_of_curve(curve, 1_000_000, &data).0 < 0.05);
            }
        }
        // 5 % of 300 are 15, with a standard error of 3.8.
        assert!((4..=30).contains(&contradicted[0]) && contradicted[1] > 290, "{contradicted:?}");
    }

    #[test]
    fn the_likelihood_is_that_of_the_law_behind_the_curve() {
        let law = WeibullLaw { shape: 4.0, scale: 1000.0 };
        let data = fleet(&law, 40, &mut ChaCha12Rng::seed_from_u64(2));
        let exact = law.ln_likelihood(&data);
        let found = ln_likelihood(&curve(&law), 1_000_000, &data);
        // Second differences over a window of 1 % of the life: (0.01 shape)^2 / 6 per failure.
        assert!((found - exact).abs() < 40.0 * 0.0016 / 6.0, "{found} {exact}");
        // All errors gone, the evidence is the likelihood.
        let times: Vec<f64> = (0..=4000).map(f64::from).collect();
        let values: Vec<f64> = times.iter().map(|t| law.reliability(*t)).collect();
        let band =
            CurveBand::new(&times, &values, [&values, &values], 1000, &mut ChaCha12Rng::seed_from_u64(1));
        assert!((evidence_of_curve(&band, 1_000_000, &data) - found).abs() < 1e-9);
    }

    #[test]
    fn units_beyond_what_the_curve_shows_are_rare_not_impossible() {
        let step = SurvivalCurve::new(&[0.0, 500.0, 600.0], &[1.0, 1.0, 0.0]);
        let data = [UnitLife::Failed(100.0), UnitLife::Running(600.0)];
        let found = ln_likelihood(&step, 1000, &data);
        assert!((found - (0.0005 / 2.0_f64).ln() - 0.0005_f64.ln()).abs() < 1e-12, "{found}");
        let early = [UnitLife::Failed(100.0); 3];
        assert!(test_of_curve(&step, 1000, &early).0 < 1e-6);
    }
}
