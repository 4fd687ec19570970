//! Whole studies of a made-up two-mode life in 30 variables, through the interfaces of scene, evaluator and journal.

use super::{Method, Settings, StudyError, StudyResult, run};
use crate::farm::evaluate::{Demand, EvaluateError, Evaluator, Finished, Request, RequestSource};
use crate::results::journal::InMemoryJournal;
use crate::results::progress::Silent;
use crate::statistics::design::Population;
use common::accuracy::NamedAccuracy;
use common::failure::SimulationFailure;
use common::outputs::Evaluation;
use common::random::{Distribution, RandomVariable};
use common::scene::{
    Fails, Life, LimitState, Output, OutputKind, Scene, SignedBody, StudySettings, WearModel,
};
use std::collections::VecDeque;
use std::sync::LazyLock;

const D: usize = 30;

/// A scene without a mechanism: 30 variables of mean 100 and std 2, 72 checkpoints.
fn scene() -> Scene {
    let variable = |k| RandomVariable {
        name: format!("x{k}"),
        distribution: Distribution::truncated_normal(100.0, 2.0, 94.0, 106.0).unwrap(),
        changes: vec![],
        unit: "mm".into(),
    };
    let body = |label: &str| SignedBody { body: 0, sign: 1.0, label: label.into() };
    let speed = OutputKind::AngularVelocityDifference { a: body("right"), b: body("left") };
    let output = |name: &str, kind| Output { name: name.into(), kind };
    let fails = Fails::Above;
    let limit = |name: &str, output, threshold| LimitState { name: name.into(), output, threshold, fails };
    Scene {
        name: "made-up".into(),
        title: "Two modes over 72 checkpoints".into(),
        bodies: vec![],
        joints: vec![],
        loads: vec![],
        gravity: [0.0; 2],
        outputs: vec![
            output("max_wear_depth", OutputKind::LargestWear { joints: vec![] }),
            output("angular_velocity_difference", speed),
        ],
        variables: (0..D).map(variable).collect(),
        correlations: vec![],
        limit_states: vec![limit("wear", 0, 30e-6), limit("asymmetry", 1, 2.618)],
        units: common::scene::Units::default(),
        control_points_of_model: false,
        wear: WearModel::default(),
        life: Life { period: 0.125, cycles: 72_000, checkpoint_every: 1000, settle_cycles: 1, turn_of: None },
        conditions: vec![],
        study: StudySettings { population: 100_000, initial: 120, batch: 16, max_evaluations: 300, seed: 1 },
        accuracy: NamedAccuracy::default(),
        // One level: no pairs.
        levels: vec![NamedAccuracy::default()],
        simulator: None,
    }
}

fn z(x: &[f64], k: usize) -> f64 {
    (x[k] - 100.0) / 2.0
}

/// Wear and angular-velocity difference at 72 checkpoints; like section 7 of the model: wear near its
/// threshold at 66 000 cycles with a standard deviation of 0.7 um, a hockey stick that passes its threshold
/// at about 67 000. Every variable has some influence, a few have most, with products of some. Exactly
/// reproducible "noise" of 0.1 % stands for the simulator's.
fn histories(x: &[f64], noise: f64) -> Vec<Vec<f64>> {
    let spread: f64 = (0..D).map(|k| z(x, k) * 0.5 / (1.0 + k as f64)).sum();
    let crosswise: f64 = (0..D).map(|k| z(x, k) * 0.5 / (1.0 + ((k + 23) % D) as f64)).sum();
    let wear = |n: f64| {
        let shape = 30e-6 + 0.37e-9 * (n - 66_000.0) / 1000.0 * 1e3 + 0.7e-6 * n / 66_000.0 * 1.5 * spread;
        shape + 0.02e-6 * z(x, 0) * z(x, 1)
    };
    let onset = 59_000.0 - 900.0 * crosswise - 200.0 * spread * (1.0 + 0.2 * crosswise);
    let asymmetry = |n: f64| {
        let rise = ((n - onset) / 1000.0).max(0.0);
        2.15 + 0.01 * crosswise + 0.0065 * rise.powf(2.1)
    };
    let jitter = |n: f64, phase: f64| {
        1.0 + noise * (1e4 * (spread + phase) + n).sin() * (7e3 * crosswise + 3.0 * n).cos()
    };
    let lives = (1..=72).map(|i| 1000.0 * f64::from(i));
    vec![
        lives.clone().map(|n| wear(n) * jitter(n, 0.0).mul_add(0.1, 0.9)).collect(),
        lives.map(|n| asymmetry(n) * jitter(n, 1.0)).collect(),
    ]
}

/// True absorbing reliabilities of the first `count` points of the study's population: wear, asymmetry,
/// total.
fn truth(settings: &Settings, count: usize, noise: f64) -> [Vec<f64>; 3] {
    let scene = scene();
    let variables: Vec<Distribution> = scene.variables.iter().map(|v| v.distribution.clone()).collect();
    let population = Population::draw(&variables, count, settings.seed);
    let mut failed = [vec![0.0; 72], vec![0.0; 72], vec![0.0; 72]];
    for j in 0..count {
        let outputs = histories(&population.physical(j), noise);
        let first = |o: usize, threshold: f64| outputs[o].iter().position(|y| *y >= threshold).unwrap_or(72);
        let (wear, asymmetry) = (first(0, 30e-6), first(1, 2.618));
        for (curve, first) in failed.iter_mut().zip([wear, asymmetry, wear.min(asymmetry)]) {
            curve[first..].iter_mut().for_each(|f| *f += 1.0 / count as f64);
        }
    }
    failed.map(|curve| curve.iter().map(|f| 1.0 - f).collect())
}

/// Evaluates the made-up life, replies in any order, counts, and fails where set.
struct MadeUp {
    noise: f64,
    /// Replies from the last request to the first.
    backwards: bool,
    /// Whether a sample fails, at the second attempt too.
    fails: fn(&[f64], bool) -> bool,
    /// Ends with an interruption after this many.
    interrupt_after: Option<usize>,
    calls: usize,
    /// Most evaluations that were under way at once.
    most_open: usize,
}

impl MadeUp {
    fn new() -> Self {
        let fails = |_: &[f64], _| false;
        Self { noise: 1e-3, backwards: false, fails, interrupt_after: None, calls: 0, most_open: 0 }
    }
}

impl Evaluator for MadeUp {
    fn run(&mut self, source: &mut dyn RequestSource) -> Result<(), EvaluateError> {
        let mut open = VecDeque::new();
        loop {
            match source.next()? {
                Demand::Begin(requests) => {
                    open.extend(requests);
                    continue;
                }
                Demand::End if open.is_empty() => return Ok(()),
                Demand::Later if open.is_empty() => {
                    std::thread::sleep(std::time::Duration::from_micros(50));
                    continue;
                }
                Demand::End | Demand::Later => {}
            }
            self.most_open = self.most_open.max(open.len());
            let request = if self.backwards { open.pop_back() } else { open.pop_front() };
            let request: Request = request.expect("there is one");
            if self.interrupt_after == Some(self.calls) {
                return Err(EvaluateError::Interrupted);
            }
            self.calls += 1;
            assert_eq!(request.with_first_cycle, request.id == 0);
            let failure = SimulationFailure::TooManySteps { cycle: 1, time: 0.0, joint: None, bound: 9 };
            let second = request.accuracy.is_some();
            let outcome = if (self.fails)(&request.sample, second) {
                Err(failure)
            } else {
                Ok(Evaluation {
                    cycles: (1..=72).map(|i| 1000 * i).collect(),
                    histories: histories(&request.sample, self.noise),
                    errors: vec![vec![0.0; 72]; 2],
                    ..Evaluation::default()
                })
            };
            source.record(Finished { id: request.id, outcome, worker: "test/0".into(), wall: 1.0 })?;
        }
    }
}

/// A small study for the properties that don't need a large one.
fn small() -> Settings {
    Settings {
        samples: 2000,
        initial: 40,
        batch: 8,
        max_evaluations: 64,
        seed: 3,
        ..Settings::from(&scene())
    }
}

fn study(
    settings: &Settings,
    evaluator: &mut MadeUp,
    journal: &mut InMemoryJournal,
) -> Result<StudyResult, StudyError> {
    run(&scene(), settings, evaluator, journal, &mut Silent)
}

/// A result without its clock readings.
fn timeless(mut result: StudyResult) -> StudyResult {
    result.summary.timing_s = crate::results::summary::Timing::default();
    result
}

/// The small study undisturbed, without its clock readings, and the most evaluations that were under way at once.
static WHOLE: LazyLock<(StudyResult, usize)> = LazyLock::new(|| {
    let mut evaluator = MadeUp::new();
    let result = study(&small(), &mut evaluator, &mut InMemoryJournal::default()).unwrap();
    (timeless(result), evaluator.most_open)
});

#[test]
fn two_modes_in_thirty_variables_are_found_within_300_calls() {
    let settings = Settings { samples: 8000, ..Settings::from(&scene()) };
    let mut evaluator = MadeUp::new();
    let result = study(&settings, &mut evaluator, &mut InMemoryJournal::default()).unwrap();
    let truth = truth(&settings, settings.samples, evaluator.noise);
    let mut worst = 0.0_f64;
    for (n, row) in result.summary.reliability.iter().enumerate() {
        for (curve, name) in ["wear", "asymmetry", "total"].iter().enumerate() {
            let difference = row.reliability[*name] - truth[curve][n];
            if truth[curve][n] > 1e-3 && truth[curve][n] < 0.999 {
                eprintln!(
                    "{} {name}: {:.4} truth {:.4} se {:.4}",
                    row.cycles, row.reliability[*name], truth[curve][n], row.standard_error[*name]
                );
            }
            worst = worst.max(difference.abs());
        }
    }
    for round in &result.summary.convergence.rounds {
        eprintln!("{round:?}");
    }
    for surrogate in &result.summary.surrogates {
        eprintln!("{} Q2 {:.4} nugget {:.2e}", surrogate.limit_state, surrogate.q2, surrogate.nugget);
    }
    eprintln!("{} calls, worst {worst:.4}, {:?}", evaluator.calls, result.summary.timing_s);
    assert!(worst < 0.02, "{worst}");
    assert!(evaluator.calls <= 300 && result.summary.evaluations.total == evaluator.calls);
}

#[test]
fn the_order_of_replies_does_not_change_a_bit() {
    let mut backwards = MadeUp { backwards: true, ..MadeUp::new() };
    let backward = study(&small(), &mut backwards, &mut InMemoryJournal::default()).unwrap();
    assert_eq!(WHOLE.0, timeless(backward));
}

#[test]
fn an_interrupted_study_goes_on_where_it_was_and_repeats_nothing() {
    let whole = &WHOLE.0;
    let mut journal = InMemoryJournal::default();
    let mut first = MadeUp { interrupt_after: Some(51), backwards: true, ..MadeUp::new() };
    let interrupted = study(&small(), &mut first, &mut journal);
    assert!(matches!(interrupted, Err(StudyError::Evaluate(EvaluateError::Interrupted))));
    assert_eq!(journal.outcomes().len(), 51);
    let mut second = MadeUp::new();
    let resumed = study(&small(), &mut second, &mut journal).unwrap();
    assert_eq!(first.calls + second.calls, whole.summary.evaluations.total);
    assert_eq!(*whole, timeless(resumed));
}

#[test]
fn failed_simulations_are_repeated_and_then_left_out_and_counted() {
    // A tenth of the population fails at first; what lies beyond 1.9 does so for good.
    let fails = |x: &[f64], second| z(x, 3) > if second { 1.9 } else { 1.28 };
    let mut evaluator = MadeUp { fails, ..MadeUp::new() };
    let result = study(&small(), &mut evaluator, &mut InMemoryJournal::default()).unwrap();
    let (counts, failures) = (result.summary.evaluations, &result.summary.failures);
    assert!(counts.total > 40 && counts.total <= 64 && counts.initial == 40, "{counts:?}");
    assert!(counts.failed >= 1 && counts.failed == failures.simulations.len(), "{failures:?}");
    for failed in &failures.simulations {
        let deviation = (failed.sample["x3"] - 100.0) / 2.0;
        // Those that failed once and have not been repeated when the budget was spent may lie lower.
        assert!(deviation > 1.28 && failed.cause.contains("steps per cycle"), "{failed:?}");
    }
}

#[test]
fn too_many_failures_end_the_study_and_name_the_cause() {
    let mut evaluator = MadeUp { fails: |x, _| z(x, 0) > 0.3, ..MadeUp::new() };
    let error = study(&small(), &mut evaluator, &mut InMemoryJournal::default()).unwrap_err();
    let text = error.to_string();
    assert!(text.contains("simulations failed") && text.contains("steps per cycle"), "{text}");
    // Told to bear it, it goes on.
    let patient = Settings { max_failed: 0.9, ..small() };
    let mut evaluator = MadeUp { fails: |x, _| z(x, 0) > 0.3, ..MadeUp::new() };
    let result = study(&patient, &mut evaluator, &mut InMemoryJournal::default()).unwrap();
    let (barred, rows) = (result.summary.failures.barred_share, &result.summary.reliability);
    // Whether all or none of that region fails is not known: one of the two is more than half of it away.
    assert!(barred > 0.05 && rows.iter().all(|row| 1.96 * row.standard_error["total"] >= 0.5 * barred));
}

#[test]
fn half_a_batch_is_simulated_while_the_other_is_learned_from() {
    let (batch, initial) = (small().batch, small().initial);
    // The nominal point of the initial design is simulated alone, before the others.
    assert_eq!(WHOLE.1, initial - 1);
    // One point at a time is nothing under way while learning.
    let settings = Settings { initial: 10, ..small() };
    let mut evaluator = MadeUp { interrupt_after: Some(30), ..MadeUp::new() };
    study(&settings, &mut evaluator, &mut InMemoryJournal::default()).unwrap_err();
    assert_eq!(evaluator.most_open, batch.max(settings.initial - 1));
}

#[test]
fn a_wrong_shape_or_value_is_refused_by_number_and_worker() {
    struct Broken;
    struct Spoilt<'a>(&'a mut dyn RequestSource);
    impl RequestSource for Spoilt<'_> {
        fn next(&mut self) -> Result<Demand, EvaluateError> {
            self.0.next()
        }

        fn record(&mut self, mut finished: Finished) -> Result<(), EvaluateError> {
            if finished.id == 5
                && let Ok(evaluation) = &mut finished.outcome
            {
                evaluation.histories[1][7] = f64::NAN;
            }
            self.0.record(finished)
        }
    }
    impl Evaluator for Broken {
        fn run(&mut self, source: &mut dyn RequestSource) -> Result<(), EvaluateError> {
            MadeUp::new().run(&mut Spoilt(source))
        }
    }
    let error =
        run(&scene(), &small(), &mut Broken, &mut InMemoryJournal::default(), &mut Silent).unwrap_err();
    let expected = "evaluation 5 by test/0 does not fit the scene: output \"angular_velocity_difference\" is NaN at 8000 \
                    cycles, allowed: -1e150 to 1e150, whose square is still a number";
    assert_eq!(error.to_string(), expected);
}

#[test]
fn settings_that_make_no_study_are_refused() {
    let mut settings = small();
    settings.max_evaluations = 10;
    let error = study(&settings, &mut MadeUp::new(), &mut InMemoryJournal::default()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "study setting max_evaluations = 10: at least the initial design, initial = 40"
    );
}

#[test]
fn a_latin_hypercube_is_simulated_whole() {
    let mut settings = small();
    (settings.method, settings.samples) = (Method::LatinHypercube, 150);
    let result = study(&settings, &mut MadeUp::new(), &mut InMemoryJournal::default()).unwrap();
    assert_eq!((result.summary.method.as_str(), result.summary.population), ("latin-hypercube", 150));
    // Of the mean wear it knows more than 150 independent samples: 0.7 um of spread over sqrt(150) would be
    // 0.06 um.
    let exact = 30e-6;
    let mean = result.summary.moments[65].moments["wear_mean_m"];
    assert!((mean - exact).abs() < 0.02e-6, "{mean}");
}

#[test]
fn what_fails_first_adds_up_to_all_failures() {
    let result = &WHOLE.0;
    for (first, row) in result.summary.first_failure.iter().zip(&result.summary.reliability) {
        let sum = first.first.values().sum::<f64>() + first.together;
        assert!((sum + row.reliability["total"] - 1.0).abs() < 1e-12 && first.cycles == row.cycles);
    }
    assert!(result.summary.first_failure[71].first.values().all(|share| *share > 0.05));
}

#[test]
fn monte_carlo_counts_what_it_simulated() {
    let mut settings = small();
    (settings.method, settings.samples) = (Method::MonteCarlo, 150);
    let result = study(&settings, &mut MadeUp::new(), &mut InMemoryJournal::default()).unwrap();
    let truth = truth(&settings, 150, 1e-3);
    for (n, row) in result.summary.reliability.iter().enumerate() {
        for (curve, name) in ["wear", "asymmetry", "total"].iter().enumerate() {
            assert!((row.reliability[*name] - truth[curve][n]).abs() < 1e-12);
        }
    }
    assert_eq!(result.summary.evaluations.total, 151);
    assert_eq!(result.summary.population, 150);
    assert!(result.summary.moments[65].moments["wear_mean_m"] > 28e-6);
    let rpm = result.summary.moments[0].moments["asymmetry_mean_rpm"];
    assert!((rpm - 2.15 * 30.0 / std::f64::consts::PI).abs() < 0.2, "{rpm}");
    assert!(result.summary.surrogates.is_empty());
}

#[test]
fn issue_direct_simulation_with_failed_samples_states_a_true_interval() {
    let mut evaluator = MadeUp { fails: |x, _| z(x, 0) > 1.2, noise: 0.0, ..MadeUp::new() };
    let settings = Settings { method: Method::MonteCarlo, samples: 600, ..small() };
    let result = study(&settings, &mut evaluator, &mut InMemoryJournal::default()).unwrap();
    let (mut beyond, exact) = (0, truth(&settings, 600, 0.0));
    for (n, row) in result.summary.reliability.iter().enumerate() {
        let (r, exact) = (row.reliability["wear"], exact[0][n]);
        assert!((r - exact).abs() <= 1.96 * row.standard_error["wear"], "{n}: {r} {exact}");
        beyond += u32::from((r - exact).abs() > 3.0 * (r * (1.0 - r) / 600.0_f64).sqrt());
    }
    assert!(beyond > 3, "without failures the interval would hold by itself: {beyond}");
    let (counts, failures) = (result.summary.evaluations, result.summary.failures);
    assert!(counts.failed == failures.simulations.len() && counts.failed > 40, "{counts:?}");
    assert!((failures.barred_share - counts.failed as f64 / 600.0).abs() < 1e-12);
}
