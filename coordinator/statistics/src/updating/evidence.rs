//! Likelihood of one observation of a unit, and how probable it is under a predictive distribution.
//!
//! A measured value y with error of standard deviation s, where a state predicts p with an error of standard deviation e:
//!
//!   ln L = -(y - p)^2 / (2 (s^2 + e^2)) - ln(s^2 + e^2) / 2,
//!
//! survival until the life n: L = 1 if the predicted life is beyond n, else 0; failure by n: L = 1 if it is not beyond n. A
//! failure whose life was recorded has the likelihood of a measured life. One by a known limit state is possible only where that
//! one is exceeded first. Under the temperature phi in [0, 1] a measurement has L^phi, survival is that until phi n, and
//! failure that by n / phi, so that phi leads from no observation to all of it.
//!
//! The predictive probability of a measurement is two-sided, 2 min(F, 1 - F) with F = sum of w_i Phi((y - p_i) / sqrt(s^2 + e_i^2));
//! that of survival and failure is the probability of the event. A likelihood that is given as such has none.
//!
//! # Source
//! Likelihood of equality and inequality information: Straub (2011), Reliability updating with equality information,
//! Probabilistic Engineering Mechanics 26(2). Predictive probability: Box (1980), Sampling and Bayes' inference in
//! scientific modelling and robustness, Journal of the Royal Statistical Society A 143(4).

use super::particles::Particles;
use common::random::standard_normal_cdf;

/// One observation of a unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Evidence {
    /// The predicted value `index` was measured.
    Measured {
        /// Index of the value among those that the model predicts.
        index: usize,
        /// Value that was measured.
        value: f64,
        /// Standard deviation of the measurement's error, above 0.
        std: f64,
    },
    /// The unit had not failed by this life [cycles].
    Survived(f64),
    /// The unit had failed by this life [cycles], by the limit state with the index `by` if it is known.
    Failed {
        /// Life by which it had failed [cycles].
        life: f64,
        /// Index of the limit state that failed first.
        by: Option<usize>,
    },
    /// The unit failed at this life.
    Life {
        /// Life of the failure [cycles].
        life: f64,
        /// Standard deviation of its error, above 0 [cycles].
        std: f64,
        /// Index of the limit state that failed first.
        by: Option<usize>,
    },
    /// The predicted value `index` is ln L of an observation itself.
    LogLikelihood(usize),
}

/// True if the first failure of particle `i` is that of a limit state, or of any.
fn is_by(particles: &Particles, i: usize, by: Option<usize>) -> bool {
    by.is_none_or(|s| particles.predictions.lives_of(i)[s] <= particles.predictions.life(i))
}

impl Evidence {
    /// ln L of particle `i` under the temperature `phi` [1], up to a constant.
    pub(super) fn log_likelihood(&self, particles: &Particles, i: usize, phi: f64) -> f64 {
        let possible = |is: bool| if is { 0.0 } else { f64::NEG_INFINITY };
        match *self {
            Self::Measured { index, value, std } => {
                let (predicted, error) = particles.predictions.value(i, index);
                let variance = std * std + error * error;
                -0.5 * phi * ((value - predicted).powi(2) / variance + variance.ln())
            }
            Self::Survived(life) => possible(phi == 0.0 || particles.predictions.life(i) > phi * life),
            Self::Failed { life, by } => {
                possible(phi == 0.0 || particles.predictions.life(i) <= life / phi && is_by(particles, i, by))
            }
            Self::Life { .. } if phi == 0.0 => 0.0,
            Self::Life { life, std, by } => {
                let predicted = particles.predictions.life(i);
                possible(is_by(particles, i, by)) - 0.5 * phi * ((life - predicted) / std).powi(2)
            }
            Self::LogLikelihood(_) if phi == 0.0 => 0.0,
            Self::LogLikelihood(index) => phi * particles.predictions.value(i, index).0,
        }
    }

    /// Predictive probability of the observation [1].
    pub fn probability(&self, particles: &Particles) -> f64 {
        match *self {
            Self::Measured { index, value, std } => {
                let at = |i: usize| {
                    let (predicted, error) = particles.predictions.value(i, index);
                    (value - predicted) / std.hypot(error)
                };
                let below = particles.mean(|i| standard_normal_cdf(at(i)));
                let above = particles.mean(|i| standard_normal_cdf(-at(i)));
                (2.0 * below.min(above)).min(1.0)
            }
            Self::Survived(life) => particles.share(|i| particles.predictions.life(i) > life),
            Self::Failed { life, by } => {
                particles.share(|i| particles.predictions.life(i) <= life && is_by(particles, i, by))
            }
            Self::Life { life, std, by } => {
                let at = |i: usize| (life - particles.predictions.life(i)) / std;
                let cdf =
                    |x: f64, i: usize| if is_by(particles, i, by) { standard_normal_cdf(x) } else { 0.0 };
                let of = |sign: f64| particles.mean(|i| cdf(sign * at(i), i));
                (2.0 * of(1.0).min(of(-1.0))).min(1.0)
            }
            // A likelihood is no probability.
            Self::LogLikelihood(_) => 1.0,
        }
    }
}
