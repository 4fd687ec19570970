//! Outputs of the built-in scenes that wear with more control points, under every contact law, at `balanced`:
//! `cargo bench -p worker --bench resolution`, or for some scenes and with this many random points beside the nominal one (default 0):
//! `cargo bench -p worker --bench resolution -- flapping-wing four-bar 4`.
//!
//! The first table has the outputs of the motion of the nominal mechanism at the end of life; the second how often values with the
//! scene's points lie beyond their stated error, and beyond twice that, of those with twice and four times as many. Numbers of control points are
//! no part of a model here.

#[allow(dead_code, reason = "the differences are those of other benchmarks")]
mod points;

use common::accuracy::Accuracy;
use common::outputs::Evaluation;
use common::scene::{ContactLaw, ControlPoints, JointKind, Scene, SceneSource};
use points::scene_at;
use worker::simulate::{SimulateOptions, simulate};

/// Numbers of control points of the first table.
const POINTS: [usize; 5] = [18, 36, 72, 144, 288];
/// Share of the range of the variables that random points take.
const SHARE: f64 = 0.4;

fn main() {
    let named: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with("--")).collect();
    let random: u32 = named.iter().find_map(|word| word.parse().ok()).unwrap_or(0);
    let scenes: Vec<&String> = named.iter().filter(|word| word.parse::<u32>().is_err()).collect();
    let names = SceneSource::builtin_names().into_iter();
    let sources: Vec<(&str, SceneSource)> = names
        .filter(|name| scenes.is_empty() || scenes.iter().any(|scene| scene == name))
        .map(|name| (name, SceneSource::builtin(name).expect("built in")))
        .filter(|(_, source)| source.nominal().joints.iter().any(|joint| wears(&joint.kind)))
        .collect();
    println!("| scene | law | output | {} |", POINTS.map(|n| format!("{n} points (stated)")).join(" | "));
    println!("|---|---|---|{}", "---|".repeat(POINTS.len()));
    for (name, source) in &sources {
        ContactLaw::ALL.into_iter().for_each(|law| at_end_of_life(name, &scene_at(source, 0, SHARE), law));
    }
    println!(
        "\n| scene | law | output | values | beyond of twice, twice that | worst | beyond of four times | worst |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for (name, source) in &sources {
        ContactLaw::ALL.into_iter().for_each(|law| coverage(name, source, law, random));
    }
}

fn wears(kind: &JointKind) -> bool {
    matches!(kind, JointKind::Clearance(clearance) if clearance.wear_coefficients() != [0.0; 2])
}

/// The evaluation of `scene` under `law` with this many times its control points, or with this number of them.
fn evaluation(scene: &Scene, law: ContactLaw, points: impl Fn(usize) -> usize) -> Result<Evaluation, String> {
    let mut scene = scene.clone();
    scene.control_points_of_model = false;
    for joint in &mut scene.joints {
        if let JointKind::Clearance(clearance) = &mut joint.kind {
            clearance.contact_law = law;
            clearance.control_points = ControlPoints::Number(points(clearance.control_points.number()));
        }
    }
    simulate(&scene, &Accuracy::balanced(), SimulateOptions::default()).map_err(|failure| failure.to_string())
}

/// Prints the outputs of the motion at the end of life over the points.
fn at_end_of_life(name: &str, nominal: &Scene, law: ContactLaw) {
    let found = POINTS.map(|points| evaluation(nominal, law, |_| points));
    for (k, output) in nominal.outputs.iter().enumerate().filter(|(_, output)| output.kind.wear().is_none()) {
        let unit = output.kind.unit();
        let cell = |found: &Result<Evaluation, String>| {
            let last = |found: &Evaluation| {
                let [value, error] = [&found.histories, &found.errors].map(|rows| rows[k].last().copied());
                Some((unit.to_shown(value?), unit.to_shown(error?)))
            };
            let shown = found.as_ref().ok().and_then(last);
            shown.map_or_else(|| "failed".to_owned(), |(value, error)| format!("{value:.4} ({error:.1e})"))
        };
        let cells = found.each_ref().map(cell).join(" | ");
        println!("| `{name}` | `{}` | {} [{}] | {cells} |", law.word(), output.name, unit.symbol());
    }
}

/// Prints the coverage of the stated errors of every output at the nominal point and this many `random` ones.
fn coverage(name: &str, source: &SceneSource, law: ContactLaw, random: u32) {
    let scenes: Vec<Scene> = (0..=random).map(|point| scene_at(source, point, SHARE)).collect();
    let times = |scene, times| evaluation(scene, law, |own| times * own);
    let found: Vec<[Result<Evaluation, String>; 3]> =
        scenes.iter().map(|scene| [1, 2, 4].map(|n| times(scene, n))).collect();
    for (k, output) in source.nominal().outputs.iter().enumerate() {
        let ratios = |finer: usize| -> Vec<f64> {
            let both = found.iter().filter_map(|all| all[0].as_ref().ok().zip(all[finer].as_ref().ok()));
            both.flat_map(|(own, finer)| {
                let values = own.histories[k].iter().zip(&finer.histories[k]);
                values.zip(&own.errors[k]).map(|((own, finer), error)| (own - finer).abs() / error)
            })
            .collect()
        };
        let cells = [1, 2].map(|finer| {
            let all = ratios(finer);
            let beyond = |bound: f64| all.iter().filter(|ratio| **ratio > bound).count();
            let worst = all.iter().copied().fold(0.0, f64::max);
            format!("{}, {} | {worst:.2}", beyond(1.0), beyond(2.0))
        });
        let values = ratios(1).len();
        println!("| `{name}` | `{}` | {} | {values} | {} |", law.word(), output.name, cells.join(" | "));
    }
}
