//! Scenes the tests start from.

use common::accuracy::Accuracy;
use common::outputs::Evaluation;
use common::scene::{Clearance, JointKind, Scene, SceneSource};
use worker::simulate::{SimulateOptions, simulate};

/// Radians per second in one revolution per minute.
pub const RPM: f64 = std::f64::consts::TAU / 60.0;

/// A built-in scene with some values changed: variables or keys, SI.
pub fn scene(name: &str, settings: &[(&str, f64)]) -> Scene {
    let settings: Vec<(String, f64)> = settings.iter().map(|(k, v)| ((*k).to_owned(), *v)).collect();
    SceneSource::builtin(name).expect("built in").resolve_with(&settings).expect("valid")
}

/// A mechanism that tests of several crates share.
pub fn shared(name: &str) -> Scene {
    let file = format!("{}/../common/tests/scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    SceneSource::load(&file).expect("valid").nominal().clone()
}

/// The same with a shorter life [cycles].
pub fn short(name: &str, settings: &[(&str, f64)], cycles: u32) -> Scene {
    let mut scene = scene(name, settings);
    scene.life.cycles = cycles;
    scene
}

/// Changes every joint with clearance.
pub fn every_joint(scene: &mut Scene, change: impl Fn(&mut Clearance)) {
    for joint in &mut scene.joints {
        if let JointKind::Clearance(clearance) = &mut joint.kind {
            change(clearance);
        }
    }
}

/// The evaluation of a scene.
pub fn evaluate(scene: &Scene, accuracy: &Accuracy) -> Evaluation {
    simulate(scene, accuracy, SimulateOptions::default()).expect("simulated")
}

/// The evaluation of a scene at `draft`.
pub fn draft(scene: &Scene) -> Evaluation {
    evaluate(scene, &Accuracy::draft())
}

/// The evaluation of a scene with its first cycle.
pub fn shown(scene: &Scene, accuracy: &Accuracy) -> Evaluation {
    simulate(scene, accuracy, SimulateOptions::WITH_FIRST_CYCLE).expect("simulated")
}

/// The evaluation of a scene at `reference` with its first cycle.
pub fn reference_shown(scene: &Scene) -> Evaluation {
    shown(scene, &Accuracy::reference())
}

/// History of an output at one checkpoint.
pub fn at(evaluation: &Evaluation, output: usize, cycles: u32) -> f64 {
    let k = evaluation.cycles.iter().position(|c| *c == cycles).expect("a checkpoint");
    evaluation.histories[output][k]
}

/// A published result of the flapping-wing drive, SI.
pub fn published(name: &str) -> f64 {
    common::scene::published_results("flapping-wing").unwrap()[name]
}
