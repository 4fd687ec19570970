//! Targets of a calibration: quantities with the values to be met and their tolerances.

use super::space::FreeParameter;
use crate::analyses::quantity::ShownUnit;

/// Statistic of an output over the random variables.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum OutputStatistic {
    /// Mean over the random variables.
    Mean,
    /// Standard deviation over the random variables.
    Std,
    /// Its value at the means of the random variables.
    Nominal,
}

/// Quantity of a target.
#[derive(Debug, Clone, PartialEq)]
pub enum TargetQuantity {
    /// Statistic of an output at checkpoint `n`.
    Output {
        /// What of its values.
        statistic: OutputStatistic,
        /// Index of the output.
        output: usize,
        /// Index of the checkpoint.
        n: usize,
    },
    /// R at checkpoint `n` by one limit state, or by all if `limit_state` is `None`.
    Reliability {
        /// Index of the limit state.
        limit_state: Option<usize>,
        /// Index of the checkpoint.
        n: usize,
    },
    /// Largest force in a joint in the first cycle of the nominal mechanism.
    PeakForce {
        /// Index of the joint.
        joint: usize,
    },
    /// Wear depth of the nominal mechanism's bore at the end of its life.
    Depth {
        /// Index of the joint.
        joint: usize,
        /// Angle on the bore [rad].
        angle: f64,
    },
}

/// One number to be met by the fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Target {
    /// Name in the report.
    pub name: String,
    /// Quantity to be compared with the value.
    pub quantity: TargetQuantity,
    /// Value to be met [SI].
    pub value: f64,
    /// Standard deviation of the measurement, or of the deviation to be accepted [SI].
    pub tolerance: f64,
    /// Unit in the report.
    pub unit: ShownUnit,
}

impl Target {
    /// The target with the sampling error of `points` samples in its tolerance: that of a reliability, which is a share of
    /// them, sqrt(R (1 - R) / N), an upper bound for a Latin hypercube.
    #[must_use]
    pub fn counted_over(mut self, points: usize) -> Self {
        if matches!(self.quantity, TargetQuantity::Reliability { .. }) {
            let variance = (self.value * (1.0 - self.value)).max(0.0) / points as f64;
            self.tolerance = self.tolerance.hypot(variance.sqrt());
        }
        self
    }
}

/// Free parameters and targets of a calibration.
#[derive(Debug, Clone, PartialEq)]
pub struct CalibrationTargets {
    /// Parameters to be fitted, at least one.
    pub free: Vec<FreeParameter>,
    /// Numbers to be met, at least one.
    pub targets: Vec<Target>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn issue_the_sampling_error_of_a_reliability_is_part_of_its_tolerance() {
        let unit = ShownUnit::of("");
        let reliability = TargetQuantity::Reliability { limit_state: None, n: 3 };
        let target =
            |quantity| Target { name: "R".into(), quantity, value: 0.5, tolerance: 0.02, unit: unit.clone() };
        let widened = target(reliability).counted_over(1000).tolerance;
        assert!((widened - (0.02_f64.powi(2) + 2.5e-4).sqrt()).abs() < 1e-15, "{widened}");
        assert_eq!(
            target(TargetQuantity::Output { statistic: OutputStatistic::Mean, output: 0, n: 3 })
                .counted_over(1000)
                .tolerance,
            0.02
        );
    }
}
