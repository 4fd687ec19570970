//! Unknown parameters of distributions, with their priors, as independent standard normals.
//!
//! A parameter theta is the mean or the standard deviation of a variable (of the parent for a truncated normal). With v a standard
//! normal, theta = F^-1(Phi(v)), or exp of it, where F is the prior's distribution of theta or of ln theta. A flat prior is a
//! uniform one between wide bounds: of the mean, of ln mean for a variable that is positive by its family, of ln std. For a
//! location and a scale these are the right Haar measure, under which bounds have their stated coverage.
//!
//! Distributions that samples leave possible, of a family that was fitted to them.
//!
//! For y = location + scale z the fit of n values has pivots: (location' - location) / scale and scale' / scale have distributions
//! that do not depend on location and scale. Samples z* of the standard distribution with the fit (a, b) give
//!
//!   scale = scale' / b,   location = location' - a scale,
//!
//! whose quantiles are exact confidence bounds of the parameters and of every quantile, for any n. Of an empirical distribution the
//! mean and the standard deviation are those of samples drawn with replacement, and its shape stays: an approximation, which
//! needs many samples.
//!
//! # Source
//! Right Haar priors: Severini, Mukerjee, Ghosh (2002), On an exact probability matching property of right-invariant priors,
//! Biometrika 89(4).
//! Lawless (2003), Statistical Models and Methods for Lifetime Data, 2nd edition, section E.5 and appendix E; Efron (1979), Bootstrap methods:
//! another look at the jackknife, The Annals of Statistics 7(1).

use crate::design::with_moments;
use common::random::{Distribution, Extreme, Family, LawError, Tail};
use rand::{Rng, RngExt};

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
            [take(&variable.mean, variable.law.parent_mean()), take(&variable.std, variable.law.given_std())]
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

/// Most attempts for one draw: samples whose distribution does not exist are drawn again.
const ATTEMPTS: usize = 100;

/// `count` distributions that the samples `(n,)` with their fitted distribution `fitted` leave possible; those that the
/// family does not allow are replaced by `fitted`.
pub fn fitted_draws(
    family: Option<Family>,
    fitted: &Distribution,
    samples: &[f64],
    count: usize,
    rng: &mut impl Rng,
) -> Vec<Distribution> {
    let draw = |rng: &mut dyn Rng| match family {
        Some(family) => by_pivots(family, samples, rng),
        None => by_moments(fitted, samples, rng),
    };
    (0..count).map(|_| (0..ATTEMPTS).find_map(|_| draw(rng)).unwrap_or_else(|| fitted.clone())).collect()
}

fn by_pivots(family: Family, samples: &[f64], rng: &mut dyn Rng) -> Option<Distribution> {
    let y = family.transformed(samples);
    let (own_location, own_scale) = family.standard_fit(&y);
    let standard = family.standard();
    let mut z = || standard.at(rng.random::<f64>().max(f64::EPSILON / 4.0), Tail::Lower);
    let (pivot_location, pivot_scale) = family.standard_fit(&(0..y.len()).map(|_| z()).collect::<Vec<f64>>());
    let scale = own_scale / pivot_scale;
    let location = own_location - pivot_location * scale;
    // Values whose fit has this location and scale.
    let value = |y: &f64| {
        let y = location + scale * (y - own_location) / own_scale;
        match family {
            Family::Normal | Family::Exponential | Family::Gumbel(Extreme::Maxima) => y,
            Family::Gumbel(Extreme::Minima) => -y,
            Family::Lognormal => y.exp(),
            Family::Weibull => (-y).exp(),
        }
    };
    family.fit(&y.iter().map(value).collect::<Vec<f64>>()).ok().filter(|law| law.std().is_finite())
}

fn by_moments(fitted: &Distribution, samples: &[f64], rng: &mut dyn Rng) -> Option<Distribution> {
    let n = samples.len();
    let drawn: Vec<f64> = (0..n).map(|_| samples[rng.random_range(0..n)]).collect();
    let mean = drawn.iter().sum::<f64>() / n as f64;
    let variance = drawn.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1) as f64;
    with_moments(fitted, mean, variance.sqrt(), [false; 2]).ok()
}
