//! Campaigns on a published static case: the series system of four branches.

use super::observations::ObservedOutcome;
use super::{
    Campaign, CampaignError, CampaignResult, ClassifiedPopulation, Observed, Plan, Problem, Settings,
};
use crate::results::summary::Round;
use crate::statistics::design::{InputModel, Population};
use crate::statistics::learning::{Mode, StoppingTargets};
use crate::statistics::reliability::reliability_curve;
use crate::tests::models;
use common::random::{Correlation, Distribution, GaussianCopula, standard_normal_cdf, standard_normal_pdf};

/// The four-branch system with k = 7 as an output that fails at 0.
fn four_branch(x: &[f64]) -> f64 {
    -models::four_branch(x, 7.0)
}

fn learn(population: usize, initial: usize, seed: u64) -> CampaignResult {
    learn_until(population, initial, seed, StoppingTargets::default())
}

fn learn_until(population: usize, initial: usize, seed: u64, targets: StoppingTargets) -> CampaignResult {
    learn_of(four_branch, (population, 400_000), initial, seed, targets)
}

fn learn_of(
    output: fn(&[f64]) -> f64,
    populations: (usize, usize),
    initial: usize,
    seed: u64,
    targets: StoppingTargets,
) -> CampaignResult {
    let normal = Distribution::truncated_normal(0.0, 1.0, -8.0, 8.0).unwrap();
    let inputs = InputModel::from(&vec![normal; 2]);
    learn_from(inputs, output, (0.0, populations), initial, seed, targets)
}

pub(super) fn learn_from(
    inputs: InputModel,
    output: impl Fn(&[f64]) -> f64,
    limits: (f64, (usize, usize)),
    initial: usize,
    seed: u64,
    targets: StoppingTargets,
) -> CampaignResult {
    let simulate = |x: &[f64]| Ok(Observed::exact(vec![vec![output(x)]]));
    learn_by(inputs, simulate, limits, initial, seed, targets).unwrap()
}

/// A campaign with simulations that may fail.
pub(super) fn learn_by(
    inputs: InputModel,
    simulate: impl Fn(&[f64]) -> ObservedOutcome,
    (threshold, (population, largest_population)): (f64, (usize, usize)),
    initial: usize,
    seed: u64,
    targets: StoppingTargets,
) -> Result<CampaignResult, CampaignError> {
    let problem =
        Problem { inputs, outputs: 1, modes: vec![Mode { output: 0, threshold }], checkpoints: vec![1] };
    let settings = Settings {
        samples: population,
        initial,
        batch: 4,
        max_evaluations: 300,
        seed,
        ..Settings::default()
    };
    let plan = Plan { settings, targets, largest_population, retry: false, is_exact: true };
    Campaign::new(problem, plan).learn_from(simulate, |_| {})
}

/// The guards alone: a population that does not grow serves them as well.
fn guards() -> StoppingTargets {
    StoppingTargets { cov: f64::INFINITY, ..StoppingTargets::default() }
}

/// Share of the population that fails in truth, and as classified.
fn shares(learned: &CampaignResult) -> (f64, f64) {
    let n = learned.classified.population.len();
    let truth = (0..n).filter(|j| four_branch(&learned.classified.population.physical(*j)) >= 0.0).count();
    (truth as f64 / n as f64, learned.assessment.curves[0][0])
}

#[test]
fn four_branch_within_three_standard_errors_and_110_calls() {
    let problems = models::published_problems();
    let published = problems.iter().find(|problem| problem.name == "four-branch-7").unwrap().pf;
    let learned = learn(200_000, 12, 1);
    let (truth, found) = shares(&learned);
    let n = learned.classified.population.len() as f64;
    let standard_error = (truth * (1.0 - truth) / n).sqrt();
    eprintln!(
        "N {n}, {} calls, {:?}, truth {truth:.4e}, found {found:.4e}",
        learned.evaluations, learned.stop
    );
    assert!((found - truth).abs() < 3.0 * standard_error, "{found} {truth}");
    // The exact value by quadrature, over the population's own scatter.
    assert!((found - published).abs() < 4.0 * standard_error, "{found}");
    assert!(learned.evaluations <= 110, "{} calls", learned.evaluations);
    assert!(standard_error / truth < 0.05);
}

#[test]
fn issue_false_stop_with_twelve_starting_points() {
    // A surrogate with very long lengths predicts too small variances: U >= 2 everywhere and hardly a failure
    // predicted. Seed 6 is such a case: without the guards it ends after one round, having found next to nothing.
    let unguarded = StoppingTargets { least_points: 0, hold: 1, hold_points: 0, ..guards() };
    let trapped = learn_until(20_000, 12, 6, unguarded);
    let (truth, found) = shares(&trapped);
    assert!(
        trapped.evaluations < 30 && found < 0.2 * truth,
        "the trap of this test is gone: {found} {truth}"
    );
    for seed in [6, 24] {
        let learned = learn_until(20_000, 12, seed, guards());
        let (truth, found) = shares(&learned);
        assert!(learned.evaluations >= 30, "seed {seed}");
        assert!((found / truth - 1.0).abs() < 0.1, "seed {seed}: {found} {truth}");
    }
}

#[test]
fn issue_false_stop_with_a_branch_missing() {
    // No result near the mean shows the two branches beyond the kink: a rule that need not hold, without
    // exploring points, stops with more than a tenth of the failures missing.
    let unguarded = StoppingTargets { hold: 1, hold_points: 0, ..guards() };
    let (truth, found) = shares(&learn_until(100_000, 12, 4, unguarded));
    assert!(found / truth < 0.9, "the trap of this test is gone: {found} {truth}");
    let (truth, found) = shares(&learn_until(100_000, 12, 4, guards()));
    assert!((found / truth - 1.0).abs() < 0.02, "{found} {truth}");
}

#[test]
fn the_population_grows_until_the_coefficient_of_variation_is_met() {
    let targets = StoppingTargets { cov: 0.1, ..StoppingTargets::default() };
    let learned = learn_until(5_000, 30, 5, targets);
    let last = learned.rounds.last().unwrap();
    assert!(
        learned.classified.population.len() > 37_000 && last.cov_pf < 0.1,
        "{} {}",
        learned.classified.population.len(),
        last.cov_pf
    );
    assert!(learned.rounds[0].cov_pf > 0.2);
}

#[test]
fn a_rare_event_is_found_through_conditional_populations() {
    // Two regions, on either side of a saddle: P_f = 2 P(x >= sqrt(25 + y^2)), by quadrature.
    let output = |x: &[f64]| x[0] * x[0] - 25.0 - x[1] * x[1];
    let exact = {
        let (n, h) = (4000, 16.0 / 4000.0);
        let at = |i: usize| {
            let y = -8.0 + h * i as f64;
            let weight = if i == 0 || i == n { 0.5 } else { 1.0 };
            weight * standard_normal_pdf(y) * 2.0 * standard_normal_cdf(-(25.0 + y * y).sqrt())
        };
        (0..=n).map(at).sum::<f64>() * h
    };
    let learned = learn_of(output, (20_000, 50_000), 12, 1, StoppingTargets::default());
    let ClassifiedPopulation { condition, population, .. } = &learned.classified;
    let failed = learned.assessment.governing_failed();
    let pf = condition.probability * failed;
    let cov = condition.coefficient_of_variation(failed, population.len());
    eprintln!("{} calls, {condition:?}, {pf:.4e} of {exact:.4e}, cov {cov:.3}", learned.evaluations);
    assert!(condition.levels >= 5 && cov < 0.1, "{condition:?} {cov}");
    assert!((pf / exact - 1.0).abs() < 3.5 * cov, "{pf} {exact} {cov}");
    assert!(learned.evaluations <= 110, "{} calls", learned.evaluations);
    assert_eq!(learned.classified.unconditional().len(), 20_000);
}

/// The product of two correlated lognormals and a constant is lognormal.
#[test]
fn correlated_lognormals_beside_a_constant_have_their_closed_form() {
    let lognormal = Distribution::lognormal(1.0, 0.2).unwrap();
    let (rho, beta) = (0.5, 2.3);
    let pair = Correlation { first: 0, second: 2, coefficient: rho };
    let variables = vec![lognormal.clone(), Distribution::constant(3.0).unwrap(), lognormal];
    let inputs = InputModel::new(variables, GaussianCopula::new(3, &[pair]).unwrap());
    let zeta2 = 1.04_f64.ln();
    let threshold = 3.0 * (-zeta2 + beta * (2.0 * zeta2 * (1.0 + rho)).sqrt()).exp();
    let product = |x: &[f64]| x.iter().product();
    let learned =
        learn_from(inputs, product, (threshold, (50_000, 50_000)), 12, 4, StoppingTargets::default());
    let (found, exact) = (learned.assessment.curves[0][0], standard_normal_cdf(-beta));
    let standard_error = (exact * (1.0 - exact) / learned.classified.population.len() as f64).sqrt();
    assert!((found - exact).abs() < 4.0 * standard_error, "{found} {exact}");
    assert!(learned.evaluations <= 80, "{} calls", learned.evaluations);
}

/// Settings of a user: a batch of `batch` after an initial design of `initial`.
fn plan(samples: usize, initial: usize, batch: usize, seed: u64) -> Plan {
    let settings = Settings { samples, initial, batch, max_evaluations: 300, seed, ..Settings::default() };
    let targets = settings.targets();
    Plan { settings, targets, largest_population: samples, retry: false, is_exact: true }
}

fn static_problem(inputs: InputModel, threshold: f64) -> Problem {
    Problem { inputs, outputs: 1, modes: vec![Mode { output: 0, threshold }], checkpoints: vec![1] }
}

fn standard_normals(d: usize) -> InputModel {
    InputModel::from(&vec![Distribution::normal(0.0, 1.0).unwrap(); d])
}

#[test]
fn issue_a_corner_without_results_does_not_end_a_study_of_batch_one() {
    // Beyond -1.8 standard deviations, 3.6 % of the population, no simulation gives a result.
    let simulate = |x: &[f64]| {
        if x[0] < -1.8 {
            return Err(common::failure::SimulationFailure::NotModelled { what: "beyond".into() });
        }
        Ok(Observed::exact(vec![vec![x[0] + 0.5 * x[1]]]))
    };
    let (beta, scale) = (2.0, 1.25_f64.sqrt());
    for (batch, seed) in [(1, 1), (2, 2)] {
        let problem = static_problem(standard_normals(2), beta * scale);
        let learned = Campaign::new(problem, plan(20_000, 12, batch, seed)).learn_from(simulate, |_| {});
        let learned = learned.unwrap_or_else(|error| panic!("batch {batch}, seed {seed}: {error}"));
        let (found, exact) = (learned.assessment.curves[0][0], standard_normal_cdf(-beta));
        let n = learned.classified.population.len() as f64;
        assert!((found - exact).abs() < 4.0 * (exact / n).sqrt(), "{batch} {seed}: {found} {exact}");
        assert!(learned.evaluations <= 60, "batch {batch}, seed {seed}: {} calls", learned.evaluations);
    }
}

#[test]
fn issue_an_event_that_is_impossible_ends_with_a_bound() {
    // The sum of two variables between 0 and 1 never reaches 10.
    let inputs = InputModel::from(&vec![Distribution::uniform(0.0, 1.0).unwrap(); 2]);
    let problem = static_problem(inputs, 10.0);
    let simulate = |x: &[f64]| Ok(Observed::exact(vec![vec![x[0] + x[1]]]));
    let learned = Campaign::new(problem, plan(10_000, 12, 4, 1)).learn_from(simulate, |_| {}).unwrap();
    let condition = learned.classified.condition;
    assert!(learned.evaluations <= 110, "{} calls", learned.evaluations);
    assert!(matches!(learned.stop, super::StopReason::Rule(_)), "{:?}", learned.stop);
    assert!(condition.levels > 0 && condition.probability > 1e-9, "{condition:?}");
    let curve = reliability_curve(&learned.assessment.curves[0], 100_000, &[], &condition)[0];
    assert_eq!((curve.reliability, curve.standard_error), (1.0, condition.probability));
}

#[test]
fn issue_a_rare_branch_beyond_a_kink_is_found() {
    // Two half-planes at a right angle and more; the one that matters is nearly flat up to a kink that no
    // population of 100 000 points passes, and the other leads away from it.
    let (beta, other, kink, slope): (f64, f64, f64, f64) = (5.2, 6.4, 4.3, 0.2);
    let response = move |x: &[f64]| {
        let (a, b) = (x[0], -0.5 * x[0] + 0.75_f64.sqrt() * x[1]);
        let broken =
            if b < kink { slope * b / kink } else { slope + (1.0 - slope) * (b - kink) / (beta - kink) };
        (a / other).max(broken)
    };
    let exact = standard_normal_cdf(-beta) + standard_normal_cdf(-other);
    // On the other branch alone P_f would be 1e-10, with a stated error of 6 %.
    let mut plan = plan(20_000, 60, 12, 1);
    plan.largest_population = 100_000;
    let simulate = |x: &[f64]| Ok(Observed::exact(vec![vec![response(x)]]));
    let learned =
        Campaign::new(static_problem(standard_normals(2), 1.0), plan).learn_from(simulate, |_| {}).unwrap();
    let ClassifiedPopulation { condition, population, .. } = &learned.classified;
    let failed = learned.assessment.governing_failed();
    let (pf, cov) =
        (condition.probability * failed, condition.coefficient_of_variation(failed, population.len()));
    eprintln!("{} calls, {pf:.3e} of {exact:.3e}, cov {cov:.3}", learned.evaluations);
    let error = cov.hypot(0.02);
    assert!(cov < 0.05 && (pf / exact - 1.0).abs() < 3.0 * error, "{pf} {exact} {cov}");
}

#[test]
fn issue_samples_are_not_requested_twice() {
    let inputs = standard_normals(3);
    let simulate = |x: &[f64]| x[0] + 2.0 * x[1] + 0.5 * x[2];
    // A population that grows, and a conditional one, whose chains repeat points.
    for (threshold, largest) in [(7.0, 30_000), (9.5, 12_000)] {
        let mut requested = std::collections::HashSet::new();
        let mut plan = plan(5_000, 12, 4, 3);
        plan.largest_population = largest;
        let learned = Campaign::new(static_problem(inputs.clone(), threshold), plan).learn_from(
            |x| {
                let bits: Vec<u64> = x.iter().map(|x| x.to_bits()).collect();
                assert!(requested.insert(bits), "{x:?} was simulated before");
                Ok(Observed::exact(vec![vec![simulate(x)]]))
            },
            |_| {},
        );
        assert!(learned.unwrap().classified.population.len() > 5_000);
    }
}

#[test]
fn failures_that_need_two_conditions_beyond_kinks_are_found() {
    // Both of two variables must exceed 3.2, and neither shows it below 2.2; a straight branch leads elsewhere.
    let (beta, kink, slope, other): (f64, f64, f64, f64) = (3.2, 2.2, 0.2, 6.0);
    let broken = move |x: f64| {
        if x < kink { slope * x / kink } else { slope + (1.0 - slope) * (x - kink) / (beta - kink) }
    };
    let simulate = |x: &[f64]| {
        let response = (x[0] / other).max(broken(x[1]).min(broken(x[2])));
        Ok(Observed::exact(vec![vec![response]]))
    };
    let exact = standard_normal_cdf(-beta).powi(2) + standard_normal_cdf(-other);
    let mut plan = plan(20_000, 12, 4, 2);
    plan.largest_population = 50_000;
    let learned =
        Campaign::new(static_problem(standard_normals(3), 1.0), plan).learn_from(simulate, |_| {}).unwrap();
    let ClassifiedPopulation { condition, population, .. } = &learned.classified;
    let failed = learned.assessment.governing_failed();
    let pf = condition.probability * failed;
    let cov = condition.coefficient_of_variation(failed, population.len()).hypot(0.02);
    eprintln!("{} calls, {pf:.3e} of {exact:.3e}, cov {cov:.3}", learned.evaluations);
    assert!((pf / exact - 1.0).abs() < 3.5 * cov, "{pf} {exact} {cov}");
}

#[test]
fn a_budget_that_ends_a_conditional_study_draws_its_population_once_more() {
    let output = |x: &[f64]| x[0] * x[0] - 25.0 - x[1] * x[1];
    let simulate = |x: &[f64]| Ok(Observed::exact(vec![vec![output(x)]]));
    let ended_at = |budget: usize| {
        let mut plan = plan(20_000, 12, 4, 1);
        plan.settings.max_evaluations = budget;
        let problem = static_problem(standard_normals(2), 0.0);
        Campaign::new(problem, plan).learn_from(simulate, |_| {}).unwrap()
    };
    let is_cut = |learned: &CampaignResult| {
        matches!(learned.stop, super::StopReason::Budget) && learned.classified.condition.levels > 0
    };
    let learned = (64..=128).step_by(8).map(ended_at).find(is_cut).expect("a budget that ends it");
    let [.., before, last] = &learned.rounds[..] else { panic!("{} rounds", learned.rounds.len()) };
    assert_eq!(before.evaluations, last.evaluations);
    // What the last draw changed is part of the error.
    let pf = |round: &Round| 1.0 - round.reliability_total;
    let change = (pf(last) / pf(before) - 1.0).abs();
    eprintln!("{:.3e} to {:.3e}, cov {:.3} to {:.3}", pf(before), pf(last), before.cov_pf, last.cov_pf);
    assert!(change > 0.0 && last.cov_pf >= 0.5 * change, "{change} {}", last.cov_pf);
}

#[test]
fn direct_simulation_agrees_with_the_references() {
    for problem in models::published_problems() {
        let n = if problem.variables.len() > 10 { 20_000 } else { 50_000 };
        let population = Population::draw(&problem.variables, n, 11);
        let fails = |j: &usize| {
            let outputs = (problem.evaluate)(&population.physical(*j));
            assert_eq!((outputs.len(), outputs[0].len()), problem.shape, "{}", problem.name);
            outputs.iter().any(|history| history.iter().any(|y| *y >= 0.0))
        };
        let pf = (0..n).filter(fails).count() as f64 / n as f64;
        let error = (problem.pf / n as f64).sqrt().hypot(problem.pf_error * problem.pf);
        assert!((pf - problem.pf).abs() < 4.0 * error, "{}: {pf} {}", problem.name, problem.pf);
    }
}
