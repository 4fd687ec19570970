//! Intervals of what follows from a curve of reliability, from the 95 % limits of the curve.
//!
//! The limits hold point by point, and the errors of neighbouring points are alike. How much alike decides how a cost rate, a
//! mean life or a hazard errs, so both ends are taken:
//!
//! - the errors have the correlation of an empirical distribution function, that of counting failures F = 1 - R among
//!   independent samples,
//!
//!     corr(s, t) = sqrt(F(s) (1 - F(t)) / (F(t) (1 - F(s)))) for s < t,
//!
//!   which is that of an Ornstein-Uhlenbeck process over ln(F / (1 - F)) / 2. With z(t) from it, a realisation is R + z / 1.96
//!   times the distance to the upper limit for z > 0, to the lower one for z < 0; an interval of a result goes from its 2.5 %
//!   to its 97.5 % quantile over the realisations;
//! - all errors are the same, as those of a surrogate or of the numerical error may be: the curve is one of its two limits.
//!
//! The interval stated is the smallest that contains both.
//!
//! # Source
//! Correlation of the empirical distribution function (Brownian bridge): Shorack, Wellner (1986), Empirical Processes with
//! Applications to Statistics, Wiley, chapter 3. The union of both is this project's own convention.

use super::SurvivalCurve;
use crate::reliability::REACH;
use common::random::standard_normal_quantile;
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};

/// Number of realisations: the quantiles of an interval are known to a tenth of a standard deviation.
const REALISATIONS: usize = 600;
/// Probabilities of the limits of an interval [1].
const LIMITS: (f64, f64) = (0.025, 0.975);

/// Curves that may be the true one, within the limits of an estimated curve.
#[derive(Debug, Clone)]
pub struct CurveBand {
    /// The estimate of the curve.
    pub best: SurvivalCurve,
    /// Realisations with errors correlated as those of counting.
    realisations: Vec<SurvivalCurve>,
    /// The limits as curves.
    limits: [SurvivalCurve; 2],
}

impl CurveBand {
    /// Curves within the 95 % limits `lower` and `upper` `(g,)` [1] of R `(g,)` [1] at increasing times `(g,)` [cycles],
    /// counted over `points` samples.
    pub fn new(
        times: &[f64],
        reliability: &[f64],
        [lower, upper]: [&[f64]; 2],
        points: usize,
        rng: &mut impl Rng,
    ) -> Self {
        let least = 0.5 / points.max(1) as f64;
        let place = |r: f64| {
            let failed = (1.0 - r).clamp(least, 1.0 - least);
            0.5 * (failed / (1.0 - failed)).ln()
        };
        let mut normal = || -> f64 { StandardNormal.sample(rng) };
        let mut realise = || {
            let (mut z, mut before) = (normal(), place(reliability[0]));
            let along = reliability.iter().zip(lower.iter().zip(upper)).map(|(r, (lower, upper))| {
                let now = place(*r);
                let correlation = (before - now).min(0.0).exp();
                z = correlation * z + (1.0 - correlation * correlation).sqrt() * normal();
                before = now;
                r + z / REACH * if z > 0.0 { upper - r } else { r - lower }
            });
            let values: Vec<f64> = along.collect();
            SurvivalCurve::new(times, &values)
        };
        Self {
            realisations: (0..REALISATIONS).map(|_| realise()).collect(),
            best: SurvivalCurve::new(times, reliability),
            limits: [SurvivalCurve::new(times, lower), SurvivalCurve::new(times, upper)],
        }
    }

    /// The 95 % interval of a number that follows from the curve; curves without that number are left out.
    pub fn interval(&self, of: impl Fn(&SurvivalCurve) -> Option<f64>) -> Option<[f64; 2]> {
        let mut found: Vec<f64> = self.realisations.iter().filter_map(&of).collect();
        found.sort_unstable_by(f64::total_cmp);
        let last = found.len().checked_sub(1)?;
        let quantile = |p: f64| found[(p * last as f64).round() as usize];
        let (mut lower, mut upper) = (quantile(LIMITS.0), quantile(LIMITS.1));
        for value in self.limits.iter().chain([&self.best]).filter_map(&of) {
            (lower, upper) = (lower.min(value), upper.max(value));
        }
        Some([lower, upper])
    }

    /// The best estimate, the limits and the realisations.
    pub fn curves(&self) -> impl Iterator<Item = &SurvivalCurve> {
        std::iter::once(&self.best).chain(&self.limits).chain(&self.realisations)
    }

    /// Time until which R is at least `level` [1] with a confidence [1], one-sided, up to the end of the curve [cycles].
    pub fn surely_until(&self, level: f64, confidence: f64) -> f64 {
        let until = |curve: &SurvivalCurve| curve.life_at(level).unwrap_or(curve.end());
        let mut found: Vec<f64> = self.realisations.iter().map(until).collect();
        found.sort_unstable_by(f64::total_cmp);
        let by_counting = found[((1.0 - confidence) * (found.len() - 1) as f64).floor() as usize];
        let (best, [lower, upper]) = (until(&self.best), [&self.limits[0], &self.limits[1]].map(until));
        let reach = standard_normal_quantile(confidence) / REACH;
        let by_common_errors = best - reach * if reach > 0.0 { best - lower } else { upper - best };
        by_counting.min(by_common_errors).max(0.0)
    }

    /// Share of the realisations with a property [1].
    pub fn share(&self, has: impl Fn(&SurvivalCurve) -> bool) -> f64 {
        self.realisations.iter().filter(|curve| has(curve)).count() as f64 / REALISATIONS as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::replacement::ReplacementCosts;
    use rand_chacha::ChaCha12Rng;
    use rand_chacha::rand_core::SeedableRng;

    const POINTS: usize = 1000;

    fn weibull(t: f64) -> f64 {
        (-(t / 1000.0).powf(3.0)).exp()
    }

    /// A curve counted over Weibull lives, with its binomial limits.
    fn counted(rng: &mut ChaCha12Rng) -> CurveBand {
        let law = rand_distr::Weibull::new(1000.0, 3.0).unwrap();
        let lives: Vec<f64> = (0..POINTS).map(|_| law.sample(rng)).collect();
        let times: Vec<f64> = (0..=100).map(|k| 20.0 * f64::from(k)).collect();
        let r: Vec<f64> =
            times.iter().map(|t| lives.iter().filter(|l| *l > t).count() as f64 / POINTS as f64).collect();
        let half = |r: &f64| {
            let failed = (POINTS as f64 * (1.0 - r) + 1.0) / (POINTS as f64 + 2.0);
            REACH * (failed * (1.0 - failed) / POINTS as f64).sqrt()
        };
        let lower: Vec<f64> = r.iter().map(|r| (r - half(r)).max(0.0)).collect();
        let upper: Vec<f64> = r.iter().map(|r| (r + half(r)).min(1.0)).collect();
        CurveBand::new(&times, &r, [&lower, &upper], POINTS, rng)
    }

    #[test]
    fn intervals_contain_the_truth_as_often_as_they_say() {
        let times: Vec<f64> = (0..=2000).map(f64::from).collect();
        let exact = SurvivalCurve::new(&times, &times.iter().map(|t| weibull(*t)).collect::<Vec<_>>());
        let costs = ReplacementCosts { planned: 1.0, failure: 10.0 };
        let quantities: [&dyn Fn(&SurvivalCurve) -> f64; 3] =
            [&|curve| curve.restricted_mean(), &|curve| costs.best_age(curve).cost_rate, &|curve| {
                curve.rate(700.0, 900.0).0
            }];
        let mut rng = ChaCha12Rng::seed_from_u64(5);
        let mut held = [0; 3];
        let studies = 60;
        for _ in 0..studies {
            let band = counted(&mut rng);
            for (held, of) in held.iter_mut().zip(quantities) {
                let [lower, upper] = band.interval(|curve| Some(of(curve))).unwrap();
                *held += usize::from(lower <= of(&exact) && of(&exact) <= upper);
            }
        }
        // 95 % of 60 are 57; four standard errors below are 50.
        assert!(held.iter().all(|held| *held >= 50), "{held:?}");
    }

    #[test]
    fn a_reliability_holds_until_then_with_the_confidence_asked_for() {
        let (level, studies) = (0.9, 200_u32);
        let exact = 1000.0 * (-f64::ln(level)).powf(1.0 / 3.0);
        let mut rng = ChaCha12Rng::seed_from_u64(7);
        let mut held = [0_u32; 2];
        for _ in 0..studies {
            let band = counted(&mut rng);
            for (held, confidence) in held.iter_mut().zip([0.5, 0.9]) {
                *held += u32::from(band.surely_until(level, confidence) <= exact);
            }
        }
        let shares = held.map(|held| f64::from(held) / f64::from(studies));
        // Three standard errors of 200 studies are 0.11 and 0.06; the smaller of two bounds holds a little more often.
        assert!((0.42..0.67).contains(&shares[0]) && (0.85..0.98).contains(&shares[1]), "{shares:?}");
    }

    #[test]
    fn a_certain_curve_has_no_width() {
        let (times, r) = ([0.0, 10.0, 20.0], [1.0, 0.5, 0.0]);
        let band = CurveBand::new(&times, &r, [&r, &r], 100, &mut ChaCha12Rng::seed_from_u64(1));
        let found = band.interval(|curve| Some(curve.restricted_mean())).unwrap();
        assert_eq!(found, [10.0, 10.0]);
        assert_eq!((band.surely_until(0.75, 0.99), band.surely_until(0.0, 0.99)), (5.0, 20.0));
        assert_eq!((band.interval(|_| None), band.share(|curve| curve.last() == 0.0)), (None, 1.0));
    }
}
