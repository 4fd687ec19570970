//! Campaigns on a published static case: the series system of four branches.

use super::{Campaign, Learned, Observed, Plan, Problem, Step};
use crate::design::InputModel;
use crate::learning::{Mode, Targets};
use crate::surrogate::StatedErrors;
use common::random::{Correlation, Distribution, GaussianCopula, standard_normal_cdf};

/// Four-branch system, k = 7, as an output that fails at 0: minus the limit state. Echard, Gayton, Lemaire (2011).
fn four_branch(x: &[f64]) -> f64 {
    let (sum, difference) = ((x[0] + x[1]) / 2.0_f64.sqrt(), x[0] - x[1]);
    let bowl = 3.0 + 0.1 * difference * difference;
    let k = 7.0 / 2.0_f64.sqrt();
    -(bowl - sum).min(bowl + sum).min(difference + k).min(k - difference)
}

fn learn(population: usize, initial: usize, seed: u64) -> Learned {
    learn_until(population, initial, seed, Targets::default())
}

fn learn_until(population: usize, initial: usize, seed: u64, targets: Targets) -> Learned {
    let normal = Distribution::TruncatedNormal { mean: 0.0, std: 1.0, lower: -8.0, upper: 8.0 };
    let problem = Problem {
        inputs: InputModel::from(&[normal; 2]),
        outputs: 1,
        modes: vec![Mode { output: 0, threshold: 0.0 }],
        checkpoints: vec![1],
    };
    let plan = Plan {
        population,
        largest_population: 400_000,
        initial,
        batch: 4,
        max_evaluations: 300,
        seed,
        targets,
        stated_errors: StatedErrors::default(),
    };
    let mut campaign = Campaign::new(problem, plan);
    while let Step::Evaluate(samples) = campaign.next_step().unwrap() {
        campaign
            .tell(samples.iter().map(|x| Ok(Observed::exact(vec![vec![four_branch(x)]]))).collect())
            .unwrap();
    }
    campaign.finish().unwrap()
}

/// Share of the population that fails in truth, and as classified.
fn shares(learned: &Learned) -> (f64, f64) {
    let n = learned.population.len();
    let truth = (0..n).filter(|j| four_branch(&learned.population.physical(*j)) >= 0.0).count();
    (truth as f64 / n as f64, learned.assessment.curves[0][0])
}

#[test]
fn four_branch_within_three_standard_errors_and_110_calls() {
    for seed in [1, 2, 3] {
        let learned = learn(200_000, 12, seed);
        let (truth, found) = shares(&learned);
        let n = learned.population.len() as f64;
        let standard_error = (truth * (1.0 - truth) / n).sqrt();
        eprintln!(
            "seed {seed}: N {n}, {} calls, {:?}, truth {truth:.4e}, found {found:.4e}",
            learned.evaluations, learned.stop
        );
        assert!((found - truth).abs() < 3.0 * standard_error, "seed {seed}: {found} {truth}");
        // The exact value by quadrature, over the population's own scatter.
        assert!((found - 2.222_795e-3).abs() < 4.0 * standard_error, "seed {seed}: {found}");
        assert!(learned.evaluations <= 110, "seed {seed}: {} calls", learned.evaluations);
        assert!(standard_error / truth < 0.05);
    }
}

#[test]
fn issue_false_stop_with_twelve_starting_points() {
    // A surrogate with very long lengths is sure of itself: U >= 2 everywhere and no failure predicted. Seed 26 is such a
    // case: without the guards it ends after one round, having found nothing.
    let unguarded = Targets { least_points: 0, hold: 1, cov: f64::INFINITY, ..Targets::default() };
    let trapped = learn_until(20_000, 12, 26, unguarded);
    assert!(trapped.evaluations < 30 && shares(&trapped).1 == 0.0, "the trap of this test is gone");
    for seed in 24..29 {
        let learned = learn(20_000, 12, seed);
        let (truth, found) = shares(&learned);
        assert!(learned.evaluations >= 30, "seed {seed}");
        assert!((found / truth - 1.0).abs() < 0.1, "seed {seed}: {found} {truth}");
    }
}

#[test]
fn the_population_grows_until_the_coefficient_of_variation_is_met() {
    let learned = learn(20_000, 30, 5);
    let last = learned.rounds.last().unwrap();
    assert!(
        learned.population.len() > 150_000 && last.cov_pf < 0.05,
        "{} {}",
        learned.population.len(),
        last.cov_pf
    );
    assert!(learned.rounds[0].cov_pf > 0.1);
}

/// The product of two correlated lognormals and a constant is lognormal.
#[test]
fn correlated_lognormals_beside_a_constant_have_their_closed_form() {
    let lognormal = Distribution::lognormal(1.0, 0.2).unwrap();
    let (rho, beta) = (0.5, 2.3);
    let pair = Correlation { first: 0, second: 2, coefficient: rho };
    let variables = vec![lognormal, Distribution::constant(3.0).unwrap(), lognormal];
    let inputs = InputModel::new(variables, GaussianCopula::new(3, &[pair]).unwrap());
    let zeta2 = 1.04_f64.ln();
    let threshold = 3.0 * (-zeta2 + beta * (2.0 * zeta2 * (1.0 + rho)).sqrt()).exp();
    let problem =
        Problem { inputs, outputs: 1, modes: vec![Mode { output: 0, threshold }], checkpoints: vec![1] };
    let plan = Plan {
        population: 100_000,
        largest_population: 100_000,
        initial: 12,
        batch: 4,
        max_evaluations: 100,
        seed: 4,
        targets: Targets::default(),
        stated_errors: StatedErrors::default(),
    };
    let mut campaign = Campaign::new(problem, plan);
    while let Step::Evaluate(samples) = campaign.next_step().unwrap() {
        let product = |x: &Vec<f64>| Ok(Observed::exact(vec![vec![x.iter().product()]]));
        campaign.tell(samples.iter().map(product).collect()).unwrap();
    }
    let learned = campaign.finish().unwrap();
    let (found, exact) = (learned.assessment.curves[0][0], standard_normal_cdf(-beta));
    let standard_error = (exact * (1.0 - exact) / learned.population.len() as f64).sqrt();
    assert!((found - exact).abs() < 4.0 * standard_error, "{found} {exact}");
    assert!(learned.evaluations <= 80, "{} calls", learned.evaluations);
}
