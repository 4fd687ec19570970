//! Unknown parameters of distributions, with their priors, as independent standard normals.
//!
//! A parameter theta is the mean or the standard deviation of a variable (of the parent for a truncated normal). With v a standard
//! normal, theta = F^-1(Phi(v)), or exp of it, where F is the prior's distribution of theta or of ln theta. A flat prior is a
//! uniform one between wide bounds: of the mean, of ln mean for a variable that is positive by its family, of ln std. For a
//! location and a scale these are the right Haar measure, under which bounds have their stated coverage. Correlations are those of the
//! standard normals of two variables; a flat prior is uniform in each of them, so that all matrices that are positive definite are equally
//! probable: the distribution LKJ(1) where all pairs are unknown.
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
//! Correlations: Lewandowski, Kurowicka, Joe (2009), Generating random correlation matrices based on vines and extended onion method,
//! Journal of Multivariate Analysis 100(9).
//! Lawless (2003), Statistical Models and Methods for Lifetime Data, 2nd edition, section E.5 and appendix E; Efron (1979), Bootstrap methods:
//! another look at the jackknife, The Annals of Statistics 7(1).

use crate::design::{InputModel, with_moments};
use common::random::{Correlation, Distribution, Extreme, Family, GaussianCopula, LawError, Tail};
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

/// A random variable of which parameters may be unknown.
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
    /// True if only its correlations may be unknown.
    pub fn is_known(&self) -> bool {
        self.mean.is_none() && self.std.is_none()
    }

    /// The distribution with these moments [SI].
    ///
    /// # Errors
    /// [`LawError`].
    pub fn law_at(&self, mean: f64, std: f64) -> Result<Distribution, LawError> {
        match &self.law {
            law if self.is_known() => Ok(law.clone()),
            // It begins where it begins: its mean is its one parameter.
            Distribution::Exponential(_) => Distribution::exponential_from(self.law.support().0, mean),
            law => with_moments(law, mean, std, self.fixed),
        }
    }
}

/// What a parameter is of the variables of a space, by their places.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PopulationParameter {
    /// The mean of a variable.
    Mean(usize),
    /// The standard deviation.
    Std(usize),
    /// The correlation of two, with its coefficient where it is known.
    Correlation(Correlation),
}

/// Unknown parameters of a population.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterSpace {
    /// Variables with unknown parameters, and those correlated with them `(K,)`.
    pub variables: Vec<UncertainVariable>,
    /// Their correlations, each with its prior, by places; `None` if it is known.
    pub correlations: Vec<(Correlation, Option<ParameterPrior>)>,
}

impl ParameterSpace {
    /// The parameters with their priors: of every variable the mean, then the standard deviation; then the correlations.
    pub fn parameters(&self) -> impl Iterator<Item = (PopulationParameter, &ParameterPrior)> {
        let variables = self.variables.iter().enumerate();
        let moments = variables.flat_map(|(k, own)| {
            [(PopulationParameter::Mean(k), &own.mean), (PopulationParameter::Std(k), &own.std)]
        });
        let pairs =
            self.correlations.iter().map(|(pair, prior)| (PopulationParameter::Correlation(*pair), prior));
        moments.chain(pairs).filter_map(|(kind, prior)| Some((kind, prior.as_ref()?)))
    }

    /// Number p of parameters.
    pub fn dimension(&self) -> usize {
        self.parameters().count()
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

    /// The correlations at v `(p,)` [1], which has theirs last.
    pub fn correlations(&self, v: &[f64]) -> Vec<Correlation> {
        let unknown = self.correlations.iter().filter(|(_, prior)| prior.is_some()).count();
        let mut rest = v[v.len() - unknown..].iter();
        let coefficient = |(known, prior): &(Correlation, Option<ParameterPrior>)| {
            let own = prior.as_ref().and_then(|prior| Some(prior.value(*rest.next()?)));
            Correlation { coefficient: own.unwrap_or(known.coefficient), ..*known }
        };
        self.correlations.iter().map(coefficient).collect()
    }

    /// Distributions and dependence of the variables at v `(p,)` [1]; `None` where they do not exist.
    pub fn laws(&self, v: &[f64]) -> Option<InputModel> {
        let moments = self.moments(v);
        let law =
            |(variable, [mean, std]): (&UncertainVariable, &[f64; 2])| variable.law_at(*mean, *std).ok();
        let laws: Vec<Distribution> = self.variables.iter().zip(&moments).map(law).collect::<Option<_>>()?;
        let copula = GaussianCopula::new(laws.len(), &self.correlations(v)).ok()?;
        Some(InputModel::new(laws, copula))
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

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha12Rng;
    use rand_distr::{Distribution as _, StandardNormal};

    /// Correlations of three variables that are uniform in (-1, 1) are those of a positive definite matrix with the probability pi^2 / 16, and
    /// each of these then has the variance 1 / 4 of LKJ(1), whose marginal is a beta distribution of (3/2, 3/2) in (-1, 1).
    #[test]
    fn flat_correlations_of_three_variables_are_lkj() {
        let flat = ParameterPrior { law: Distribution::uniform(-1.0, 1.0).unwrap(), of_logarithm: false };
        let law = Distribution::normal(2.0, 0.5).unwrap();
        let variable =
            |index| UncertainVariable { index, law: law.clone(), fixed: [false; 2], mean: None, std: None };
        let pair = |first, second| (Correlation { first, second, coefficient: 0.0 }, Some(flat.clone()));
        let space = ParameterSpace {
            variables: (0..3).map(variable).collect(),
            correlations: vec![pair(0, 1), pair(0, 2), pair(1, 2)],
        };
        assert_eq!(space.dimension(), 3);
        let mut rng = ChaCha12Rng::seed_from_u64(4);
        let (total, mut squares) = (20_000, Vec::new());
        for _ in 0..total {
            let v: Vec<f64> = (0..3).map(|_| StandardNormal.sample(&mut rng)).collect();
            if space.laws(&v).is_some() {
                squares.push(space.correlations(&v)[1].coefficient.powi(2));
            }
        }
        let share = squares.len() as f64 / f64::from(total);
        let variance = squares.iter().sum::<f64>() / squares.len() as f64;
        assert!((share - std::f64::consts::PI.powi(2) / 16.0).abs() < 0.014, "{share}");
        assert!((variance - 0.25).abs() < 0.008, "{variance}");
    }
}
