//! Outcomes that do not fit the scene: they are never recorded, their worker gets no more tasks, and the answer is that of a study
//! without them.

use common::failure::SimulationFailure;
use common::outputs::Evaluation;
use coordinator::farm::dispatch::{CampaignSpec, ConnectedWorker, CrossCheck, Listen, ZenohEvaluator};
use coordinator::farm::evaluate::local::LocalEvaluator;
use coordinator::farm::evaluate::{Finished, Request};
use coordinator::results::journal::Journal;
use std::sync::Arc;
use tests::practice_study::{PracticeStudy, evaluation};
use tests::{PATIENCE, in_time, worker};
use worker::service::Departure;

/// An evaluation with its misfit.
type Misfit = fn(&mut Evaluation);

const MISFITS: [Misfit; 10] = [
    |found| found.cycles.truncate(7),
    |found| found.cycles[3] = 4001,
    |found| found.cycles[3] = found.cycles[2],
    |found| found.histories.truncate(1),
    |found| found.histories[1].truncate(3),
    |found| found.histories[0][7] = 1e151,
    |found| found.errors[1][0] = -1.0,
    |found| found.errors[0][2] = 1e200,
    |found| found.errors.truncate(1),
    |found| found.start = vec![Some(1e200), None],
];

fn with(misfit: Misfit, sample: &[f64]) -> Result<Evaluation, SimulationFailure> {
    evaluation(sample).map(|mut found| {
        misfit(&mut found);
        found
    })
}

#[test]
fn issue_one_misfit_of_one_worker_ended_the_study_for_ever() {
    in_time(|| {
        let study = PracticeStudy::monte_carlo(12);
        let expected = study.alone();
        for (k, misfit) in MISFITS.into_iter().enumerate() {
            let folder = tempfile::tempdir().unwrap();
            let (mut journal, _) = study.journal(folder.path()).unwrap();
            let mut evaluator =
                ZenohEvaluator::open(study.campaign(false), &Listen::default(), Arc::default()).unwrap();
            let misfitting = worker(&evaluator, "misfitting", 1, move |sample| with(misfit, sample));
            // The first task is the misfitting worker's.
            assert!(evaluator.connected.wait_for(PATIENCE, |w| w.iter().any(|w| w.slots > 0)), "{k}");
            let fitting = worker(&evaluator, "fitting", 1, evaluation);
            let (answer, workers) = study.run(&mut evaluator, &mut journal).unwrap();
            assert_eq!(answer, expected, "{k}");
            assert_eq!(workers, ["fitting/0"], "{k}");
            evaluator.finish();
            for worker in [misfitting, fitting] {
                assert_eq!(worker.join().unwrap(), Departure::CampaignEnded, "{k}");
            }
        }
    });
}

#[test]
fn issue_results_of_a_worker_off_by_a_fifth_were_believed() {
    in_time(|| {
        let study = PracticeStudy::monte_carlo(12);
        let expected = study.alone();
        let folder = tempfile::tempdir().unwrap();
        let (mut journal, _) = study.journal(folder.path()).unwrap();
        let cross_check = Some(CrossCheck { share: 0.0, is_exact: true });
        let campaign = CampaignSpec { cross_check, ..study.campaign(false) };
        let mut evaluator = ZenohEvaluator::open(campaign, &Listen::default(), Arc::default()).unwrap();
        let off = |sample: &[f64]| {
            evaluation(sample).map(|mut found| {
                found.histories.iter_mut().flatten().for_each(|value| *value *= 0.8);
                found
            })
        };
        let off = worker(&evaluator, "off", 1, off);
        let others = ["one", "two"].map(|name| worker(&evaluator, name, 1, evaluation));
        let all = |w: &[ConnectedWorker]| w.iter().filter(|w| w.slots > 0).count() == 3;
        assert!(evaluator.connected.wait_for(PATIENCE, all));
        let (answer, workers) = study.run(&mut evaluator, &mut journal).unwrap();
        assert_eq!(answer, expected);
        assert!(workers.iter().all(|worker| worker != "off/0"), "{workers:?}");
        evaluator.finish();
        for worker in others.into_iter().chain([off]) {
            assert_eq!(worker.join().unwrap(), Departure::CampaignEnded);
        }
    });
}

#[test]
fn issue_a_recorded_misfit_made_every_resume_fail() {
    let study = PracticeStudy::monte_carlo(12);
    let expected = study.alone();
    for (k, misfit) in MISFITS.into_iter().enumerate() {
        let folder = tempfile::tempdir().unwrap();
        let (mut journal, _) = study.journal(folder.path()).unwrap();
        let sample = study.means();
        let finished =
            Finished { id: 0, outcome: with(misfit, &sample), worker: "misfitting/0".into(), wall: 0.1 };
        let request =
            Request { id: 0, sample, with_first_cycle: true, accuracy: None, level: 0, not_by: vec![] };
        // The tables of some shapes cannot even be written; then nothing is recorded.
        let recorded = journal.record(&request, &finished).is_ok();
        let mut evaluator = LocalEvaluator::new(1, |request| evaluation(&request.sample));
        assert_eq!(study.run(&mut evaluator, &mut journal).unwrap().0, expected, "{k}");
        let file = rusqlite::Connection::open(folder.path().join("campaign.db")).unwrap();
        let query =
            "SELECT count(*) FROM evaluation WHERE id < 0 AND failure LIKE '%misfitting/0 does not fit%'";
        let aside: i64 = file.query_row(query, [], |row| row.get(0)).unwrap();
        assert_eq!(aside, i64::from(recorded), "{k}");
    }
}

#[test]
fn a_misfit_of_the_own_evaluator_is_an_error_and_not_recorded() {
    let study = PracticeStudy::monte_carlo(12);
    let folder = tempfile::tempdir().unwrap();
    let (mut journal, _) = study.journal(folder.path()).unwrap();
    let mut misfitting = LocalEvaluator::new(1, |request| with(MISFITS[5], &request.sample));
    let error = study.run(&mut misfitting, &mut journal).unwrap_err().to_string();
    assert!(
        error.contains("does not fit the scene: output \"max_wear_depth\" is 1e151 at 8000 cycles"),
        "{error}"
    );
    let mut fitting = LocalEvaluator::new(1, |request| evaluation(&request.sample));
    assert_eq!(study.run(&mut fitting, &mut journal).unwrap().0, study.alone());
}
