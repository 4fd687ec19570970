//! The family `lives`: problems over 20 to 60 checkpoints, y(n) = n / L(x), whose life L is a variable of a common
//! distribution, a product of several variables, or the lesser of two lives.
//!
//! A product has the scatter of ln L of one of those distributions: with w a random unit vector and s_k the scatter of
//! ln x_k, the exponents are a_k = w_k s / s_k.

use super::course::Course;
use super::draw::{direction, log_uniform, normals, rng_range};
use super::family::Shape;
use super::problem::Class;
use super::response::{Response, Term};
use common::random::Distribution;
use rand::{Rng, RngExt};
use statrs::function::gamma::gamma;
use std::f64::consts::PI;

/// Classes in turn.
pub const TURN: [Class; 12] = [
    Class::Lognormal,
    Class::Weibull,
    Class::Wear,
    Class::Exponential,
    Class::Bimodal,
    Class::Competing,
    Class::Weibull,
    Class::Wear,
    Class::Lognormal,
    Class::Bimodal,
    Class::Wear,
    Class::Competing,
];
/// Coefficients of variation of lognormal lives, and shapes of Weibull ones [1].
const COEFFICIENTS: [f64; 3] = [0.3, 0.7, 1.2];
const SHAPES: [f64; 3] = [0.8, 2.0, 5.0];

/// Distribution of a positive variable but for its mean.
#[derive(Debug, Clone, Copy, PartialEq)]
enum LifeLaw {
    /// Lognormal of this coefficient of variation.
    Lognormal(f64),
    /// Exponential from zero on.
    Exponential,
    /// Weibull of this shape.
    Weibull(f64),
}

impl LifeLaw {
    fn any(rng: &mut impl Rng) -> Self {
        match rng.random_range(0..7) {
            k @ 0..=2 => Self::Lognormal(COEFFICIENTS[k]),
            3 => Self::Exponential,
            k => Self::Weibull(SHAPES[k - 4]),
        }
    }

    /// Coefficient of variation [1].
    fn cov(self) -> f64 {
        match self {
            Self::Lognormal(cov) => cov,
            Self::Exponential => 1.0,
            Self::Weibull(shape) => {
                (gamma(1.0 + 2.0 / shape) / gamma(1.0 + 1.0 / shape).powi(2) - 1.0).sqrt()
            }
        }
    }

    /// Standard deviation of the logarithm [1].
    fn scatter(self) -> f64 {
        match self {
            Self::Lognormal(cov) => cov.powi(2).ln_1p().sqrt(),
            Self::Exponential => PI / 6.0_f64.sqrt(),
            Self::Weibull(shape) => PI / 6.0_f64.sqrt() / shape,
        }
    }

    fn with_mean(self, mean: f64) -> Distribution {
        match self {
            Self::Lognormal(cov) => Distribution::lognormal(mean, cov * mean),
            Self::Exponential => Distribution::exponential_from(0.0, mean),
            Self::Weibull(_) => Distribution::weibull(mean, self.cov() * mean),
        }
        .expect("a mean above zero and a moderate standard deviation")
    }

    /// The logarithm of 1 / L, if variable k is a life of this law and of `mean`.
    fn log_rate(self, variable: usize, mean: f64) -> Term {
        Term::Logarithm { exponent: -1.0, variable, mean, cov: self.cov() }
    }
}

/// A problem of a class of this family.
pub fn shape(rng: &mut impl Rng, class: Class) -> Shape {
    let unit = |rng: &mut _| log_uniform(rng, 1e-3, 1e6);
    let (variables, rates, laws) = match class {
        Class::Lognormal => {
            let law = LifeLaw::Lognormal(COEFFICIENTS[rng.random_range(0..3)]);
            one(rng, law)
        }
        Class::Weibull => {
            let law = LifeLaw::Weibull(SHAPES[rng.random_range(0..3)]);
            one(rng, law)
        }
        Class::Bimodal => bimodal(rng),
        Class::Wear => wear(rng),
        Class::Competing => {
            let (laws, means) = ([LifeLaw::any(rng), LifeLaw::any(rng)], [1.0, rng_range(rng, 0.5, 2.0)]);
            let variables = laws.map(|law| law.with_mean(unit(rng))).to_vec();
            let rates = (0..2).map(|k| vec![laws[k].log_rate(k, means[k])]).collect();
            (variables, rates, (0..2).map(|k| laws[k].with_mean(means[k])).collect())
        }
        _ => one(rng, LifeLaw::Exponential),
    };
    // The life at R = 0.5 mostly lies before the end.
    let wanted = if rng.random_bool(0.8) { rng_range(rng, 0.55, 0.99) } else { rng_range(rng, 0.1, 0.55) };
    Shape {
        variables,
        modes: rates.into_iter().map(Response::Sum).collect(),
        course: Course::Wear { checkpoints: rng.random_range(20..=60), laws },
        wanted,
        centres: vec![],
    }
}

/// Variables, terms of the logarithm of each rate of wear, and distributions of the lives if they are known.
type Drawn = (Vec<Distribution>, Vec<Vec<Term>>, Vec<Distribution>);

/// One variable that is the life.
fn one(rng: &mut impl Rng, law: LifeLaw) -> Drawn {
    let variable = law.with_mean(log_uniform(rng, 1e-3, 1e6));
    (vec![variable], vec![vec![law.log_rate(0, 1.0)]], vec![law.with_mean(1.0)])
}

/// A life that is 2 to 10 times shorter beyond a threshold of a second variable, smoothly over it.
fn bimodal(rng: &mut impl Rng) -> Drawn {
    let law = [LifeLaw::Lognormal(0.3), LifeLaw::Weibull(5.0), LifeLaw::Weibull(2.0)][rng.random_range(0..3)];
    let step = Term::Step {
        height: log_uniform(rng, 2.0, 10.0).ln(),
        direction: vec![0.0, 1.0],
        edge: rng.random_range(0.0..1.5),
        width: rng.random_range(0.1..0.4),
    };
    let mut variables = vec![law.with_mean(log_uniform(rng, 1e-3, 1e6))];
    variables.extend(normals(rng, 1));
    (variables, vec![vec![law.log_rate(0, 1.0), step]], vec![])
}

/// A product of powers of 2 to 12 variables; half of the products are of lognormal variables only, so that L is lognormal.
fn wear(rng: &mut impl Rng) -> Drawn {
    let d = rng.random_range(2..=12);
    let scatter = LifeLaw::any(rng).scatter();
    let is_lognormal = rng.random_bool(0.5);
    let mut factor = |_| {
        if is_lognormal || rng.random_bool(0.5) {
            LifeLaw::Lognormal(rng_range(rng, 0.1, 0.5))
        } else {
            LifeLaw::Weibull(rng_range(rng, 1.5, 6.0))
        }
    };
    let factors: Vec<LifeLaw> = (0..d).map(&mut factor).collect();
    let variables = factors.iter().map(|law| law.with_mean(log_uniform(rng, 1e-3, 1e3))).collect();
    let exponents: Vec<f64> =
        direction(rng, d).iter().zip(&factors).map(|(w, law)| w * scatter / law.scatter()).collect();
    let terms = factors.iter().zip(&exponents).enumerate().map(|(variable, (law, exponent))| {
        Term::Logarithm { exponent: *exponent, variable, mean: 1.0, cov: law.cov() }
    });
    let terms = terms.collect();
    if !is_lognormal {
        return (variables, vec![terms], vec![]);
    }
    // The mean of ln x over that of x is minus half the variance of ln x.
    let median: f64 = factors.iter().zip(&exponents).map(|(law, a)| 0.5 * a * law.scatter().powi(2)).sum();
    let mean = (median + 0.5 * scatter.powi(2)).exp();
    let law = LifeLaw::Lognormal(scatter.powi(2).exp_m1().sqrt());
    (variables, vec![terms], vec![law.with_mean(mean)])
}
