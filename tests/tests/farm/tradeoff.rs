//! Several accuracies in one farm: every task reaches its worker with the right one.

use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::outputs::Evaluation;
use coordinator::analyses::tradeoff::{TradeoffPlan, settings};
use std::sync::Arc;
use tests::{coordinator, in_time, practice_result, requests, wait_until_connected};
use worker::service::{self, Job, ServiceConfig, Simulator};

/// States the accuracy of its job in its outcome.
struct Echo;

impl Simulator for Echo {
    fn simulate(&self, job: &Job) -> Result<Evaluation, SimulationFailure> {
        let mut evaluation = practice_result(job.sample())?;
        evaluation.diagnostics.wear_stages = u64::from(job.accuracy().cycle_jump);
        Ok(evaluation)
    }
}

#[test]
fn every_task_of_a_measurement_has_its_own_accuracy() {
    let (found, end, seen) = in_time(|| {
        let mut farm = coordinator();
        let workers = ["a", "b"].map(|name| {
            let config = ServiceConfig { name: name.into(), ..ServiceConfig::new(&farm.endpoints[0], 2) };
            service::spawn(config, Arc::new(Echo)).expect("a session to a loopback endpoint opens")
        });
        ["a", "b"].iter().for_each(|name| wait_until_connected(&farm, name));
        let points = requests(0..3).into_iter().map(|request| request.sample).collect();
        let plan = TradeoffPlan {
            reference: "reference".parse().expect("a preset"),
            settings: settings(["draft", "jump-250", "jump-251"]).expect("settings"),
            points,
        };
        let mut seen = 0;
        let (found, end) = plan.measure(&mut farm, &mut |_| seen += 1);
        farm.finish();
        for worker in workers {
            worker.join().expect("it leaves at the end of the campaign");
        }
        (found, end, seen)
    });
    end.expect("the measurement comes to its end");
    assert_eq!((found.reference.len(), seen), (3, 12));
    let expected = [Accuracy::reference().cycle_jump, Accuracy::draft().cycle_jump, 250, 251];
    for (measured, jump) in std::iter::once(&found.reference).chain(&found.settings).zip(expected) {
        for (point, one) in measured.iter().enumerate() {
            let evaluation = one.outcome.as_ref().expect("none of these samples fails");
            assert_eq!(evaluation.diagnostics.wear_stages, u64::from(jump));
            assert_eq!(evaluation.histories, practice_result(&[point as f64]).expect("likewise").histories);
            assert!(one.wall >= 0.0);
        }
    }
}
