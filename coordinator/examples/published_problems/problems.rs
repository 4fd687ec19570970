//! Published reliability problems with their reference failure probabilities: models of this example and of the tests of
//! the learner. Failure is g <= 0; the output is -g and fails at 0.
//!
//! References are exact (quadrature), or from direct simulation of 2e7 samples with the relative standard error given.
//!
//! # Source
//! Four-branch system and oscillator: Echard, Gayton, Lemaire (2011). Sum of lognormals: Rackwitz (2001). RP8 to RP111:
//! black-box reliability challenge of TNO, as coded in openturns/otbenchmark. Hat: Schöbi, Sudret, Marelli (2017). Rare events: the parabola of RP22 at a
//! larger distance, and the outside of a circle, whose probability is exp(-r^2 / 2).

use common::random::{Distribution, Extreme};

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
    [of_articles(), of_the_challenge(), of_the_benchmark(), series_systems(), time_variant()].concat()
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

/// Problems as in the benchmark of Moustapha, Marelli and Sudret (2022) beyond those above, and others of the challenge. Its models of structures
/// are not public.
fn of_the_benchmark() -> Vec<PublishedProblem> {
    let gumbel = |mean, std| {
        Distribution::gumbel(mean, std, Extreme::Maxima).expect("a standard deviation above zero")
    };
    let rp14 = vec![
        Distribution::uniform(70.0, 80.0).expect("bounds"),
        normal(39.0, 0.1),
        gumbel(1500.0, 350.0),
        normal(400.0, 0.1),
        normal(250_000.0, 35_000.0),
    ];
    let rp38 = [350.0, 50.8, 3.81, 173.0, 9.38, 33.1, 0.036].map(|mean| normal(mean, 0.1 * mean));
    let rp91 = [(0.07433, 0.005), (0.1, 0.01), (13.0, 60.0), (4751.0, 48.0), (-684.0, 11.0)]
        .map(|(mean, std)| normal(mean, std));
    let exponential = Distribution::exponential_from(0.0, 1.0).expect("a mean above zero");
    vec![
        problem("rp14", rp14, |x| single(shaft(x)), 7.748e-4, 5.7e-3),
        problem(
            "rp28",
            vec![normal(78_064.0, 11_710.0), normal(0.0104, 0.00156)],
            |x| single(x[0] * x[1] - 146.14),
            1.453_155_770e-7,
            0.0,
        ),
        problem("rp38", rp38.to_vec(), |x| single(stress(x)), 8.059e-3, 2.5e-3),
        problem(
            "rp53",
            vec![normal(1.5, 1.0), normal(2.5, 1.0)],
            |x| single((2.5 * x[0]).sin() + 2.0 - (x[0] * x[0] + 4.0) * (x[1] - 1.0) / 20.0),
            3.132_048_569e-2,
            0.0,
        ),
        problem(
            "rp54",
            vec![exponential; 20],
            |x| single(x.iter().sum::<f64>() - 8.951),
            9.906_030_725e-4,
            0.0,
        ),
        problem("rp91", rp91.to_vec(), |x| single(tube(x)), 6.968e-4, 6e-3),
        problem(
            "rp107",
            standard(10),
            |x| single(5.0 * 10.0_f64.sqrt() - x.iter().sum::<f64>()),
            2.866_515_719e-7,
            0.0,
        ),
        problem("rp110", standard(2), |x| single(jumps(x)), 3.195_788_433e-5, 0.0),
        problem("rp111", standard(2), |x| single(12.5 - (x[0] * x[1]).abs()), 8.035_085_965e-7, 0.0),
        problem(
            "hat",
            vec![normal(0.25, 1.0); 2],
            |x| single(20.0 - (x[0] - x[1]).powi(2) - 8.0 * (x[0] + x[1] - 4.0).powi(3)),
            3.865_398_036e-4,
            0.0,
        ),
    ]
}

/// RP14: strength less the stress of a shaft under bending and torsion.
fn shaft(x: &[f64]) -> f64 {
    let moment = ((x[2] * x[3] / 4.0).powi(2) + x[4] * x[4]).sqrt();
    x[0] - 32.0 / (std::f64::consts::PI * x[1].powi(3)) * moment
}

/// RP38: allowed less the present stress.
fn stress(x: &[f64]) -> f64 {
    let [x1, x2, x3, x4, x5, x6, x7] = [x[0], x[1], x[2], x[3], x[4], x[5], x[6]];
    let above = x4 * x4 - 4.0 * x5 * x6 * x7 * x7 + x4 * (x6 + 4.0 * x5 + 2.0 * x6 * x7);
    15.59e4 - x1 * x2.powi(3) / (2.0 * x3.powi(3)) * above / (x4 * x5 * (x4 + x6 + 2.0 * x6 * x7))
}

/// RP91: the least of three limit states of a tube.
fn tube(x: &[f64]) -> f64 {
    let [x1, x2, x3, x4, x5] = [x[0], x[1], x[2], x[3], x[4]];
    let first = 0.847 + 0.96 * x2 + 0.986 * x3 - 0.216 * x4
        + 0.077 * x2 * x2
        + 0.11 * x3 * x3
        + 7.0 / 378.0 * x4 * x4
        - x3 * x2
        - 0.106 * x2 * x4
        - 0.11 * x3 * x4;
    let second = 84_000.0 * x1 / (x3 * x3 + x4 * x4 - x3 * x4 + 3.0 * x5 * x5).sqrt() - 1.0;
    first.min(second).min(84_000.0 * x1 / x4.abs() - 1.0)
}

/// RP110: the lesser of two limit states with jumps.
fn jumps(x: &[f64]) -> f64 {
    let first = if x[0] <= 3.5 { 0.85 - 0.1 * x[0] } else { 4.0 - x[0] };
    first.min(if x[1] <= 2.0 { 2.3 - x[1] } else { 0.5 - 0.1 * x[1] })
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
