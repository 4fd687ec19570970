//! Problems of known optimum.

use common::random::{Distribution, standard_normal_cdf};
use coordinator::analyses::optimise::{DesignProblem, DesignQuantity, QuantityKind, ReliabilityTarget};
use coordinator::analyses::quantity::ShownUnit;
use coordinator::statistics::design::{Stream, open_stream};
use coordinator::statistics::optimisation::CostModel;
use rand::RngExt;

/// The modes' y at a sample; a mode fails where its y >= 0.
pub type ModeMargins = Box<dyn Fn(&[f64]) -> Vec<f64>>;

/// A maker of a problem from a seed, with its name.
pub type NamedProblem = (&'static str, fn(u64) -> Known);

/// A problem with its optimum; failure is y >= 0 for a mode's y.
pub struct Known {
    /// Random variables of the first study `(d,)`.
    pub variables: Vec<Distribution>,
    /// The modes' y at a sample.
    pub margins: ModeMargins,
    /// Number of modes.
    pub modes: usize,
    /// What is to be minimised.
    pub problem: DesignProblem,
    /// Cost of the optimum.
    pub optimum: f64,
    /// Simulations of the first study.
    pub initial: usize,
}

fn normal(mean: f64, std: f64) -> Distribution {
    Distribution::normal(mean, std).expect("a standard deviation above zero")
}

fn quantity(k: usize, kind: QuantityKind, bounds: (f64, f64), cost: CostModel) -> DesignQuantity {
    let word = if kind == QuantityKind::Mean { "mean" } else { "std" };
    DesignQuantity {
        name: format!("x{}.{word}", k + 1),
        variables: vec![k],
        kind,
        lower: bounds.0,
        upper: bounds.1,
        unit: ShownUnit::of(""),
        cost,
        cost_unit: 1.0,
        grades: vec![],
    }
}

fn target(limit_state: Option<usize>, reliability: f64) -> ReliabilityTarget {
    let name = limit_state.map_or("R total".to_owned(), |g| format!("R g{}", g + 1));
    ReliabilityTarget { name, limit_state, checkpoint: 0, cycles: 1, reliability, confidence: None }
}

/// Youn, Choi (2004), A new response surface methodology for reliability-based design optimization, Computers & Structures
/// 82; the optimum by quadrature of the failure probabilities.
pub fn youn_choi() -> Known {
    let margins = |x: &[f64]| {
        let (a, b) = (x[0], x[1]);
        vec![
            1.0 - a * a * b / 20.0,
            1.0 - (a + b - 5.0).powi(2) / 30.0 - (a - b - 12.0).powi(2) / 120.0,
            1.0 - 80.0 / (a * a + 8.0 * b + 5.0),
        ]
    };
    let sum = |k| quantity(k, QuantityKind::Mean, (0.0, 10.0), CostModel::Linear { c0: 0.0, c1: 1.0 });
    Known {
        variables: vec![normal(5.0, 0.3); 2],
        margins: Box::new(margins),
        modes: 3,
        problem: DesignProblem {
            quantities: (0..2).map(sum).collect(),
            targets: (0..3).map(|g| target(Some(g), standard_normal_cdf(3.0))).collect(),
            ..DesignProblem::default()
        },
        optimum: 6.7289,
        initial: 10,
    }
}

/// A linear stack: sum of w_k x_k - 1 >= 0 fails, x_k normal of mean zero, cost sum of c_k / sigma_k^p.
///
/// With sum of w^2 sigma^2 = 1 / beta^2 and Lagrange's condition, sigma_k = K (c_k / w_k^2)^(1 / (p + 2)).
fn stack_of(weights: Vec<f64>, costs: &[f64], power: f64, beta: f64) -> Known {
    let shape: Vec<f64> =
        weights.iter().zip(costs).map(|(w, c)| (c / (w * w)).powf(1.0 / (power + 2.0))).collect();
    let length = weights.iter().zip(&shape).map(|(w, s)| (w * s).powi(2)).sum::<f64>().sqrt();
    let sigma: Vec<f64> = shape.iter().map(|s| s / (beta * length)).collect();
    let optimum = costs.iter().zip(&sigma).map(|(c, s)| c / s.powf(power)).sum();
    // The study's design has equal contributions at twice the variance allowed.
    let share = (2.0 / weights.len() as f64).sqrt() / beta;
    let cost = |k: usize| {
        let model = CostModel::ReciprocalPower { c0: 0.0, c1: costs[k], k: power };
        quantity(k, QuantityKind::Std, (0.2 * sigma[k], 5.0 * sigma[k]), model)
    };
    Known {
        variables: weights.iter().map(|w| normal(0.0, share / w.abs())).collect(),
        modes: 1,
        problem: DesignProblem {
            quantities: (0..weights.len()).map(cost).collect(),
            targets: vec![target(None, standard_normal_cdf(beta))],
            ..DesignProblem::default()
        },
        optimum,
        initial: 12,
        margins: Box::new(move |x| vec![x.iter().zip(&weights).map(|(x, w)| w * x).sum::<f64>() - 1.0]),
    }
}

/// A stack of four lengths with reciprocal costs, R = 0.999.
pub fn stack() -> Known {
    stack_of(vec![1.0, -2.0, 0.5, 1.0], &[1.0, 0.5, 2.0, 1.0], 1.0, 3.090_232_306_167_813)
}

/// A stack of 2 to 6 lengths with weights, costs, power and reliability index drawn from the seed.
pub fn linear(seed: u64) -> Known {
    let mut rng = open_stream(seed, Stream::Rim(286));
    let mut between = |from: f64, to: f64| from + (to - from) * rng.random::<f64>();
    let d = between(2.0, 7.0) as usize;
    let weights: Vec<f64> =
        (0..d).map(|_| between(0.5, 2.0) * if between(0.0, 1.0) < 0.5 { -1.0 } else { 1.0 }).collect();
    let costs: Vec<f64> = (0..d).map(|_| between(0.5, 2.0)).collect();
    let (power, beta) = (between(0.5, 2.0), between(1.5, 4.0));
    stack_of(weights, &costs, power, beta)
}
