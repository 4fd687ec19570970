//! Limit states: thresholds of outputs, and the sides of them that mean failure.

use serde::Serialize;

/// A limit state of an output: the mechanism has failed where the output is at or beyond a threshold.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LimitState {
    /// Unique name, e.g. `wear`.
    pub name: String,
    /// Index into [`super::Scene::outputs`].
    pub output: usize,
    /// Threshold in the unit of the output (SI); the upper one of two.
    pub threshold: f64,
    /// Side of the threshold on which the mechanism has failed.
    pub fails: Fails,
}

/// The side of a threshold that means failure; the threshold itself belongs to it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub enum Fails {
    /// Values at the threshold and above.
    #[default]
    Above,
    /// Values at the threshold and below.
    Below,
    /// Values at the threshold and above, and values at a lower threshold and below.
    Outside {
        /// The lower threshold in the unit of the output (SI).
        lower: f64,
    },
}

impl LimitState {
    /// Response r(y) of a value y of the output: failure means that it reaches [`Self::response_threshold`] from below. It is y
    /// where large values fail, -y where small ones do, and |y - c| where both do, c being the middle between the thresholds.
    pub fn response(&self, value: f64) -> f64 {
        match self.fails {
            Fails::Above => value,
            Fails::Below => -value,
            // About the middle, so that a value at a limit has the threshold of the response whatever rounding does.
            Fails::Outside { lower } => {
                self.response_threshold() + (value - self.threshold).max(lower - value)
            }
        }
    }

    /// Threshold of the response: the threshold, its negative, or half the distance between the two.
    pub fn response_threshold(&self) -> f64 {
        match self.fails {
            Fails::Above => self.threshold,
            Fails::Below => -self.threshold,
            Fails::Outside { lower } => 0.5 * (self.threshold - lower),
        }
    }

    /// True if a value of the output means failure; false for NaN.
    pub fn is_reached(&self, value: f64) -> bool {
        match self.fails {
            Fails::Above => value >= self.threshold,
            Fails::Below => value <= self.threshold,
            Fails::Outside { .. } => self.response(value) >= self.response_threshold(),
        }
    }

    /// Size by which errors of the output are measured: that of the threshold, or half the distance between the two.
    pub fn scale(&self) -> f64 {
        self.response_threshold().abs()
    }

    /// The thresholds of the output, ascending.
    pub fn thresholds(&self) -> Vec<f64> {
        let lower = if let Fails::Outside { lower } = self.fails { Some(lower) } else { None };
        lower.into_iter().chain([self.threshold]).collect()
    }

    /// The middle between two thresholds, if there are two.
    pub fn middle(&self) -> Option<f64> {
        let Fails::Outside { lower } = self.fails else { return None };
        Some(0.5 * (lower + self.threshold))
    }
}
