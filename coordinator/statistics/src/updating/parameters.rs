//! Unknown parameters of distributions, with their priors, as independent standard normals.
//!
//! A parameter theta is the mean or the standard deviation of a variable (of the parent for a truncated normal). With v a standard
//! normal, theta = F^-1(Phi(v)), or exp of it, where F is the prior's distribution of theta or of ln theta. A flat prior is a
//! uniform one between wide bounds: of the mean, of ln mean for a variable that is positive by its family, of ln std. For a
//! location and a scale these are the right Haar measure, under which bounds have their stated coverage.
//!
//! # Source
//! Right Haar priors: Severini, Mukerjee, Ghosh (2002), On an exact probability matching property of right-invariant priors,
//! Biometrika 89(4).

use crate::design::with_moments;
use common::random::{Distribution, LawError};

/// True if a family has positive values only, whatever its mean and standard deviation.
pub fn is_positive_family(law: &Distribution) -> bool {
    matches!(law, Distribution::Lognormal(_) | Distribution::Weibull(_) | Distribution::Exponential(_))
}

/// The prior of one parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterPrior {
    /// Distribution of the parameter, or of its logarithm.
    pub law: Distribution,
    /// True if it is that of the logarithm.
    pub of_logarithm: bool,
}

impl ParameterPrior {
    /// The parameter at a standard normal v [SI].
    pub fn value(&self, v: f64) -> f64 {
        let value = self.law.from_standard_normal(v);
        if self.of_logarithm { value.exp() } else { value }
    }
}

/// A random variable of which parameters are not known.
#[derive(Debug, Clone, PartialEq)]
pub struct UncertainVariable {
    /// Index among the random variables.
    pub index: usize,
    /// Its distribution where the parameters are those known.
    pub law: Distribution,
    /// Bounds of a truncated normal that stay where they are.
    pub fixed: [bool; 2],
    /// Prior of the mean; `None` if it is known.
    pub mean: Option<ParameterPrior>,
    /// Prior of the standard deviation; `None` if it is known.
    pub std: Option<ParameterPrior>,
}

impl UncertainVariable {
    /// The distribution with these moments [SI].
    ///
    /// # Errors
    /// [`LawError`].
    pub fn law_at(&self, mean: f64, std: f64) -> Result<Distribution, LawError> {
        match &self.law {
            // It begins where it begins: its mean is its one parameter.
            Distribution::Exponential(_) => Distribution::exponential_from(self.law.support().0, mean),
            law => with_moments(law, mean, std, self.fixed),
        }
    }
}

/// Unknown parameters of a population.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterSpace {
    /// Variables with at least one unknown parameter `(K,)`.
    pub variables: Vec<UncertainVariable>,
}

impl ParameterSpace {
    /// Number p of parameters: of every variable the mean, then the standard deviation.
    pub fn dimension(&self) -> usize {
        self.variables.iter().map(|v| usize::from(v.mean.is_some()) + usize::from(v.std.is_some())).sum()
    }

    /// Mean and standard deviation of every variable `(K,)` at standard normals v `(p,)` [SI].
    pub fn moments(&self, v: &[f64]) -> Vec<[f64; 2]> {
        let mut rest = v.iter();
        let mut take = |prior: &Option<ParameterPrior>, known: f64| match prior {
            Some(prior) => prior.value(*rest.next().expect("a state has a coordinate for each parameter")),
            None => known,
        };
        let moments = |variable: &UncertainVariable| {
            let mean = take(&variable.mean, variable.law.parent_mean());
            [mean, take(&variable.std, variable.law.given_std())]
        };
        self.variables.iter().map(moments).collect()
    }

    /// Distributions of the variables `(K,)` at v `(p,)` [1]; `None` where one does not exist.
    pub fn laws(&self, v: &[f64]) -> Option<Vec<Distribution>> {
        let moments = self.moments(v);
        let law =
            |(variable, [mean, std]): (&UncertainVariable, &[f64; 2])| variable.law_at(*mean, *std).ok();
        self.variables.iter().zip(&moments).map(law).collect()
    }
}
