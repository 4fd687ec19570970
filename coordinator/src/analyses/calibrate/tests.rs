//! Calibrations of the four-bar with a stand-in in closed form for its simulation, so that the right answer is known.

use super::responses::depth;
use super::target_file::TargetQuantity;
use super::{
    CalibrationResult, CalibrationSettings, CalibrationTargets, Space, answer, calibrate, of_parameters,
    read_targets,
};
use crate::analyses::error::AnalysisError;
use crate::farm::evaluate::Request;
use crate::farm::evaluate::local::LocalEvaluator;
use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::outputs::{Evaluation, JointSummary};
use common::random::standard_normal_cdf;
use common::scene::{Faults, InputFile, Scene, SceneSource};
use std::path::Path;

const PARAMETERS: &str = r#"
[[parameters]]
name = "width"
changes = ["parameters.width"]
lower = "5 mm"
upper = "15 mm"

[[parameters]]
name = "wear"
mean_of = ["wear_coefficient"]
lower = 0.5
upper = 2.0

[[parameters]]
name = "spread of wear"
spread_of = ["wear_coefficient"]
lower = 0.5
upper = 2.0
"#;

fn four_bar() -> SceneSource {
    SceneSource::builtin("four-bar").unwrap()
}

/// Wear in proportion to coefficient and life, over the width; a peak force that grows with the width; a bore deepest at 90
/// degrees.
fn stand_in(scene: &Scene, request: &Request) -> Result<Evaluation, SimulationFailure> {
    let (coefficient, width) = (request.sample[0], request.sample[scene.variables.len()]);
    let nominal = scene.variables[0].distribution.mean();
    let end = 8e-6 * coefficient / nominal * 0.01 / width;
    let cycles = scene.life.checkpoints();
    let last = f64::from(scene.life.cycles);
    let history = cycles.iter().map(|n| end * f64::from(*n) / last).collect();
    let bore = |k: usize| end * 0.5 * (1.0 + (k as f64 * 10.0_f64.to_radians()).sin());
    let joint = |joint: &common::scene::Joint| JointSummary {
        name: joint.name.clone(),
        peak_force: 20.0 + 1000.0 * width,
        wear_depth: (0..36).map(bore).collect(),
        journal_wear_depth: Vec::new(),
    };
    Ok(Evaluation {
        histories: vec![history, vec![1.0; cycles.len()]],
        cycles,
        errors: vec![],
        joints: scene.joints.iter().map(joint).collect(),
        ..Evaluation::default()
    })
}

fn parse_targets(text: &str, path: &Path, source: &SceneSource) -> Result<CalibrationTargets, Faults> {
    read_targets(&InputFile::parse(text, &path.display().to_string())?, source)
}

fn fitted(targets: &str) -> Result<CalibrationResult, AnalysisError> {
    let source = four_bar();
    let scene = source.nominal();
    let targets = parse_targets(&format!("{PARAMETERS}{targets}"), Path::new("targets.toml"), &source)?;
    let space = Space::new(&source, &targets.free)?;
    let settings = CalibrationSettings { simulations: 60, rounds: 1, seed: 1, accuracy: Accuracy::draft() };
    let mut evaluator = LocalEvaluator::new(2, |request: &Request| stand_in(scene, request));
    calibrate(&targets, &settings, &mut evaluator, &space, &mut |_| {})
}

#[test]
fn known_parameters_are_found_with_their_uncertainties() {
    let source = four_bar();
    let law = source.nominal().variables[0].distribution.clone();
    // Width 8 mm, wear 1.2, spread 1.5: mean wear 8 um * 1.2 / 0.8 at the end, and R there.
    let (mean, std) = (12e-6, 8e-6 * 1.5 * law.std() / law.mean() / 0.8);
    let reliability = standard_normal_cdf((8e-6 * 8.0 / 6.0 - mean) / std);
    let targets = format!(
        r#"
        [[targets]]
        output = "max_wear_depth"
        cycles = 8000
        statistic = "mean"
        value = "12 um"
        tolerance = "0.1 um"
        [[targets]]
        name = "spread"
        output = "max_wear_depth"
        cycles = 8000
        statistic = "std"
        value = "{std} m"
        tolerance = "0.05 um"
        [[targets]]
        joint = "crank"
        statistic = "peak-force"
        value = "28 N"
        tolerance = "0.1 N"
        "#
    );
    assert!(reliability > 0.0);
    let found = fitted(&targets).unwrap();
    for (parameter, right) in found.parameters.iter().zip([8e-3, 1.2, 1.5]) {
        let off = (parameter.value - right).abs();
        assert!(off < parameter.uncertainty && off < 0.04 * right, "{parameter:?} {right}");
        assert!(parameter.determined && !parameter.on_bound, "{parameter:?}");
    }
    // The force determines the width to 0.1 mm; the wear is then determined to 0.1 / 12 and 0.1 / 8 combined.
    assert!((found.parameters[0].uncertainty / 1e-4 - 1.0).abs() < 0.1, "{found:?}");
    assert!((found.parameters[1].uncertainty / 0.018 - 1.0).abs() < 0.2, "{found:?}");
    assert!(found.correlation[0][1] > 0.5 && found.conflicts.is_empty(), "{found:?}");
    assert_eq!((found.simulations, found.failed), (80, 0));
    let text = answer(&found, "four-bar").text();
    assert!(text.contains("| mean of max_wear_depth at 8000 | 12.00 um |"), "{text}");
}

#[test]
fn targets_that_contradict_each_other_are_named() {
    let wear = |name: &str, value: &str| {
        format!(
            "[[targets]]\nname = \"{name}\"\noutput = \"max_wear_depth\"\ncycles = 8000\nstatistic = \"nominal\"\n\
             value = \"{value}\"\ntolerance = \"0.2 um\"\n"
        )
    };
    let found = fitted(&(wear("bench one", "8 um") + &wear("bench two", "10 um"))).unwrap();
    let names: Vec<&str> = found.conflicts.iter().map(|conflict| conflict.target.as_str()).collect();
    assert_eq!(names, ["bench one", "bench two"]);
    let first = &found.conflicts[0];
    assert!(first.alone.abs() < 0.1 && first.costs[0].0 == "bench two", "{first:?}");
    // No target depends on the spread, and wear alone does not distinguish width and coefficient.
    assert!(!found.parameters[2].determined, "{found:?}");
    assert!(found.correlation[0][1] > 0.8, "{found:?}");
    // Far outside of what the bounds allow.
    let found = fitted(&wear("bench three", "100 um")).unwrap();
    assert!(found.conflicts[0].alone.abs() > 100.0 && found.parameters[1].on_bound, "{found:?}");
    assert!(answer(&found, "four-bar").text().contains("No parameters within the bounds meet it"));
}

#[test]
fn a_measured_profile_is_read_from_a_file() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("bore.csv"), "angle,depth\n0,5\n90,10\n270,0\n").unwrap();
    let text = format!(
        "{PARAMETERS}[[targets]]\njoint = \"rocker\"\nprofile = \"bore.csv\"\ntolerance = \"0.1 um\"\n"
    );
    let source = four_bar();
    let read = |text: &str| parse_targets(text, &folder.path().join("targets.toml"), &source);
    let targets = read(&text).unwrap().targets;
    let values: Vec<f64> = targets.iter().map(|target| (target.value * 1e9).round()).collect();
    assert_eq!(values, [5000.0, 10_000.0, 0.0]);
    assert_eq!(targets[1].name, "bore rocker at 90 deg");
    let bore = [0.0, 1.0, 2.0, 1.0];
    assert_eq!(
        [0.0, 45.0, 180.0, 315.0, -45.0].map(|a: f64| (depth(&bore, a.to_radians()) * 1e9).round()),
        [0.0, 0.5e9, 2e9, 0.5e9, 0.5e9]
    );
    std::fs::write(folder.path().join("bore.csv"), "0,five\n").unwrap();
    let error = read(&text).unwrap_err().to_string();
    assert!(error.contains("bore.csv: profile: expected an angle in degrees and a depth in um"), "{error}");
}

#[test]
fn a_target_is_the_depth_at_one_angle() {
    let source = four_bar();
    let row = |angle: &str| {
        let text = format!(
            "{PARAMETERS}[[targets]]\njoint = \"rocker\"\nstatistic = \"depth\"\n{angle}\nvalue = \"5 um\"\ntolerance = \"0.1 um\"\n"
        );
        parse_targets(&text, Path::new("targets.toml"), &source)
    };
    let target = &row("angle = \"-90 deg\"").unwrap().targets[0];
    let TargetQuantity::Depth { joint, angle } = target.quantity else { panic!("{target:?}") };
    assert_eq!((joint, target.name.as_str()), (2, "depth of bore rocker at -90 deg"));
    assert!((angle + 0.5 * std::f64::consts::PI).abs() < 1e-12 && (target.value - 5e-6).abs() < 1e-20);
    let error = row("").unwrap_err().to_string();
    assert!(error.contains("targets[1].angle: is missing, expected an angle"), "{error}");
    let error = row("angle = \"1 mm\"").unwrap_err().to_string();
    assert!(error.contains("targets[1].angle: \"1 mm\" is a length, expected an angle"), "{error}");
}

#[test]
fn a_target_may_name_a_published_result() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("published.toml"), "[published]\nwear = \"12 um\"\n").unwrap();
    let target = "[[targets]]\noutput = \"max_wear_depth\"\ncycles = 8000\nstatistic = \"mean\"\nvalue = \"wear\"\ntolerance = \"1 um\"\n";
    let source = four_bar();
    let read = |reference: &str| {
        let text = format!("{reference}\n{PARAMETERS}{target}");
        parse_targets(&text, &folder.path().join("targets.toml"), &source)
    };
    let target = &read("reference = \"published.toml\"").unwrap().targets[0];
    assert!((target.value - 12e-6).abs() < 1e-20 && target.unit.symbol == "um", "{target:?}");
    assert!(read("").unwrap_err().to_string().contains("no unit, parameter or function `wear`"));
    let error = read("reference = \"none.toml\"").unwrap_err().to_string();
    assert!(error.contains("none.toml: cannot be read: there is no such file"), "{error}");
}

#[test]
fn faults_of_the_file_are_named_with_their_key() {
    let target = "[[targets]]\noutput = \"max_wear_depth\"\ncycles = 8000\nstatistic = \"mean\"\nvalue = \"12 um\"\ntolerance = \"1 um\"\n";
    for [from, to, expected] in crate::tests::rows("faults_of_the_file_are_named_with_their_key") {
        let text = format!("{PARAMETERS}{target}");
        assert!(text.contains(from), "{from}");
        let source = four_bar();
        let text = text
            .replacen(from, to, 1)
            .replace("clearance\"]\nlower = \"5 mm\"", "clearance\"]\nlower = \"5 N\"");
        let file = InputFile::parse(&text, "t.toml").unwrap();
        let found = read_targets(&file, &source).and_then(|targets| {
            Space::new(&source, &targets.free).map_err(|error| of_parameters(&file, &targets, error))
        });
        let Err(faults) = found else { panic!("{to}") };
        assert!(faults.to_string().contains(expected), "{to}: {faults}");
        assert!(faults.0.iter().all(|fault| fault.location.is_some()), "{to}: {faults:?}");
    }
}

#[test]
fn issue_all_faults_of_targets_are_reported_at_once_with_their_lines() {
    let text = "[[parameters]]\nname = \"friction\"\nmean_of = [\"frictoin\"]\nlower = 0.5\nupper = 2\n\
        [[targets]]\noutput = \"max_wear_dpth\"\ncycles = 8000\nstatistic = \"mean\"\nvalue = \"12 um\"\n\
        tolerance = \"1 N\"\n[[targets]]\nlimit_state = \"waer\"\ncycles = 8000\nvalue = 0.9\ntolerance = \"1 N\"\n";
    let Faults(faults) = parse_targets(text, Path::new("t.toml"), &four_bar()).unwrap_err();
    let lines: Vec<usize> = faults.iter().map(|fault| fault.location.as_ref().unwrap().line).collect();
    assert_eq!(lines, [3, 7, 11, 13, 16], "{faults:#?}");
    for (fault, meant) in faults.iter().zip(["friction", "max_wear_depth", "", "wear"]) {
        assert!(
            meant.is_empty() || fault.to_string().contains(&format!("did you mean \"{meant}\"?")),
            "{fault}"
        );
    }
}
