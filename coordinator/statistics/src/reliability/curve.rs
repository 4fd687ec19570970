//! R(n) with its standard error, the governing checkpoint and the coefficient of variation of P_f.
//!
//! With N samples conditional on an event E (or on none), and the share p of them failed by checkpoint n,
//!
//!   R(n) = 1 - P(E) p,
//!   standard error^2 = P(E)^2 [p' (1 - p') / N (1 + gamma) + e^2 + (p cov(P(E)))^2],   p' = (N p + 1) / (N + 2),
//!
//! where e [1] is the surrogate error of the share, gamma [1] the effect of correlated samples (zero for
//! independent ones) and cov(P(E)) the coefficient of variation of P(E). The terms are taken as independent.
//! p' is the posterior mean of a share under a uniform prior: no failure among N samples does not prove that
//! there is none. Without any failure under a condition, at any checkpoint, the levels have not come to the
//! limit; then P(E) is an upper bound of P_f by the surrogates, and is stated as the standard error.
//!
//! # Source
//! Standard error of a share: the binomial distribution; p': Laplace's rule of succession. Correlated samples
//! of subset simulation: Au, Beck (2001), Estimation of small failure probabilities in high dimensions by
//! subset simulation, Probabilistic Engineering Mechanics 16(4).

/// Reliability at one checkpoint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurvePoint {
    /// R = 1 - P_f [1].
    pub reliability: f64,
    /// Standard error of R [1] from sampling, surrogate and condition.
    pub standard_error: f64,
}

/// Half of the width of a 95 % interval in standard errors [1].
pub const REACH: f64 = 1.96;

impl CurvePoint {
    /// The point of an R counted over the samples with a result, if the share f = `missing` [1] of all samples has
    /// none. R over all samples lies between (1 - f) R, if all of these failed, and (1 - f) R + f, if none did; so
    ///
    ///   standard error' = standard error + f max(R, 1 - R) / 1.96,
    ///
    /// which widens the 95 % interval by the larger distance to these bounds.
    #[must_use]
    pub fn with_missing(self, missing: f64) -> Self {
        let r = self.reliability;
        Self { standard_error: self.standard_error + missing * r.max(1.0 - r) / REACH, ..self }
    }
}

/// The event a population is conditional on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Condition {
    /// Probability of the event [1]; a share p of the population stands for this probability times p.
    pub probability: f64,
    /// Coefficient of variation of that probability [1].
    pub cov: f64,
    /// Effect of correlated samples [1]: the variance of a share is larger by the factor 1 + gamma.
    pub gamma: f64,
    /// Number of intermediate events.
    pub levels: usize,
}

impl Condition {
    /// No condition: independent samples of the variables.
    pub const NONE: Self = Self { probability: 1.0, cov: 0.0, gamma: 0.0, levels: 0 };

    /// Coefficient of variation [1] of the failure probability that belongs to a share `failed` [1] of
    /// `points` samples.
    pub fn coefficient_of_variation(&self, failed: f64, points: usize) -> f64 {
        (coefficient_of_variation(failed, points) * (1.0 + self.gamma).sqrt()).hypot(self.cov)
    }
}

/// Curve of R over the m checkpoints, from failure shares `failed` `(m,)` [1] counted over `points` samples
/// under a condition.
///
/// `surrogate` holds the surrogate error [1] (simulator noise included) of the shares at some checkpoints,
/// ascending. Between them the error of the nearest holds; outside them the classification is certain, and
/// only sampling counts. It is empty for direct simulation.
pub fn reliability_curve(
    failed: &[f64],
    points: usize,
    surrogate: &[(usize, f64)],
    condition: &Condition,
) -> Vec<CurvePoint> {
    let never_reached = condition.levels > 0 && failed.iter().all(|share| *share == 0.0);
    let point = |(n, share): (usize, &f64)| {
        if never_reached {
            return CurvePoint { reliability: 1.0, standard_error: condition.probability };
        }
        let count = points as f64;
        let expected = (count * share + 1.0) / (count + 2.0);
        let sampling = expected * (1.0 - expected) / count * (1.0 + condition.gamma);
        let error = surrogate_error_at(n, surrogate);
        let level = share * condition.cov;
        let of_share = (sampling + error * error + level * level).sqrt();
        CurvePoint {
            reliability: 1.0 - condition.probability * share,
            standard_error: condition.probability * of_share,
        }
    };
    failed.iter().enumerate().map(point).collect()
}

/// Surrogate error of the share at checkpoint `n` [1], see [`reliability_curve`].
pub fn surrogate_error_at(n: usize, surrogate: &[(usize, f64)]) -> f64 {
    match (surrogate.first(), surrogate.last()) {
        (Some((first, _)), Some((last, _))) if (*first..=*last).contains(&n) => {
            surrogate.iter().min_by_key(|(at, _)| at.abs_diff(n)).map_or(0.0, |(_, error)| *error)
        }
        _ => 0.0,
    }
}

/// Index of the checkpoint whose failure share `(m,)` is nearest to 1/2, the first at a tie.
pub fn governing_checkpoint(failed: &[f64]) -> usize {
    let distance = |n: usize| (failed[n] - 0.5).abs();
    (0..failed.len()).reduce(|best, n| if distance(n) < distance(best) { n } else { best }).unwrap_or(0)
}

/// Coefficient of variation [1] of a failure share `failed` [1] counted over N = `points` samples:
/// sqrt((1 - P_f) / (N P_f)).
///
/// Without any failure P_f is known only to be of the order of 1 / N, which takes its place: the result is
/// about 1.
pub fn coefficient_of_variation(failed: f64, points: usize) -> f64 {
    let n = points as f64;
    let pf = failed.max(1.0 / n);
    ((1.0 - pf) / (n * pf)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn standard_errors_combine_sampling_and_surrogate() {
        let curve = reliability_curve(&[0.0, 0.2, 0.5, 1.0], 98, &[(1, 0.03), (2, 0.0)], &Condition::NONE);
        let share = |p: f64| p * (1.0 - p) / 98.0;
        assert!((curve[1].standard_error - (share(20.6 / 100.0) + 0.03 * 0.03).sqrt()).abs() < 1e-12);
        assert!((curve[2].standard_error - share(0.5).sqrt()).abs() < 1e-12);
        // Neither no failure nor nothing but failures is certainty.
        assert_eq!(curve[0].reliability, 1.0);
        assert!((curve[0].standard_error - share(0.01).sqrt()).abs() < 1e-12);
        assert!((curve[3].standard_error - curve[0].standard_error).abs() < 1e-12);
    }

    #[test]
    fn a_condition_scales_the_share_and_adds_its_own_variance() {
        let condition = Condition { probability: 1e-4, cov: 0.05, gamma: 3.0, levels: 4 };
        let point = reliability_curve(&[0.2], 98, &[], &condition)[0];
        let sampling = 4.0 * 0.206 * 0.794 / 98.0;
        assert!((1.0 - point.reliability - 2e-5).abs() < 1e-15);
        assert!((point.standard_error / 1e-4 - (sampling + 1e-4_f64).sqrt()).abs() < 1e-12);
        let cov = condition.coefficient_of_variation(0.2, 400);
        assert!((cov - (4.0 * 4.0 / 400.0 + 0.0025_f64).sqrt()).abs() < 1e-15);
    }

    #[test]
    fn issue_levels_that_never_reach_the_limit_bound_the_probability() {
        let condition = Condition { probability: 1e-6, cov: 0.05, gamma: 0.0, levels: 6 };
        let curve = reliability_curve(&[0.0, 0.0], 100_000, &[], &condition);
        assert!(curve.iter().all(|p| p.reliability == 1.0 && p.standard_error == 1e-6));
        // Where failures come later in life, earlier checkpoints have an error by counting.
        let early = reliability_curve(&[0.0, 0.3], 100_000, &[], &condition)[0];
        assert!(early.standard_error < 2e-11);
    }

    #[test]
    fn an_interval_with_missing_samples_contains_both_bounds() {
        for (r, missing) in [(0.881, 0.0845), (0.05, 0.2), (1.0, 0.1)] {
            let point = CurvePoint { reliability: r, standard_error: 0.004 }.with_missing(missing);
            let half = REACH * point.standard_error;
            let sampling = REACH * 0.004;
            assert!(r - half <= (1.0 - missing) * r - sampling + 1e-12, "{r}");
            assert!(r + half >= (1.0 - missing) * r + missing + sampling - 1e-12, "{r}");
        }
        let point = CurvePoint { reliability: 0.9, standard_error: 0.01 };
        assert_eq!(point.with_missing(0.0), point);
    }

    #[test]
    fn the_governing_checkpoint_is_nearest_to_one_half() {
        assert_eq!(governing_checkpoint(&[0.0, 0.3, 0.6, 0.9]), 2);
        assert_eq!(governing_checkpoint(&[1e-3]), 0);
        assert!((coefficient_of_variation(0.01, 40_000) - 0.0497).abs() < 1e-4);
        assert!(coefficient_of_variation(0.0, 1000) > 0.9);
    }
}
