//! Reliability over life of a beam whose clamp loosens, simulated by a closure, without files or messaging:
//! `cargo run --release -p coordinator --example reliability_of_a_closure`

use common::outputs::Evaluation;
use common::scene::SceneSource;
use coordinator::farm::evaluate::Request;
use coordinator::farm::evaluate::local::LocalEvaluator;
use coordinator::results::journal::InMemoryJournal;
use coordinator::results::progress::Silent;
use coordinator::study::{Settings, run};

const SCENE: &str = r#"
scene = { name = "beam" }
simulator = { program = ["closure"] }  # stands for the closure below
life = { cycles = 1000, checkpoint_every = 100 }
outputs = [{ name = "deflection", unit = "mm" }]
limit_states = [{ name = "bent", output = "deflection", threshold = 10 }]
variables = [{ name = "force", mean = "500 N", std = "10 %" }, { name = "height", mean = "40 mm", std = "0.5 mm" }]
"#;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let source = SceneSource::parse(SCENE, "beam")?;
    let scene = source.nominal();
    // The deflection is proportional to force / height^3 and grows by half over the life.
    let mut beam = LocalEvaluator::new(2, |request: &Request| {
        let deflection = 7.5 * (request.sample[0] / 500.0) * (0.040 / request.sample[1]).powi(3);
        let cycles = scene.life.checkpoints();
        let history = cycles.iter().map(|n| deflection * (1.0 + 0.5 * f64::from(*n) / 1000.0)).collect();
        Ok(Evaluation::from_histories(cycles, vec![history]))
    });
    let settings = Settings { initial: 12, max_evaluations: 60, ..Settings::from(scene) };
    let summary = run(scene, &settings, &mut beam, &mut InMemoryJournal::default(), &mut Silent)?.summary;
    for row in &summary.reliability {
        let (r, error) = (row.reliability["bent"], row.standard_error["bent"]);
        println!("{:>5} cycles: R = {r:.4}, standard error {error:.4}", row.cycles);
    }
    println!("{} evaluations: {}", summary.evaluations.total, summary.convergence.stopped_because);
    Ok(())
}
