//! Course of a response over the life: none, growth, or wear in proportion to the cycles.

use super::response::Response;
use common::random::Distribution;
use std::f64::consts::TAU;

/// Course of all responses of a problem.
#[derive(Debug, Clone, PartialEq)]
pub enum Course {
    /// One checkpoint.
    Once,
    /// Growth on top of the first value.
    Growth(Growth),
    /// Wear y(n) = n exp(v) at checkpoint n = 1, ..., m with the value v of the response: a life of limit exp(-v).
    Wear {
        /// Number of checkpoints m.
        checkpoints: usize,
        /// Distributions of independent exp(-v), the least of which is the life over the limit; empty if they are not known.
        laws: Vec<Distribution>,
    },
}

impl Course {
    /// Number of checkpoints m.
    pub const fn checkpoints(&self) -> usize {
        match self {
            Self::Once => 1,
            Self::Growth(growth) => growth.checkpoints,
            Self::Wear { checkpoints, .. } => *checkpoints,
        }
    }

    /// History of a response of value `start` at z `(d,)` [1], from the first checkpoint on.
    pub fn history(&self, start: f64, z: &[f64], history: &mut [f64]) {
        match self {
            Self::Once => history.fill(start),
            Self::Growth(growth) => growth.history(start, z, history),
            Self::Wear { .. } => {
                let rate = start.exp();
                history.iter_mut().enumerate().for_each(|(n, y)| *y = (n + 1) as f64 * rate);
            }
        }
    }
}

/// Growth of a response over the life; tau = (n + 1) / m runs over the checkpoints n.
#[derive(Debug, Clone, PartialEq)]
pub struct Growth {
    /// Number of checkpoints m.
    pub checkpoints: usize,
    /// Logarithm of the growth over the whole life.
    pub log_rate: Response,
    /// Exponent of tau [1].
    pub exponent: f64,
    /// Amplitude of the oscillation over the life [1]; zero for a monotone history.
    pub amplitude: f64,
    /// Periods of the oscillation in a life [1].
    pub periods: f64,
    /// Phase of the oscillation, in periods.
    pub phase: Response,
}

impl Growth {
    /// History `(m,)` of a response of first value `start` at z `(d,)` [1].
    fn history(&self, start: f64, z: &[f64], history: &mut [f64]) {
        let rate = self.log_rate.value(z).exp();
        let phase = if self.amplitude == 0.0 { 0.0 } else { self.phase.value(z) };
        for (n, y) in history.iter_mut().enumerate() {
            let tau = (n + 1) as f64 / self.checkpoints as f64;
            *y = start + rate * tau.powf(self.exponent);
            if self.amplitude != 0.0 {
                *y += self.amplitude * (TAU * (self.periods * tau + phase)).sin();
            }
        }
    }
}
