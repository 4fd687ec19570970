//! Convergence of the largest wear over the control points of the profiles, the length of the blocks and the number of contact samples,
//! for every built-in scene that wears, under both contact laws: `cargo bench -p worker --bench control_points`, or for those named:
//! `cargo bench -p worker --bench control_points -- four-bar`.
//! At the nominal point and the end of life; every column but the first of each group changes one choice of `balanced` at 36 points.

use common::accuracy::Accuracy;
use common::outputs::Evaluation;
use common::scene::{ContactLaw, ControlPoints, JointKind, OutputKind, Scene, SceneSource};
use worker::simulate::{SimulateOptions, simulate};

/// Numbers of control points.
const POINTS: [usize; 5] = [18, 36, 72, 144, 288];
/// Lengths of the blocks [cycles].
const BLOCKS: [u32; 3] = [500, 1000, 4000];
/// Contact samples of a cycle.
const SAMPLES: [usize; 2] = [150, 1200];

fn with(scene: &Scene, law: ContactLaw, points: usize) -> Scene {
    let mut scene = scene.clone();
    for joint in &mut scene.joints {
        if let JointKind::Clearance(clearance) = &mut joint.kind {
            (clearance.contact_law, clearance.control_points) = (law, ControlPoints::Number(points));
        }
    }
    scene
}

/// Largest wear at the end of life and its stated error [m].
fn largest_wear(scene: &Scene, evaluation: &Evaluation) -> Option<(f64, f64)> {
    let output =
        scene.outputs.iter().position(|output| matches!(output.kind, OutputKind::LargestWear { .. }))?;
    Some((*evaluation.histories[output].last()?, *evaluation.errors[output].last()?))
}

fn main() {
    println!("| scene | law | wear at 288 points | {} |", headings().join(" | "));
    println!("|---|---|---|{}", "---|".repeat(headings().len()));
    // Cargo itself adds `--bench`.
    let named: Vec<String> = std::env::args().skip(1).filter(|name| !name.starts_with("--")).collect();
    for name in SceneSource::builtin_names().into_iter().filter(|name| is_named(&named, name)) {
        let source = SceneSource::builtin(name).expect("built in");
        let nominal = source.resolve_sample(&source.means()).expect("means are within bounds");
        if !nominal.outputs.iter().any(|output| matches!(output.kind, OutputKind::LargestWear { .. })) {
            continue;
        }
        for law in ContactLaw::ALL {
            row(name, &nominal, law);
        }
    }
}

/// True if the scene is among those named, or none is.
fn is_named(named: &[String], scene: &str) -> bool {
    named.is_empty() || named.iter().any(|name| name == scene)
}

fn headings() -> Vec<String> {
    let points = POINTS[..4].iter().map(|n| format!("{n} points (stated)"));
    let blocks = BLOCKS.iter().map(|n| format!("blocks of {n}"));
    points.chain(blocks).chain(SAMPLES.iter().map(|n| format!("{n} samples"))).collect()
}

/// Prints the differences of one scene under one law: over the points from the finest, of the rest from `balanced`.
fn row(name: &str, nominal: &Scene, law: ContactLaw) {
    let balanced = Accuracy::balanced();
    let wear = |points: usize, accuracy: Accuracy| {
        let scene = with(nominal, law, points);
        let evaluation = simulate(&scene, &accuracy, SimulateOptions::default());
        evaluation.map_err(|failure| failure.to_string()).map(|e| largest_wear(&scene, &e).expect("it wears"))
    };
    let percent = |value: f64, of: f64| format!("{:+.2} %", 100.0 * (value / of - 1.0));
    let over_points = POINTS.map(|points| wear(points, balanced));
    // The finest that can be simulated; a failure is shown in its place.
    let finest = over_points.iter().rposition(Result::is_ok);
    let mut cells: Vec<String> = over_points[..4]
        .iter()
        .map(|found| match (found, finest.map(|k| &over_points[k])) {
            (Ok((depth, stated)), Some(Ok((of, _)))) => {
                format!("{} ({:.2} %)", percent(*depth, *of), 100.0 * stated / of)
            }
            _ => "failed".to_owned(),
        })
        .collect();
    let blocks = BLOCKS.map(|cycle_jump| Accuracy { cycle_jump, ..balanced });
    let samples = SAMPLES.map(|wear_samples| Accuracy { wear_samples, ..balanced });
    for accuracy in blocks.into_iter().chain(samples) {
        cells.push(match (wear(36, accuracy), &over_points[1]) {
            (Ok((depth, _)), Ok((of, _))) => percent(depth, *of),
            _ => "failed".to_owned(),
        });
    }
    let depth = match (&over_points[4], finest.map(|k| (POINTS[k], &over_points[k]))) {
        (Ok((depth, _)), _) => format!("{:.3} µm", depth * 1e6),
        (Err(failure), Some((points, Ok((depth, _))))) => {
            format!("{failure}; with {points} {:.3} µm", depth * 1e6)
        }
        (Err(failure), _) => failure.clone(),
    };
    println!("| `{name}` | `{}` | {depth} | {} |", law.word(), cells.join(" | "));
}
