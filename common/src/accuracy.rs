//! Numerical settings of an evaluation, and three presets.

mod name;

pub use name::{AccuracyNameError, KNOBS, LevelsError, MOST_LEVELS, NamedAccuracy};

use serde::{Deserialize, Serialize};

/// Largest factor on control points [1].
const MOST_POINTS: u32 = 64;

/// Numerical settings of one evaluation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Accuracy {
    /// Tolerance of the local error of a time step, relative to the scales of the motion [1].
    pub step_tolerance: f64,
    /// Largest time step as a fraction of the cycle [1].
    pub largest_step: f64,
    /// Bound on the accepted time steps of an island in a cycle.
    pub steps_bound: u64,
    /// Samples of the contact history per cycle for the wear step.
    pub wear_samples: usize,
    /// Largest length of a block of wear [cycles].
    pub cycle_jump: u32,
    /// Tolerance of the wear step, relative to the wear it adds [1].
    pub wear_tolerance: f64,
    /// Warm-up before a measured cycle, as a fraction of the cycle [1].
    pub warm_up: f64,
    /// Model of the motion that drives the wear.
    pub tier: Tier,
    /// Factor on the numbers of control points of bores and guides, unless they are a part of the scene's model [1].
    #[serde(default = "one")]
    pub points: u32,
    /// Whether the error of blocks, wear steps and control points is estimated, from copies of the surfaces that wear beside them; without it
    /// stated errors leave it out. An evaluation that returns its first cycle always estimates it.
    #[serde(default = "yes")]
    pub wear_error: bool,
}

fn one() -> u32 {
    1
}

fn yes() -> bool {
    true
}

/// Model of the motion between two wear steps.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Tier {
    /// Quasi-static if comparisons with the dynamics stay below the wear tolerance; else dynamic, with longer time steps in the cycles where
    /// comparisons show that these change nothing.
    #[default]
    Automatic,
    /// Always the dynamics, with time steps of the given tolerance.
    Dynamic,
}

impl Accuracy {
    /// Names of the presets, from the quickest to the most exact.
    pub const NAMES: [&str; 3] = ["draft", "balanced", "reference"];

    /// The preset for a first impression. For the flapping-wing drive at 201 points, `coordinator tradeoff` found errors of at most 0.04 %
    /// of the limit for the wear and 5.2 % for the asymmetry, which displaces the life it ends by up to 630 of 66 000 cycles, in 0.55 of
    /// the time of `balanced` (`coordinator/doc/accuracy.md`).
    pub const fn draft() -> Self {
        Accuracy {
            step_tolerance: 2e-3,
            largest_step: 1.0 / 500.0,
            wear_samples: 150,
            cycle_jump: 8000,
            ..Self::balanced()
        }
    }

    /// The preset for studies, and the default. The measurement named in [`Accuracy::draft`] found the wear within 0.03 %, the
    /// asymmetry within 3.2 % (1.1 % up to its limit), and the life it ends within 240 cycles. Shorter time steps alone gain little.
    pub const fn balanced() -> Self {
        Accuracy {
            step_tolerance: 5e-4,
            largest_step: 1.0 / 700.0,
            // Forty times the steps of a cycle of the flapping-wing drive. Of its extremes, 6 r/min under `foundation` needs more than
            // 60 000, and stiff joints with little clearance and much friction, or without damping, more than 100 000
            // (example `extremes` of the crate `worker`).
            steps_bound: 400_000,
            // The wear needs no more than 50, since intervals end also where the contact has turned. The asymmetry of the drive, once its
            // vibration has set in, is higher by 0.6 r/min with 100 than with 1000, by 0.2 with 200 (`coordinator/doc/accuracy.md`).
            wear_samples: 200,
            cycle_jump: 4000,
            wear_tolerance: 2e-2,
            warm_up: 0.05,
            tier: Tier::Automatic,
            points: 1,
            wear_error: true,
        }
    }

    /// The preset that the others are compared with.
    pub const fn reference() -> Self {
        Accuracy {
            step_tolerance: 1e-4,
            largest_step: 1.0 / 1000.0,
            // Four times that of `balanced`, for its shorter steps.
            steps_bound: 1_600_000,
            wear_samples: 1000,
            cycle_jump: 500,
            wear_tolerance: 5e-3,
            warm_up: 1.0,
            tier: Tier::Dynamic,
            ..Self::balanced()
        }
    }

    /// These settings with time steps shorter by `factor` [1]: an error-controlled step of fourth order shrinks by the factor if its
    /// tolerance is divided by factor^4. `refined(2.0)` halves the steps. Blocks and samples of the wear do not change.
    pub fn refined(self, factor: f64) -> Self {
        Accuracy {
            step_tolerance: self.step_tolerance / (factor * factor * factor * factor),
            largest_step: self.largest_step / factor,
            steps_bound: (self.steps_bound as f64 * factor).ceil() as u64,
            ..self
        }
    }

    /// These settings with every length of the discretisation halved: time steps, blocks, intervals between samples and between control
    /// points, and half the tolerance of the wear step.
    pub fn halved(self) -> Self {
        Accuracy {
            wear_samples: self.wear_samples.saturating_mul(2),
            cycle_jump: (self.cycle_jump / 2).max(1),
            wear_tolerance: self.wear_tolerance / 2.0,
            points: self.points.saturating_mul(2),
            ..self.refined(2.0)
        }
    }

    /// The first setting that is not a number in its range, by name; the ranges are those that the knobs of a name can reach.
    pub fn out_of_range(&self) -> Option<&'static str> {
        let checks = [
            ("step_tolerance", (1e-12..=1e3).contains(&self.step_tolerance)),
            ("largest_step", (1e-7..=1.0).contains(&self.largest_step)),
            ("steps_bound", (1..=1_000_000_000).contains(&self.steps_bound)),
            ("wear_samples", (20..=100_000).contains(&self.wear_samples)),
            ("cycle_jump", (1..=1_000_000).contains(&self.cycle_jump)),
            ("wear_tolerance", (1e-9..=1.0).contains(&self.wear_tolerance)),
            ("warm_up", (0.0..=10.0).contains(&self.warm_up)),
            ("points", (1..=MOST_POINTS).contains(&self.points)),
        ];
        checks.into_iter().find(|(_, is_right)| !is_right).map(|(setting, _)| setting)
    }

    /// The preset of this name, see [`Accuracy::NAMES`].
    pub fn by_name(name: &str) -> Option<Self> {
        let presets = [Self::draft(), Self::balanced(), Self::reference()];
        Self::NAMES.iter().zip(presets).find(|(known, _)| **known == name).map(|(_, preset)| preset)
    }
}

impl Default for Accuracy {
    fn default() -> Self {
        Self::balanced()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_the_step_is_a_sixteenth_of_the_tolerance() {
        let (whole, half) = (Accuracy::balanced(), Accuracy::balanced().refined(2.0));
        assert_eq!(half.step_tolerance, whole.step_tolerance / 16.0);
        assert_eq!(half.largest_step, whole.largest_step / 2.0);
        assert_eq!(half.steps_bound, whole.steps_bound * 2);
        assert_eq!(Accuracy { wear_samples: 7, ..whole }.refined(2.0).wear_samples, 7);
        assert_eq!(whole.refined(1.0), whole);
    }
}
