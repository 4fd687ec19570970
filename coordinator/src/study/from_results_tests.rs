//! Campaigns that begin with results, against the learning that gave the results and against the truth.

use super::{Campaign, CampaignResult, Observed, ObservedOutcome, Plan, Problem, Settings, Step};
use crate::statistics::design::InputModel;
use crate::statistics::learning::{Mode, StoppingTargets};
use common::failure::SimulationFailure;
use common::random::{Distribution, standard_normal_cdf};

/// Life of a wearing bar of load x and wear rate w: at checkpoint n the response is x + 0.2 n w + 0.05 x w, failed from 9 on.
fn histories(x: &[f64]) -> Vec<Vec<f64>> {
    vec![(1..=10).map(|n| x[0] + 0.2 * f64::from(n) * x[1] + 0.05 * x[0] * x[1]).collect()]
}

pub(super) fn problem(mean: f64, std: f64) -> Problem {
    let load = Distribution::normal(mean, std).unwrap();
    let rate = Distribution::normal(2.0, 0.4).unwrap();
    let studied = InputModel::from(&[Distribution::normal(5.0, 0.5).unwrap(), rate.clone()]);
    Problem {
        inputs: InputModel::from(&[load, rate]).standardised_as(&studied),
        outputs: 1,
        modes: vec![Mode { output: 0, threshold: 9.0 }],
        checkpoints: (1..=10).collect(),
    }
}

pub(super) fn plan(samples: usize, max_evaluations: usize) -> Plan {
    let settings =
        Settings { samples, initial: 12, batch: 4, max_evaluations, seed: 3, ..Settings::default() };
    let targets = StoppingTargets { cov: f64::INFINITY, ..settings.targets() };
    Plan { settings, targets, largest_population: samples, retry: true, is_exact: true }
}

/// The outcomes of a study, in order.
fn study() -> (Vec<(Vec<f64>, ObservedOutcome)>, CampaignResult) {
    let mut outcomes = Vec::new();
    let simulate = |x: &[f64]| {
        let outcome = Ok(Observed::exact(histories(x)));
        outcomes.push((x.to_vec(), outcome.clone()));
        outcome
    };
    let learned = Campaign::new(problem(5.0, 0.5), plan(20_000, 40)).learn_from(simulate, |_| {}).unwrap();
    (outcomes, learned)
}

fn assessed(problem: Problem, outcomes: &[(Vec<f64>, ObservedOutcome)]) -> CampaignResult {
    let simulate = |_: &[f64]| panic!("no budget is left");
    let campaign = Campaign::with_results(problem, plan(20_000, outcomes.len()), outcomes.to_vec());
    campaign.learn_from(simulate, |_| {}).unwrap()
}

/// R at every checkpoint by quadrature over the wear rate: x fails from (9 - 0.2 n w) / (1 + 0.05 w) on.
fn truth(mean: f64, std: f64) -> Vec<f64> {
    let at = |n: f64| {
        let weight = |k: i32| {
            let w = 2.0 + 0.4 * f64::from(k) * 0.01;
            let density = 0.01 * (-0.5 * (f64::from(k) * 0.01).powi(2)).exp() / std::f64::consts::TAU.sqrt();
            density * standard_normal_cdf(((9.0 - 0.2 * n * w) / (1.0 + 0.05 * w) - mean) / std)
        };
        (-800..=800).map(weight).sum()
    };
    (1..=10).map(|n| at(f64::from(n))).collect()
}

#[test]
fn without_a_change_the_results_give_the_curves_of_their_study() {
    let (outcomes, learned) = study();
    let again = assessed(problem(5.0, 0.5), &outcomes);
    assert_eq!(again.evaluations, outcomes.len());
    for (before, after) in learned.reliability()[1].iter().zip(&again.reliability()[1]) {
        // The same points, so that only the surrogates differ: by the results that exploring confirmed.
        assert!((before.reliability - after.reliability).abs() < 1e-3, "{before:?} {after:?}");
    }
}

#[test]
fn changed_distributions_give_the_true_curves_within_their_errors() {
    let (outcomes, _) = study();
    // The last two populations leave the region of the results, and fail at other checkpoints.
    for (mean, std) in [(5.0, 0.25), (5.0, 1.0), (6.0, 0.5), (4.0, 0.5), (7.0, 0.3)] {
        let found = assessed(problem(mean, std), &outcomes).reliability().swap_remove(1);
        for (n, (found, truth)) in found.iter().zip(truth(mean, std)).enumerate() {
            let bound = 4.0 * found.standard_error + 4.0 / 20_000.0;
            assert!((found.reliability - truth).abs() < bound, "{mean} {std} {n}: {found:?} {truth}");
        }
    }
}

#[test]
fn a_campaign_with_results_and_a_budget_requests_only_the_rest() {
    let (outcomes, _) = study();
    let known = outcomes.len();
    let mut campaign = Campaign::with_results(problem(6.0, 0.5), plan(5000, known + 4), outcomes.clone());
    let mut requested = 0;
    loop {
        match campaign.next_step().unwrap() {
            Step::Evaluate(requests) => {
                requested += requests.len();
                assert!(requests.iter().all(|r| outcomes.iter().all(|(sample, _)| *sample != r.sample)));
                campaign
                    .record(requests.iter().map(|r| Ok(Observed::exact(histories(&r.sample)))).collect())
                    .unwrap();
            }
            Step::Wait => {}
            Step::Done => break,
        }
    }
    assert!(requested <= 4 && campaign.evaluations() == known + requested);
}

#[test]
fn a_failure_that_a_repetition_mended_is_no_failure() {
    let (mut outcomes, _) = study();
    let cause = || SimulationFailure::NotModelled { what: "test".into() };
    let mended = (outcomes[2].0.clone(), Err(cause()));
    let (lost, again) = ((vec![5.0, 2.1], Err(cause())), (vec![5.0, 2.1], Err(cause())));
    outcomes.splice(2..2, [mended, lost, again]);
    let found = assessed(problem(5.0, 0.5), &outcomes);
    assert_eq!((found.failed.len(), found.evaluations), (1, outcomes.len()));
    assert_eq!(found.observations.len(), outcomes.len() - 3);
}

#[test]
fn surrogates_of_one_population_serve_another() {
    let (outcomes, _) = study();
    let fitted = assessed(problem(5.0, 0.5), &outcomes).assessment.surrogates;
    for (mean, std) in [(5.0, 0.5), (5.0, 1.0), (7.0, 0.3)] {
        let campaign =
            Campaign::with_results(problem(mean, std), plan(20_000, outcomes.len()), outcomes.clone());
        let campaign = campaign.with_surrogates(&fitted, false);
        let found = campaign.learn_from(|_| panic!("no budget is left"), |_| {}).unwrap();
        let alone = assessed(problem(mean, std), &outcomes);
        for (a, b) in found.reliability()[1].iter().zip(&alone.reliability()[1]) {
            let bound = a.standard_error.max(b.standard_error);
            assert!((a.reliability - b.reliability).abs() < bound, "{mean} {std}: {a:?} {b:?}");
        }
    }
}
