//! Words that options take.

use clap::ValueEnum;
use serde::{Deserialize, Serialize};

/// How the reliability is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum MethodName {
    /// Adaptive Kriging and Monte Carlo simulation.
    Ak,
    /// Direct Monte Carlo.
    MonteCarlo,
    /// Direct simulation of a Latin hypercube.
    LatinHypercube,
}

/// Which points are simulated next.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LearningName {
    /// What settles most.
    #[default]
    Gain,
    /// Least distance to the limit in standard deviations.
    U,
    /// Expected feasibility.
    Eff,
    /// Information entropy.
    H,
}

/// Kernel of a correlation.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum KernelName {
    /// The best by cross-validation.
    #[default]
    Auto,
    /// Infinitely smooth.
    Gaussian,
    /// Twice differentiable.
    Matern52,
    /// Once differentiable.
    Matern32,
}

/// Trend of a surrogate.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TrendName {
    /// The best by cross-validation.
    #[default]
    Auto,
    /// A constant.
    Constant,
    /// Linear in every variable.
    Linear,
}

/// Which settings a measurement tries.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum GridName {
    /// Ten of them.
    Quick,
    /// All.
    Full,
}

/// What surrogates make of the numerical errors that simulations state.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StatedErrorsName {
    /// Nothing.
    #[default]
    Ignored,
    /// Shape of the noise, with a level by likelihood.
    Fitted,
    /// Standard deviations as they stand.
    Full,
}
