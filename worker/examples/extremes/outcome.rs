//! Runs one case, or all of them on several threads.

use crate::cases::Case;
use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::outputs::Evaluation;
use common::panics::caught;
use common::scene::{ContactLaw, Scene};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use worker::simulate::{CountedEvaluation, SimulateOptions, simulate_counted};

/// Outcome of a case.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// Both runs succeeded and agree within the error stated by the first one.
    Agrees,
    /// The first run failed.
    Refused(SimulationFailure),
    /// Both runs succeeded and differ by more than the stated error at a checkpoint.
    Disagrees,
    /// Only the run at half the step failed, so that the first one is not confirmed.
    Unconfirmed(SimulationFailure),
}

impl Outcome {
    /// True if the case has a confirmed result, or a failure with its reason.
    pub fn is_sound(&self) -> bool {
        match self {
            Outcome::Agrees => true,
            Outcome::Refused(failure) => !matches!(failure, SimulationFailure::Panicked { .. }),
            Outcome::Disagrees | Outcome::Unconfirmed(_) => false,
        }
    }
}

/// An output at the checkpoint where the two runs differ most, relative to the stated error.
#[derive(Debug, Clone, PartialEq)]
pub struct Compared {
    /// Index into the scene's outputs.
    pub output: usize,
    /// Life of the checkpoint [cycles].
    pub cycles: u32,
    /// Value there [SI].
    pub value: f64,
    /// Stated error there [SI].
    pub error: f64,
    /// Difference to the run at half the step [SI].
    pub difference: f64,
}

/// A row of the table.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// The extreme quantities.
    pub case: &'static str,
    /// Contact law of all joints with clearance.
    pub law: ContactLaw,
    /// Outcome of the case.
    pub outcome: Outcome,
    /// Comparison of every output, if both runs succeeded.
    pub compared: Vec<Compared>,
    /// Largest wear depth of any joint at the end of life, if the first run succeeded [m].
    pub depth: Option<f64>,
    /// Time steps of the first run, accepted and refused, up to its end or failure.
    pub steps: u64,
    /// Time steps of the run at half the step, zero if there was none.
    pub steps_of_half: u64,
}

/// Runs a case, and again at half the step.
pub fn run(case: &Case) -> Row {
    let mut row = Row {
        case: case.name,
        law: case.law,
        outcome: Outcome::Agrees,
        compared: vec![],
        depth: None,
        steps: 0,
        steps_of_half: 0,
    };
    let (result, steps_tried) = simulate_guarded(&case.scene, &case.accuracy);
    row.steps = steps_tried;
    let whole = match result {
        Ok(evaluation) => evaluation,
        Err(failure) => return Row { outcome: Outcome::Refused(failure), ..row },
    };
    row.depth = whole.joints.iter().flat_map(|j| j.wear_depth.iter().copied()).reduce(f64::max);
    let (result, steps_tried) = simulate_guarded(&case.scene, &case.accuracy.refined(2.0));
    row.steps_of_half = steps_tried;
    match result {
        Err(failure) => row.outcome = Outcome::Unconfirmed(failure),
        Ok(half) => {
            row.compared = compare(&whole, &half);
            // A comparison with NaN is false: NaN does not agree.
            if !row.compared.iter().all(|c| c.difference <= c.error) {
                row.outcome = Outcome::Disagrees;
            }
        }
    }
    row
}

/// Runs all cases on `threads` threads. Rows are in the order of the cases; `done` receives each one when it is complete.
pub fn run_all(cases: &[Case], threads: usize, done: impl Fn(&Row) + Sync) -> Vec<Row> {
    let next = AtomicUsize::new(0);
    let rows = Mutex::new(Vec::with_capacity(cases.len()));
    std::thread::scope(|scope| {
        for _ in 0..threads.max(1) {
            scope.spawn(|| {
                while let Some((k, case)) = Some(next.fetch_add(1, Ordering::Relaxed))
                    .and_then(|k| cases.get(k).map(|case| (k, case)))
                {
                    let row = run(case);
                    done(&row);
                    rows.lock().unwrap_or_else(|e| e.into_inner()).push((k, row));
                }
            });
        }
    });
    let mut rows = rows.into_inner().unwrap_or_else(|e| e.into_inner());
    rows.sort_by_key(|(k, _)| *k);
    rows.into_iter().map(|(_, row)| row).collect()
}

/// Simulates with panics as failures: a panic is a defect of the program, but the other rows are kept.
fn simulate_guarded(scene: &Scene, accuracy: &Accuracy) -> CountedEvaluation {
    let counted = || simulate_counted(scene, accuracy, SimulateOptions::default());
    let failed = |message| SimulationFailure::Panicked { message };
    caught(counted).unwrap_or_else(|message| (Err(failed(message)), 0))
}

/// Every output at the checkpoint where the two runs differ most, relative to the stated error.
fn compare(whole: &Evaluation, half: &Evaluation) -> Vec<Compared> {
    let excess = |c: &Compared| if c.difference > 0.0 { c.difference / c.error } else { 0.0 };
    let worst_checkpoint = |output: usize| {
        let compared = (0..whole.cycles.len()).map(|i| Compared {
            output,
            cycles: whole.cycles[i],
            value: whole.histories[output][i],
            error: whole.errors[output][i],
            difference: (whole.histories[output][i] - half.histories[output][i]).abs(),
        });
        compared.max_by(|a, b| excess(a).total_cmp(&excess(b)))
    };
    (0..whole.histories.len()).filter_map(worst_checkpoint).collect()
}
