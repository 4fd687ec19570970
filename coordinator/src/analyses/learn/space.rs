//! Unknown parameters of a study's population with their priors, and the distributions of the points by which they are tried.

use crate::analyses::scene_settings::correlation_of;
use crate::analyses::update::{
    Moment, Observable, Observation, ObservedUnit, Quantity, UnknownParameter, WIDE,
};
use crate::statistics::design::{InputModel, Population};
use crate::statistics::updating::{ParameterPrior, ParameterSpace, UncertainVariable, is_positive_family};
use crate::study::LifeModel;
use common::random::{Correlation, Distribution, RandomVariable};
use common::scene::Scene;
use std::collections::BTreeSet;

/// Spread by which a value that all units share is represented [range of the design variable].
const KERNEL: f64 = 0.02;
/// Spread of the points over that of the population they are made for [1].
const WIDER: f64 = 1.5;
/// Largest ratio of standard deviation and mean of the points of a positive variable [1].
const MOST_SCATTER: f64 = 5.0;
/// Points from which the most influential variable is found.
const SCREENED: usize = 2000;

/// The scene of a study whose random variables have the distributions and correlations of `present`, by name, and the indices of its
/// design variables, which `present` does not have, or as constants: over all designs they correlate with variables that follow them.
pub fn scene_of_units(studied: &Scene, present: &Scene) -> (Scene, Vec<usize>) {
    let (mut scene, mut designs) = (studied.clone(), vec![]);
    for (k, variable) in scene.variables.iter_mut().enumerate() {
        let is_own = |own: &&RandomVariable| {
            let is_varying = !own.distribution.is_constant() || variable.distribution.is_constant();
            own.name == variable.name && is_varying
        };
        match present.variables.iter().find(is_own) {
            Some(own) => variable.distribution = own.distribution.clone(),
            None => designs.push(k),
        }
    }
    let place = |k: usize| studied.variables.iter().position(|own| own.name == present.variables[k].name);
    let moved =
        |c: &Correlation| Some(Correlation { first: place(c.first)?, second: place(c.second)?, ..*c });
    scene.correlations = present.correlations.iter().filter_map(moved).collect();
    (scene, designs)
}

/// Gives the design variables `designs` that are not among the `unknown` parameters of a file the value that `present` has; those that
/// remain unknown, all of them where the file names nothing.
pub fn hold_known(
    scene: &mut Scene,
    present: &Scene,
    designs: &[usize],
    unknown: &[UnknownParameter],
) -> Vec<usize> {
    let is_unknown = |k: &&usize| unknown.is_empty() || unknown.iter().any(|own| own.variable == **k);
    let (unknown, known): (Vec<&usize>, Vec<&usize>) = designs.iter().partition(is_unknown);
    for k in known {
        let variable = &mut scene.variables[*k];
        let own = present.variables.iter().find(|own| own.name == variable.name);
        own.into_iter().for_each(|own| variable.distribution = own.distribution.clone());
    }
    unknown.into_iter().copied().collect()
}

/// What is not known where a file names nothing: the parameters of the variables that were measured and, if lives or outputs were
/// observed, those of the variable with the most influence on the life; the design variables in any case.
pub fn default_unknown(
    model: &LifeModel,
    units: &[ObservedUnit],
    designs: &[usize],
) -> Vec<UnknownParameter> {
    // The variable of an observation; none of a life or an output.
    let variable = |o: &Observation| match o.quantity {
        Quantity::Measured { of: Observable::Variable(k), .. } => Some(k),
        _ => None,
    };
    let observed = units.iter().flat_map(|unit| &unit.observations).map(variable);
    let influential = || most_influential(model, designs);
    let variables: BTreeSet<usize> = observed.clone().flatten().collect();
    let of_life = observed.clone().any(|variable| variable.is_none()).then(influential).flatten();
    let variables: BTreeSet<usize> = variables.into_iter().chain(of_life).collect();
    let is_unknown = |k: &usize| !designs.contains(k) && is_learnable(&model.inputs, *k);
    let of = |variable: usize, moment| UnknownParameter { variable, moment, prior: None };
    let both = |k: usize| {
        let is_exponential = matches!(model.inputs.variables()[k], Distribution::Exponential(_));
        let moments = if is_exponential { &[Moment::Mean][..] } else { &[Moment::Mean, Moment::Std] };
        moments.iter().map(move |moment| of(k, *moment)).collect::<Vec<_>>()
    };
    let shared = designs.iter().map(|k| of(*k, Moment::Mean));
    variables.into_iter().filter(is_unknown).flat_map(both).chain(shared).collect()
}

fn is_learnable(inputs: &InputModel, k: usize) -> bool {
    use Distribution as D;
    let law = &inputs.variables()[k];
    !law.is_constant() && !matches!(law, D::Beta(_) | D::Triangular(_) | D::Empirical(_))
}

/// The learnable variable whose standard normal has the largest correlation with the life, cut at the end of the study.
fn most_influential(model: &LifeModel, designs: &[usize]) -> Option<usize> {
    let (inputs, width) = (&model.inputs, model.deviations());
    let population = Population::draw(inputs, SCREENED, 1);
    let responses = model.respond(population.columns(0..SCREENED), &vec![0.0; SCREENED * width], &[]);
    let life = |own: &[f64]| own.iter().copied().fold(2.0 * model.end(), f64::min);
    let lives: Vec<f64> = responses.lives.chunks_exact(model.limit_states()).map(life).collect();
    let mean = lives.iter().sum::<f64>() / SCREENED as f64;
    let correlation = |k: &usize| {
        let normal = |x: f64| inputs.variables()[*k].to_standard_normal(x).clamp(-8.0, 8.0);
        let product = |j: usize| normal(population.physical_value(j, *k)) * (lives[j] - mean);
        (0..SCREENED).map(product).sum::<f64>().abs()
    };
    let candidates = (0..inputs.dimension()).filter(|k| !designs.contains(k) && is_learnable(inputs, *k));
    candidates.max_by(|a, b| correlation(a).total_cmp(&correlation(b)))
}

/// The unknown parameters as a space with priors; it has all variables that are correlated with one of it.
pub fn space_of(
    inputs: &InputModel,
    scene: &Scene,
    unknown: &[UnknownParameter],
    designs: &[usize],
    fixed: &[[bool; 2]],
) -> ParameterSpace {
    let other = |u: &UnknownParameter| match u.moment {
        Moment::CorrelationWith(other) => Some(other),
        _ => None,
    };
    let mut indices: BTreeSet<usize> =
        unknown.iter().flat_map(|u| std::iter::once(u.variable).chain(other(u))).collect();
    let touches = |indices: &BTreeSet<usize>, c: &Correlation| {
        indices.contains(&c.first) != indices.contains(&c.second)
    };
    while let Some(c) = scene.correlations.iter().find(|c| touches(&indices, c)) {
        indices.extend([c.first, c.second]);
    }
    let given = |index: usize, moment: Moment| {
        unknown.iter().find(|u| (u.variable, u.moment) == (index, moment)).map(|own| own.prior)
    };
    let variable = |index: &usize| {
        let index = *index;
        let law = &inputs.variables()[index];
        let is_shared = designs.contains(&index);
        let prior = |moment: Moment| {
            let own = given(index, moment)?;
            Some(if is_shared { bounded_prior(law.support(), own) } else { prior_of(law, moment, own) })
        };
        let (mean, std) = (prior(Moment::Mean), prior(Moment::Std));
        let (lower, upper) = law.support();
        let (middle, width) = (0.5 * (lower + upper), KERNEL * (upper - lower));
        let kernel = || Distribution::truncated_normal(middle, width, lower, upper);
        let law = if is_shared { kernel().expect("the middle lies within") } else { law.clone() };
        let fixed = if is_shared { [true; 2] } else { fixed.get(index).copied().unwrap_or_default() };
        UncertainVariable { index, law, fixed, mean, std }
    };
    let variables: Vec<UncertainVariable> = indices.iter().map(variable).collect();
    let pair = |(first, second): (usize, usize)| {
        let (i, k) = (variables[first].index, variables[second].index);
        let prior = given(i, Moment::CorrelationWith(k)).map(|own| bounded_prior((-1.0, 1.0), own));
        let coefficient = correlation_of(scene, i, k);
        (prior.is_some() || coefficient != 0.0).then_some((Correlation { first, second, coefficient }, prior))
    };
    let pairs = (0..variables.len()).flat_map(|k| (0..k).map(move |i| (i, k)));
    ParameterSpace { correlations: pairs.filter_map(pair).collect(), variables }
}

/// The prior within a range of a correlation or of a value that all units share; without a given one it is uniform.
fn bounded_prior((lower, upper): (f64, f64), given: Option<(f64, f64)>) -> ParameterPrior {
    let inset = 1e-6 * (upper - lower);
    let law = match given {
        None => Distribution::uniform(lower + inset, upper - inset),
        Some((value, error)) => Distribution::truncated_normal(value, error, lower + inset, upper - inset),
    };
    ParameterPrior { law: law.expect("checked when the file was read"), of_logarithm: false }
}

fn prior_of(law: &Distribution, moment: Moment, given: Option<(f64, f64)>) -> ParameterPrior {
    let (mean, std) = (law.parent_mean(), law.given_std());
    let of_logarithm = moment == Moment::Std || is_positive_family(law);
    let prior = match (given, moment) {
        // The given value is the median where the logarithm is normal.
        (Some((value, error)), _) if of_logarithm => Distribution::normal(value.ln(), error / value),
        (Some((value, error)), _) => Distribution::normal(value, error),
        (None, Moment::Std) => Distribution::uniform((std / WIDE).ln(), (std * WIDE).ln()),
        (None, _) if of_logarithm => {
            let reach = (WIDE * std / mean).max(0.5);
            Distribution::uniform(mean.ln() - reach, mean.ln() + reach)
        }
        (None, _) => Distribution::uniform(mean - WIDE * std, mean + WIDE * std),
    };
    ParameterPrior { law: prior.expect("a finite prior with a positive width"), of_logarithm }
}

/// Mean and standard deviation of one more unit over weighted sets, each `(weight, [mean, std])`.
pub fn moments_of(sets: &[(f64, [f64; 2])]) -> [f64; 2] {
    let total: f64 = sets.iter().map(|(w, _)| w).sum();
    let mean = sets.iter().map(|(w, [m, _])| w * m).sum::<f64>() / total;
    let variance = sets.iter().map(|(w, [m, s])| w * ((m - mean).powi(2) + s * s)).sum::<f64>() / total;
    [mean, variance.sqrt()]
}

/// The distribution of the points of a variable whose moments are those of weighted sets, each `(weight, [mean, std])`.
/// `shared` is the range of a value that all units share.
pub fn proposal(law: &Distribution, shared: Option<(f64, f64)>, sets: &[(f64, [f64; 2])]) -> Distribution {
    let [mean, std] = moments_of(sets);
    let std = WIDER * std;
    if let Some((lower, upper)) = shared {
        let range = Distribution::uniform((mean - 3.0 * std).max(lower), (mean + 3.0 * std).min(upper));
        return range.expect("a range around a value within it");
    }
    let lower = law.support().0;
    let scatter = std.min(MOST_SCATTER * mean.abs());
    let made = match law {
        Distribution::Exponential(_) => Distribution::exponential_from(lower, lower + WIDER * (mean - lower)),
        Distribution::Weibull(_) => Distribution::weibull(mean, scatter),
        Distribution::Gumbel(_) => crate::statistics::design::with_moments(law, mean, std, [false; 2]),
        _ if lower >= 0.0 && mean > 0.0 => Distribution::lognormal(mean, scatter),
        _ => Distribution::normal(mean, std),
    };
    made.unwrap_or_else(|_| law.clone())
}
