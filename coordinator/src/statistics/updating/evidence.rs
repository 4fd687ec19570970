//! Likelihood of one observation of a unit, and how probable it is under a predictive distribution.
//!
//! A measured value y with error of standard deviation s, where a state predicts p with an error of standard deviation e:
//!
//!   ln L = -(y - p)^2 / (2 (s^2 + e^2)) - ln(s^2 + e^2) / 2,
//!
//! survival until the life n: L = 1 if the predicted life is beyond n, else 0; failure by n: L = 1 if it is not beyond n. Under
//! the temperature phi in [0, 1] a measurement has L^phi, survival is that until phi n, and failure that by n / phi, so that
//! phi leads from no observation to all of it.
//!
//! The predictive probability of a measurement is two-sided, 2 min(F, 1 - F) with F = sum of w_i Phi((y - p_i) / sqrt(s^2 + e_i^2));
//! that of survival and failure is the probability of the event.
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
    /// The unit had failed by this life [cycles].
    Failed(f64),
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
            Self::Failed(life) => possible(phi == 0.0 || particles.predictions.life(i) <= life / phi),
        }
    }

    /// Predictive probability of the observation [1].
    pub(super) fn probability(&self, particles: &Particles) -> f64 {
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
            Self::Failed(life) => particles.share(|i| particles.predictions.life(i) <= life),
        }
    }
}
