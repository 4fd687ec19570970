//! Cost of a study besides its simulations: whole studies with a simulator of 0.1 s on each of two threads, journal included.
//!
//! ```sh
//! cargo run --release -p coordinator --example learning_overhead
//! ```
//!
//! Overhead is (wall time - evaluations * 0.1 s / 2) / (evaluations * 0.1 s / 2). The first scene is the flapping-wing drive
//! with 30 variables, two limit states and 72 checkpoints; the responses are formulas of similar shape. The second one has
//! three variables and ten checkpoints. Run it on an otherwise idle machine.

use common::outputs::{Diagnostics, Evaluation};
use common::scene::{Scene, SceneSource};
use coordinator::farm::evaluate::Request;
use coordinator::farm::evaluate::local::LocalEvaluator;
use coordinator::results::progress::Silent;
use coordinator::results::store::{CampaignFile, CampaignMeta};
use coordinator::study::{Settings, run};
use std::error::Error;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

const THREADS: usize = 2;
const EVALUATION: Duration = Duration::from_millis(100);

const BEAM: &str = r#"
scene = { name = "beam" }
simulator = { program = ["stand-in"] }
life = { cycles = 50, checkpoint_every = 5 }
outputs = [{ name = "deflection", unit = "mm" }]
limit_states = [{ name = "bent", output = "deflection", threshold = 9 }]
variables = [
    { name = "load", mean = "500 N", std = "10 %" },
    { name = "width", mean = "20 mm", std = "0.2 mm" },
    { name = "height", mean = "40 mm", std = "0.2 mm" },
]
"#;

fn main() -> Result<(), Box<dyn Error>> {
    println!(
        "| scene | variables | evaluations | wall | simulation | before the first | learning with nothing under way | after the last | overhead |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    let beam = SceneSource::parse(BEAM, "beam")?;
    for source in [beam, SceneSource::builtin("flapping-wing").expect("a built-in scene")] {
        let scene = source.nominal();
        let Measured { evaluations, wall, before, idle, after } = measure(&source, scene)?;
        let simulation = evaluations as f64 * EVALUATION.as_secs_f64() / THREADS as f64;
        println!(
            "| {} | {} | {evaluations} | {wall:.1} s | {simulation:.1} s | {before:.1} s | {idle:.1} s | {after:.1} s | {:.0} % |",
            scene.name,
            scene.variables.len(),
            100.0 * (wall - simulation) / simulation
        );
    }
    Ok(())
}

/// What a study took [s].
struct Measured {
    evaluations: usize,
    wall: f64,
    /// Until the first simulation began.
    before: f64,
    /// Learning with nothing under way.
    idle: f64,
    /// From the end of the last simulation.
    after: f64,
}

fn measure(source: &SceneSource, scene: &Scene) -> Result<Measured, Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let meta = CampaignMeta {
        scene: scene.name.clone(),
        scene_source: source.text().to_owned(),
        settings: serde_json::Value::Null,
        command: String::new(),
        version: String::new(),
    };
    let mut campaign = CampaignFile::create(&folder.path().join("study"), &meta, scene)?;
    // Begin of the first simulation and end of the last so far.
    let simulated: Arc<Mutex<Option<(Instant, Instant)>>> = Arc::default();
    let seen = Arc::clone(&simulated);
    let mut evaluator = LocalEvaluator::new(THREADS, move |request: &Request| {
        let started = Instant::now();
        let evaluation = made_up(scene, &request.sample);
        while started.elapsed() < EVALUATION {
            std::hint::spin_loop();
        }
        let mut seen = seen.lock().expect("no holder panics");
        let first = seen.map_or(started, |(first, _)| first.min(started));
        *seen = Some((first, Instant::now()));
        Ok(evaluation)
    });
    let settings = Settings::from(scene);
    let started = Instant::now();
    let result = run(scene, &settings, &mut evaluator, &mut campaign, &mut Silent)?;
    let (wall, ended) = (started.elapsed().as_secs_f64(), Instant::now());
    let (first, last) = simulated.lock().expect("no holder panics").ok_or("nothing was simulated")?;
    Ok(Measured {
        evaluations: result.summary.evaluations.total,
        wall,
        before: (first - started).as_secs_f64(),
        idle: result.summary.timing_s.idle / THREADS as f64,
        after: (ended - last).as_secs_f64(),
    })
}

/// Every output rises through its limit at about nine tenths of the life, a little bent in the variables.
fn made_up(scene: &Scene, sample: &[f64]) -> Evaluation {
    let z: Vec<f64> = scene
        .variables
        .iter()
        .zip(sample)
        .map(|(variable, x)| (x - variable.distribution.mean()) / variable.distribution.std())
        .collect();
    let life = f64::from(scene.life.cycles);
    let history = |o: usize| -> Vec<f64> {
        let weight = |k: usize| 1.0 / (1.0 + ((k + 7 * o) % z.len()) as f64);
        let sum: f64 = z.iter().enumerate().map(|(k, z)| weight(k) * z).sum();
        let bend = z[0] * z[z.len() / 2] + z[o % z.len()].powi(2);
        let limit =
            scene.limit_states.iter().find(|limit| limit.output == o).map_or(1.0, |limit| limit.threshold);
        let at = |n: u32| limit * (1.0 + 2.0 * (f64::from(n) / life - 0.9) + 0.02 * sum + 0.002 * bend);
        scene.life.checkpoints().into_iter().map(at).collect()
    };
    let histories: Vec<Vec<f64>> = (0..scene.outputs.len()).map(history).collect();
    Evaluation {
        cycles: scene.life.checkpoints(),
        histories,
        errors: Vec::new(),
        first_cycle: None,
        worn: None,
        start: vec![],
        joints: Vec::new(),
        diagnostics: Diagnostics::default(),
    }
}
