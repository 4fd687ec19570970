//! Published reliability problems with their reference failure probabilities: models of this example and of the tests of
//! the learner. Failure is g <= 0; the output is -g and fails at 0.
//!
//! References are exact (quadrature), or from direct simulation of 2e7 samples with the relative standard error given.
//!
//! # Source
//! Four-branch system and oscillator: Echard, Gayton, Lemaire (2011). Sum of lognormals: Rackwitz (2001). RP8 to RP89:
//! black-box reliability challenge of TNO, as coded in openturns/otbenchmark. Rare events: the parabola of RP22 at a
//! larger distance, and the outside of a circle, whose probability is exp(-r^2 / 2).

use common::random::Distribution;

/// A published problem with its reference value.
#[derive(Debug, Clone)]
pub struct PublishedProblem {
    /// Name of the problem.
    pub name: &'static str,
    /// Random variables `(d,)`.
    pub variables: Vec<Distribution>,
    /// Limit states, each its outputs -g over the checkpoints `(modes)(m,)`.
    pub evaluate: fn(&[f64]) -> Vec<Vec<f64>>,
    /// Number of limit states, and of checkpoints m.
    pub shape: (usize, usize),
    /// Failure probability of the system at the last checkpoint.
    pub pf: f64,
    /// Relative standard error of that [1]; zero: exact to the digits given.
    pub pf_error: f64,
    /// Evaluations of the initial design.
    pub initial: usize,
    /// Budget of evaluations.
    pub max_evaluations: usize,
}

fn normal(mean: f64, std: f64) -> Distribution {
    Distribution::normal(mean, std).expect("a standard deviation above zero")
}

fn lognormal(mean: f64, std: f64) -> Distribution {
    Distribution::lognormal(mean, std).expect("a mean above zero")
}

fn standard(d: usize) -> Vec<Distribution> {
    vec![normal(0.0, 1.0); d]
}

/// A static problem of one limit state g.
fn single(g: f64) -> Vec<Vec<f64>> {
    vec![vec![-g]]
}

/// A series system of several.
fn series<const N: usize>(g: [f64; N]) -> Vec<Vec<f64>> {
    g.map(|g| vec![-g]).to_vec()
}

/// The four-branch system with the constant `k`.
pub fn four_branch(x: &[f64], k: f64) -> f64 {
    let (sum, difference) = ((x[0] + x[1]) / 2.0_f64.sqrt(), x[0] - x[1]);
    let bowl = 3.0 + 0.1 * difference * difference;
    (bowl - sum).min(bowl + sum).min(difference + k / 2.0_f64.sqrt()).min(k / 2.0_f64.sqrt() - difference)
}

fn parabola(x: &[f64], distance: f64) -> f64 {
    distance - (x[0] + x[1]) / 2.0_f64.sqrt() + 0.1 * (x[0] - x[1]).powi(2)
}

fn oscillator(x: &[f64]) -> f64 {
    let [m, c1, c2, r, f1, t1] = [x[0], x[1], x[2], x[3], x[4], x[5]];
    let w0 = ((c1 + c2) / m).sqrt();
    3.0 * r - (2.0 * f1 / (m * w0 * w0) * (w0 * t1 / 2.0).sin()).abs()
}

/// Standard deviation of the summands of the sum of lognormals, of mean 1.
const SUMMAND: f64 = 0.2;

fn sum_of_lognormals(x: &[f64]) -> f64 {
    let n = x.len() as f64;
    n + 3.0 * SUMMAND * n.sqrt() - x.iter().sum::<f64>()
}

/// Checkpoints of the time-variant problem.
const TIMES: usize = 50;

/// Least limit state over [0, t] at the checkpoints t = 0.1, 0.2, ..., 5: exact, the limit state being a parabola.
fn over_time(x: &[f64]) -> Vec<f64> {
    let g = |t: f64| x[0] * x[0] * x[1] - 5.0 * x[0] * t + (x[1] + 1.0) * t * t - 20.0;
    let lowest = 5.0 * x[0] / (2.0 * (x[1] + 1.0));
    (1..=TIMES)
        .map(|i| {
            let t = 5.0 * i as f64 / TIMES as f64;
            -g(0.0).min(g(t)).min(if lowest > 0.0 && lowest < t { g(lowest) } else { f64::INFINITY })
        })
        .collect()
}

/// A problem of one limit state at one checkpoint.
fn problem(
    name: &'static str,
    variables: Vec<Distribution>,
    evaluate: fn(&[f64]) -> Vec<Vec<f64>>,
    pf: f64,
    pf_error: f64,
) -> PublishedProblem {
    let d = variables.len();
    let initial = if d <= 6 { 12 } else { (3 * d / 2).max(30) };
    let max_evaluations = if d > 50 { 400 } else { 300 };
    PublishedProblem { name, variables, evaluate, shape: (1, 1), pf, pf_error, initial, max_evaluations }
}

/// A series system of `modes` limit states.
fn system(modes: usize, problem: PublishedProblem) -> PublishedProblem {
    PublishedProblem { shape: (modes, 1), ..problem }
}

/// All published problems.
pub fn published_problems() -> Vec<PublishedProblem> {
    [of_articles(), of_the_challenge(), series_systems(), time_variant()].concat()
}

/// Four-branch systems, oscillator and sums of lognormals.
fn of_articles() -> Vec<PublishedProblem> {
    let lognormals = |n| vec![lognormal(1.0, SUMMAND); n];
    let oscillator_inputs = [(1.0, 0.05), (1.0, 0.1), (0.1, 0.01), (0.5, 0.05), (1.0, 0.2), (1.0, 0.2)];
    vec![
        problem("four-branch-6", standard(2), |x| single(four_branch(x, 6.0)), 4.457_331_490_6e-3, 0.0),
        problem("four-branch-7", standard(2), |x| single(four_branch(x, 7.0)), 2.222_795_066_2e-3, 0.0),
        problem(
            "oscillator",
            oscillator_inputs.map(|(mean, std)| normal(mean, std)).to_vec(),
            |x| single(oscillator(x)),
            2.8606e-2,
            1.3e-3,
        ),
        problem("lognormals-40", lognormals(40), |x| single(sum_of_lognormals(x)), 1.972e-3, 5e-3),
        problem("lognormals-100", lognormals(100), |x| single(sum_of_lognormals(x)), 1.698e-3, 7e-3),
    ]
}

/// Single limit states of the black-box challenge, and rare events.
fn of_the_challenge() -> Vec<PublishedProblem> {
    let rp8 = [(120.0, 12.0); 4].into_iter().chain([(50.0, 10.0), (40.0, 8.0)]);
    vec![
        problem(
            "rp8",
            rp8.map(|(mean, std)| lognormal(mean, std)).collect(),
            |x| single(x[0] + 2.0 * x[1] + 2.0 * x[2] + x[3] - 5.0 * x[4] - 5.0 * x[5]),
            7.90e-4,
            6.4e-3,
        ),
        problem("rp22", standard(2), |x| single(parabola(x, 2.5)), 4.207_305_51e-3, 0.0),
        problem("parabola-8", standard(2), |x| single(parabola(x, 5.4)), 1.844_038_200e-8, 0.0),
        problem("parabola-9", standard(2), |x| single(parabola(x, 5.8)), 1.793_156_133e-9, 0.0),
        problem(
            "circle-9",
            standard(2),
            |x| single(2.0 * 1e9_f64.ln() - x[0] * x[0] - x[1] * x[1]),
            1e-9,
            0.0,
        ),
        problem(
            "rp24",
            vec![normal(10.0, 3.0); 2],
            |x| single(2.5 - 0.2357 * (x[0] - x[1]) + 0.00463 * (x[0] + x[1] - 20.0).powi(4)),
            2.86e-3,
            2e-3,
        ),
        problem("rp31", standard(2), |x| single(2.0 - x[1] + 256.0 * x[0].powi(4)), 3.226_68e-3, 0.0),
        problem(
            "rp63",
            standard(100),
            |x| single(0.1 * x[1..].iter().map(|x| x * x).sum::<f64>() - x[0] - 4.5),
            3.769e-4,
            0.0,
        ),
        problem("rp75", standard(2), |x| single(3.0 - x[0] * x[1]), 9.8193e-3, 0.0),
        problem(
            "rp25",
            standard(2),
            |x| single((x[0] * x[0] - 8.0 * x[1] + 16.0).max(-16.0 * x[0] + x[1] + 32.0)),
            4.148_57e-5,
            0.0,
        ),
    ]
}

/// Series systems of the black-box challenge.
fn series_systems() -> Vec<PublishedProblem> {
    vec![
        system(
            2,
            problem(
                "rp33",
                standard(3),
                |x| series([3.0 * 3.0_f64.sqrt() - x[0] - x[1] - x[2], 3.0 - x[2]]),
                2.575_60e-3,
                0.0,
            ),
        ),
        system(
            2,
            problem(
                "rp35",
                standard(2),
                |x| {
                    let curved = 2.0 - x[1] + (-0.1 * x[0] * x[0]).exp() + (0.2 * x[0]).powi(4);
                    series([curved, 4.5 - x[0] * x[1]])
                },
                3.478_946_32e-3,
                0.0,
            ),
        ),
        system(
            2,
            problem(
                "rp89",
                standard(2),
                |x| series([8.0 - x[0] * x[0] - x[1], 6.0 - x[0] / 5.0 - x[1]]),
                5.43e-3,
                2e-3,
            ),
        ),
    ]
}

/// Problems over 50 checkpoints.
fn time_variant() -> Vec<PublishedProblem> {
    vec![
        PublishedProblem {
            shape: (1, TIMES),
            ..problem("time-variant", vec![normal(3.5, 0.25); 2], |x| vec![over_time(x)], 1.364e-1, 2e-3)
        },
        PublishedProblem {
            shape: (1, TIMES),
            ..problem("time-variant-3", vec![normal(3.5, 0.3); 2], |x| vec![over_time(x)], 1.847e-1, 2e-3)
        },
    ]
}
