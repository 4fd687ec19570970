//! Your own simulator on the farm: a coordinator and two workers in one process, connected over the loopback.
//! `cargo run --release -p tests --example own_simulator`

use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::outputs::Evaluation;
use coordinator::farm::dispatch::{CampaignSpec, Listen, ZenohEvaluator};
use coordinator::farm::evaluate::{Evaluator, Request};
use std::sync::Arc;
use worker::service::{Job, ServiceConfig, Simulator, spawn};

/// The simulator: one output at one checkpoint, the sum of squares of the sample.
struct SumOfSquares;

impl Simulator for SumOfSquares {
    fn simulate(&self, job: &Job) -> Result<Evaluation, SimulationFailure> {
        Ok(Evaluation::from_histories(vec![1], vec![vec![job.sample().iter().map(|x| x * x).sum()]]))
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (scene, accuracy_name) = ("text for every worker".into(), "balanced".into());
    let campaign = CampaignSpec {
        id: 1,
        scene,
        accuracy: Accuracy::balanced(),
        accuracy_name,
        build: None,
        shape: None,
        simulator: None,
        cross_check: None,
        resumed: false,
    };
    let mut evaluator = ZenohEvaluator::open(campaign, &Listen::default(), Arc::default())?;
    let endpoint = evaluator.endpoints[0].clone();
    let config = |name: &str| ServiceConfig { name: name.into(), ..ServiceConfig::new(&endpoint, 1) };
    let workers = [config("first"), config("second")].map(|config| spawn(config, Arc::new(SumOfSquares)));
    let request = |id| Request {
        id,
        sample: vec![id as f64, 1.0],
        with_first_cycle: false,
        accuracy: None,
        level: 0,
        not_by: vec![],
    };
    evaluator.evaluate(&(0..10).map(request).collect::<Vec<_>>(), &mut |finished| {
        println!("{} by {}: {:?}", finished.id, finished.worker, finished.outcome.map(|e| e.histories[0][0]));
        Ok(())
    })?;
    evaluator.finish();
    workers.into_iter().try_for_each(|worker| worker?.join().map(drop))?;
    Ok(())
}
