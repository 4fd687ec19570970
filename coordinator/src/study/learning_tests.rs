//! What learning has to find: early lives of lifetimes that scatter widely, regions of failures between the simulations, and
//! the published method beside it.

use super::{Campaign, CampaignResult, Method, Observed, Plan, Problem, Settings};
use crate::statistics::design::InputModel;
use crate::statistics::learning::{LearningFunction, Mode, StoppingTargets};
use common::random::{Distribution, standard_normal_cdf};

/// Learns responses of `modes` limit states that fail at 1.
fn learn(
    inputs: InputModel,
    modes: usize,
    checkpoints: Vec<u32>,
    settings: Settings,
    simulate: impl Fn(&[f64]) -> Vec<Vec<f64>>,
) -> CampaignResult {
    let modes: Vec<Mode> = (0..modes).map(|output| Mode { output, threshold: 1.0 }).collect();
    let problem = Problem { inputs, outputs: modes.len(), modes, checkpoints };
    let plan = Plan {
        targets: StoppingTargets::default(),
        largest_population: 400_000,
        retry: false,
        is_exact: true,
        settings,
    };
    let simulated = |x: &[f64]| Ok(Observed::exact(simulate(x)));
    Campaign::new(problem, plan).learn_from(simulated, |_| {}).unwrap()
}

fn settings(variables: usize, seed: u64) -> Settings {
    Settings { seed, max_evaluations: 300, ..Settings::for_variables(variables) }
}

/// R(n) of the system with 1.96 standard errors.
fn interval(learned: &CampaignResult, n: usize) -> (f64, f64) {
    let point = learned.reliability().last().unwrap()[n];
    (point.reliability, 1.96 * point.standard_error)
}

#[test]
fn issue_early_lives_of_a_wide_lifetime_were_stated_wrongly() {
    // y = n / L with L lognormal: no simulation lay where early failures happen, and R(200) was 0.99946 +- 0.00032 for 0.98722.
    let (mean, std) = (1000.0, 700.0_f64);
    let sigma = (1.0 + (std / mean).powi(2)).ln().sqrt();
    let median = mean * (-0.5 * sigma * sigma).exp();
    let checkpoints: Vec<u32> = (1..=40).map(|k| 50 * k).collect();
    let inputs = InputModel::from(&[Distribution::lognormal(mean, std).unwrap()]);
    let response = |x: &[f64]| vec![checkpoints.iter().map(|n| f64::from(*n) / x[0]).collect()];
    let learned = learn(inputs, 1, checkpoints.clone(), settings(1, 1), response);
    assert!(learned.evaluations <= 60, "{} calls", learned.evaluations);
    for (n, cycles) in checkpoints.iter().enumerate() {
        let exact = 1.0 - standard_normal_cdf((f64::from(*cycles) / median).ln() / sigma);
        let (found, half_width) = interval(&learned, n);
        // Four standard errors of the population besides.
        let scatter = 4.0 * (exact * (1.0 - exact) / 1e5).sqrt();
        assert!((found - exact).abs() < 2.0 * half_width + scatter, "R({cycles}) {found} {exact}");
        if cycles == &200 {
            assert!(((1.0 - found) / (1.0 - exact) - 1.0).abs() < 0.1, "{found} {exact}");
        }
    }
}

#[test]
fn issue_an_exploring_point_of_one_variable_had_no_value() {
    // The rim of one variable has two points; R is 1 and then 0.
    let inputs = InputModel::from(&[Distribution::normal(5.0, 0.25).unwrap()]);
    let learned = learn(inputs, 1, vec![1, 2, 3, 4], settings(1, 1), |x: &[f64]| {
        assert_eq!(x.len(), 1);
        vec![(1..=4).map(|n| 0.3 * f64::from(n) * (1.0 + 0.001 * x[0])).collect()]
    });
    let total = learned.reliability().pop().unwrap();
    let found: Vec<f64> = total.iter().map(|point| point.reliability).collect();
    assert!(found[2] > 0.999 && found[3] < 0.001, "{found:?}");
}

#[test]
fn issue_a_region_in_the_bulk_was_not_seen() {
    // A bump of 0.5 standard deviations at (1.1, -0.6), beside a limit far out.
    let response = |x: &[f64]| {
        let bump = (-((x[0] - 1.1).powi(2) + (x[1] + 0.6).powi(2)) / (2.0 * 0.25)).exp();
        vec![vec![0.35 * (x[0] + x[1]) / 2.0_f64.sqrt() + 1.1 * bump]]
    };
    let normal = Distribution::normal(0.0, 1.0).unwrap();
    let inputs = InputModel::from(&vec![normal; 2]);
    let learned = learn(inputs, 1, vec![1], settings(2, 1), response);
    let population = &learned.classified.population;
    let failed = (0..population.len()).filter(|j| response(&population.physical(*j))[0][0] >= 1.0).count();
    let truth = failed as f64 / population.len() as f64;
    let (found, half_width) = interval(&learned, 0);
    assert!(
        (1.0 - found - truth).abs() < 2.0 * half_width,
        "{} +- {half_width} for {truth}, {} calls",
        1.0 - found,
        learned.evaluations
    );
}

#[test]
fn issue_a_rare_failure_was_looked_for_at_the_rim_alone() {
    // A limit at six standard deviations: what fails in the bulk would be a hundred thousand times as probable.
    let normal = Distribution::normal(0.0, 1.0).unwrap();
    let inputs = InputModel::from(&vec![normal; 2]);
    let response = |x: &[f64]| vec![vec![(x[0] + x[1]) / 2.0_f64.sqrt() / 6.0]];
    let learned = learn(inputs, 1, vec![1], settings(2, 1), response);
    let known = learned.observations.standardised().chain(learned.explored.iter().map(Vec::as_slice));
    let near = known.filter(|z| z.iter().map(|z| z * z).sum::<f64>() < 6.0).count();
    let (initial, gap) = (settings(2, 1).initial, learned.largest_gap());
    assert!(near >= initial + 15 && gap < 0.15, "{near} of {} calls, {gap}", learned.evaluations);
    assert!(learned.classified.is_conditional() && learned.evaluations <= 150, "{}", learned.evaluations);
}

#[test]
fn the_published_method_has_a_design_of_its_own_for_each_limit_state() {
    // Two competing linear growths; a population that grows by the published rule.
    let checkpoints: Vec<u32> = (1..=6).map(|k| 1000 * k).collect();
    let response = |x: &[f64]| {
        let growth = |rate: f64| checkpoints.iter().map(|n| rate * f64::from(*n) / 6000.0).collect();
        vec![growth(0.9 + 0.08 * x[0] + 0.02 * x[1] * x[1]), growth(0.85 + 0.1 * x[1])]
    };
    let normal = Distribution::normal(0.0, 1.0).unwrap();
    for learning in [LearningFunction::U, LearningFunction::Coupled] {
        let mut settings = Settings { method: Method::AkMcs, seed: 3, ..Settings::for_variables(2) };
        settings.make_as_published();
        (settings.initial, settings.samples, settings.learning) = (12, 20_000, learning);
        let inputs = InputModel::from(&vec![normal.clone(); 2]);
        let learned = learn(inputs, 2, checkpoints.clone(), settings, response);
        let sizes = [0, 1].map(|mode| learned.observations.design_of(mode).len());
        let all = learned.observations.len();
        match learning {
            // Every further point is in one design.
            LearningFunction::U => {
                assert!(sizes[0] + sizes[1] == all + 12 && sizes.iter().all(|n| *n < all), "{sizes:?} {all}")
            }
            _ => assert_eq!(sizes, [all; 2]),
        }
        assert!(
            learned.evaluations < 80 && learned.assessment.surrogates.iter().all(|s| s.inflation() == 1.0)
        );
        // Failures are counted by the means.
        let modes = &learned.assessment.modes;
        let (n, grid) = (learned.assessment.governing, &learned.assessment.grid);
        let place = grid.iter().position(|k| *k == n).unwrap();
        let by_mean = |j: &usize| modes.iter().any(|mode| mode.means_of(*j)[place] >= mode.threshold);
        let points = learned.classified.population.len();
        let counted = (0..points).filter(by_mean).count() as f64 / points as f64;
        assert_eq!(learned.assessment.governing_failed(), counted);
        let truth = (0..points).filter(|j| {
            response(&learned.classified.population.physical(*j))
                .iter()
                .any(|history: &Vec<f64>| history[n] >= 1.0)
        });
        assert!((truth.count() as f64 / points as f64 - counted).abs() < 0.003);
    }
}
