//! One case put to the test, or all of them on several threads.

use super::Case;
use crate::simulate::simulate_counting;
use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::outputs::Evaluation;
use common::scene::{ContactLaw, Scene};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// What became of a case.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// Both runs came to their end and agree within the first one's stated error.
    Agrees,
    /// The first run was refused.
    Refused(SimulationFailure),
    /// Both runs came to their end and differ by more than the stated error somewhere.
    Disagrees,
    /// Only the run at half the step was refused: the first one's numbers have nothing to back them.
    Unconfirmed(SimulationFailure),
}

impl Outcome {
    /// Whether the user got a number to rely on, or a reason why there is none.
    pub fn is_sound(&self) -> bool {
        match self {
            Outcome::Agrees => true,
            Outcome::Refused(failure) => !matches!(failure, SimulationFailure::Panicked { .. }),
            Outcome::Disagrees | Outcome::Unconfirmed(_) => false,
        }
    }
}

/// One output where the two runs are furthest apart, measured by the stated error.
#[derive(Debug, Clone, PartialEq)]
pub struct Compared {
    /// Index into the scene's outputs.
    pub output: usize,
    /// Life of the checkpoint [cycles].
    pub cycles: u32,
    /// Value there, in the output's SI unit.
    pub value: f64,
    /// Stated error there.
    pub error: f64,
    /// Difference to the run at half the step.
    pub difference: f64,
}

/// A row of the table.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// What is extreme.
    pub case: &'static str,
    /// Contact law.
    pub law: ContactLaw,
    /// What became of it.
    pub outcome: Outcome,
    /// Every output, if both runs came to their end.
    pub compared: Vec<Compared>,
    /// Largest wear depth of any joint at the end of life, if the first run came to its end [m].
    pub depth: Option<f64>,
    /// Time steps of the first run, accepted and refused, up to its end or to its failure.
    pub steps: u64,
    /// The same of the run at half the step; zero if there was none.
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
    let whole = match guarded(&case.scene, &case.accuracy, &mut row.steps) {
        Ok(evaluation) => evaluation,
        Err(failure) => return Row { outcome: Outcome::Refused(failure), ..row },
    };
    row.depth = whole.joints.iter().flat_map(|j| j.wear_depth.iter().copied()).reduce(f64::max);
    match guarded(&case.scene, &case.accuracy.refined(2.0), &mut row.steps_of_half) {
        Err(failure) => row.outcome = Outcome::Unconfirmed(failure),
        Ok(half) => {
            row.compared = compare(&whole, &half);
            // A comparison with NaN is false: nothing that is not a number agrees.
            if !row.compared.iter().all(|c| c.difference <= c.error) {
                row.outcome = Outcome::Disagrees;
            }
        }
    }
    row
}

/// Runs all cases on so many threads; rows in the order of the cases, each shown to `done` when it is there.
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

/// A panic is a defect of the program, but no reason to lose the other rows.
fn guarded(scene: &Scene, accuracy: &Accuracy, steps: &mut u64) -> Result<Evaluation, SimulationFailure> {
    catch_unwind(AssertUnwindSafe(|| simulate_counting(scene, accuracy, false, steps))).unwrap_or_else(
        |panic| {
            let said = panic.downcast_ref::<String>().cloned();
            let message = said.or_else(|| panic.downcast_ref::<&str>().map(|s| (*s).to_owned()));
            Err(SimulationFailure::Panicked { message: message.unwrap_or_default() })
        },
    )
}

/// Every output at the checkpoint where the two runs differ most, measured by the stated error.
fn compare(whole: &Evaluation, half: &Evaluation) -> Vec<Compared> {
    let of = |k: usize| {
        let at = |i: usize| Compared {
            output: k,
            cycles: whole.cycles[i],
            value: whole.histories[k][i],
            error: whole.errors[k][i],
            difference: (whole.histories[k][i] - half.histories[k][i]).abs(),
        };
        let excess = |c: &Compared| if c.difference > 0.0 { c.difference / c.error } else { 0.0 };
        (0..whole.cycles.len()).map(at).max_by(|a, b| excess(a).total_cmp(&excess(b)))
    };
    (0..whole.histories.len()).filter_map(of).collect()
}
