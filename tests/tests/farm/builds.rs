//! Workers of another build of the program, whose results may have other bits.

use common::build::Build;
use common::failure::SimulationFailure;
use common::outputs::Evaluation;
use common::wire::Offers;
use coordinator::farm::dispatch::{CampaignSpec, Listen, ZenohEvaluator};
use std::sync::Arc;
use tests::practice_study::{PracticeStudy, evaluation};
use tests::{PATIENCE, in_time, worker};
use worker::service::{self, Departure, Job, ServiceConfig, Simulator};

/// The simulations of another build, which differ in late digits.
struct OtherBuild;

impl Simulator for OtherBuild {
    fn offers(&self) -> Offers {
        Offers::Scenes(Build(worker::BUILD.0 ^ 1))
    }

    fn simulate(&self, job: &Job) -> Result<Evaluation, SimulationFailure> {
        evaluation(job.sample()).map(|mut found| {
            found.histories[0].iter_mut().for_each(|value| *value *= 1.0 + 1e-12);
            found
        })
    }
}

/// A study with a worker of this build and one of another: its answer, and the names of the workers whose results it has.
fn studied(build: Option<Build>) -> (String, Vec<String>) {
    let study = PracticeStudy::monte_carlo(40);
    let folder = tempfile::tempdir().unwrap();
    let (mut journal, _) = study.journal(folder.path()).unwrap();
    let campaign = CampaignSpec { build, ..study.campaign(false) };
    let mut evaluator = ZenohEvaluator::open(campaign, &Listen::default(), Arc::default()).unwrap();
    let config = ServiceConfig { name: "other".into(), ..ServiceConfig::new(&evaluator.endpoints[0], 1) };
    let other = service::spawn(config, Arc::new(OtherBuild)).unwrap();
    assert!(evaluator.connected.wait_for(PATIENCE, |workers| workers.len() == 1));
    let same = worker(&evaluator, "same", 1, |sample| {
        // The other worker gets its share.
        std::thread::sleep(std::time::Duration::from_millis(5));
        evaluation(sample)
    });
    let found = study.run(&mut evaluator, &mut journal).unwrap();
    evaluator.finish();
    for worker in [other, same] {
        assert_eq!(worker.join().unwrap(), Departure::CampaignEnded);
    }
    found
}

#[test]
fn issue_results_of_another_build_were_mixed_into_a_study() {
    in_time(|| {
        let alone = PracticeStudy::monte_carlo(40).alone();
        let (answer, workers) = studied(Some(worker::BUILD));
        assert_eq!((answer, workers), (alone.clone(), vec!["same/0".to_owned()]));
        let (answer, workers) = studied(None);
        assert_ne!(answer, alone);
        let other = format!("other/0 (build {})", Build(worker::BUILD.0 ^ 1));
        let same = format!("same/0 (build {})", worker::BUILD);
        assert!(
            workers.contains(&other) && workers.iter().all(|name| [&other, &same].contains(&name)),
            "{workers:?}"
        );
    });
}
