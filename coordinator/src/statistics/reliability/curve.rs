//! R(n) with its standard error, the governing checkpoint and the coefficient of variation of P_f.

/// Reliability at one checkpoint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurvePoint {
    /// R = 1 - P_f [1].
    pub reliability: f64,
    /// sqrt(p (1 - p) / N + surrogate error^2) [1], where p = (N P_f + 1) / (N + 2) is the expected failure
    /// probability after so many failures among N samples: none at all does not prove that there are none.
    pub standard_error: f64,
}

/// What a population is conditional on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Condition {
    /// Probability of the condition [1]: a share p of the population stands for this times p.
    pub probability: f64,
    /// Its coefficient of variation [1].
    pub cov: f64,
    /// By how much correlated samples enlarge the variance of a share: by the factor 1 + gamma [1].
    pub gamma: f64,
    /// Intermediate events on the way there.
    pub levels: usize,
}

impl Condition {
    /// No condition: independent samples of the variables.
    pub const NONE: Self = Self { probability: 1.0, cov: 0.0, gamma: 0.0, levels: 0 };

    /// Coefficient of variation of the probability that a share `failed` of `points` samples stands for.
    pub fn coefficient_of_variation(&self, failed: f64, points: usize) -> f64 {
        (coefficient_of_variation(failed, points) * (1.0 + self.gamma).sqrt()).hypot(self.cov)
    }
}

/// Curve of R over the m checkpoints from failure shares `(m,)` counted over `points` samples under a condition.
///
/// `surrogate` gives the surrogate error (with the simulator noise) of the shares at some checkpoints, ascending; between them the error of
/// the nearest holds, outside them the surrogates leave no doubt and only sampling counts. Empty: direct simulation.
pub fn reliability_curve(
    failed: &[f64],
    points: usize,
    surrogate: &[(usize, f64)],
    condition: &Condition,
) -> Vec<CurvePoint> {
    let at = |(n, share): (usize, &f64)| {
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
    failed.iter().enumerate().map(at).collect()
}

fn surrogate_error_at(n: usize, surrogate: &[(usize, f64)]) -> f64 {
    match (surrogate.first(), surrogate.last()) {
        (Some((first, _)), Some((last, _))) if (*first..=*last).contains(&n) => {
            surrogate.iter().min_by_key(|(at, _)| at.abs_diff(n)).map_or(0.0, |(_, error)| *error)
        }
        _ => 0.0,
    }
}

/// The checkpoint whose failure share is nearest 1/2, the first at a tie.
pub fn governing_checkpoint(failed: &[f64]) -> usize {
    let distance = |n: usize| (failed[n] - 0.5).abs();
    (0..failed.len()).reduce(|best, n| if distance(n) < distance(best) { n } else { best }).unwrap_or(0)
}

/// Coefficient of variation of a failure share counted over `points` samples: sqrt((1 - P_f) / (N P_f)).
///
/// Without any failure the share is known only to be of the order of 1 / N, which is put in its place: about 1.
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
    fn a_condition_scales_the_share_and_adds_its_own_doubt() {
        let condition = Condition { probability: 1e-4, cov: 0.05, gamma: 3.0, levels: 4 };
        let point = reliability_curve(&[0.2], 98, &[], &condition)[0];
        let sampling = 4.0 * 0.206 * 0.794 / 98.0;
        assert!((1.0 - point.reliability - 2e-5).abs() < 1e-15);
        assert!((point.standard_error / 1e-4 - (sampling + 1e-4_f64).sqrt()).abs() < 1e-12);
        let cov = condition.coefficient_of_variation(0.2, 400);
        assert!((cov - (4.0 * 4.0 / 400.0 + 0.0025_f64).sqrt()).abs() < 1e-15);
    }

    #[test]
    fn the_governing_checkpoint_is_the_most_undecided() {
        assert_eq!(governing_checkpoint(&[0.0, 0.3, 0.6, 0.9]), 2);
        assert_eq!(governing_checkpoint(&[1e-3]), 0);
        assert!((coefficient_of_variation(0.01, 40_000) - 0.0497).abs() < 1e-4);
        assert!(coefficient_of_variation(0.0, 1000) > 0.9);
    }
}
