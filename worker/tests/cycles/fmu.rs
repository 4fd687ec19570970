//! FMUs that give cycles and lives: a slider-crank with a controlled motor, made by pythonfmu.

use crate::{evaluate, has_packages, python_package};
use common::scene::SceneSource;
use worker::evaluation_slots::EvaluationSlots;

/// The scene of the slider-crank in a new folder with its FMU, with a Python that has this package; `None` without its packages.
fn slider_crank() -> Option<(tempfile::TempDir, String)> {
    if !has_packages("an FMU", "fmpy, pythonfmu") {
        return None;
    }
    let (folder, example) = (tempfile::tempdir().unwrap(), python_package("examples/fmu"));
    let build = std::process::Command::new("python3")
        .args(["-m", "pythonfmu", "build", "-f"])
        .arg(example.join("slider_crank.py"))
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert!(build.status.success(), "{}", String::from_utf8_lossy(&build.stderr));
    let python = folder.path().join("python");
    let script = format!("#!/bin/sh\nPYTHONPATH={} exec python3 \"$@\"\n", python_package(".").display());
    std::fs::write(&python, script).unwrap();
    std::fs::set_permissions(&python, std::os::unix::fs::PermissionsExt::from_mode(0o755)).unwrap();
    let text = std::fs::read_to_string(example.join("slider-crank.toml")).unwrap();
    Some((folder, text.replace("fmu =", "python = \"./python\"\nfmu =")))
}

/// The scene of a text in a folder.
fn scene_in(folder: &std::path::Path, text: &str) -> SceneSource {
    let path = folder.join("fmu.toml");
    std::fs::write(&path, text).unwrap();
    SceneSource::load(path.to_str().unwrap()).unwrap_or_else(|faults| panic!("{faults}"))
}

#[test]
fn a_wrong_fmu_is_named_with_its_key() {
    let Some((folder, text)) = slider_crank() else { return };
    std::fs::write(folder.path().join("Text.fmu"), "no archive").unwrap();
    let old = "import zipfile as z; z.ZipFile('Old.fmu', 'w').writestr('modelDescription.xml', '<f fmiVersion=\"1.0\"/>')";
    let made = std::process::Command::new("python3").args(["-c", old]).current_dir(folder.path()).status();
    assert!(made.unwrap().success());
    for (from, to, said) in [
        ("SliderCrank.fmu", "Slider.fmu", "simulator.fmu: \"Slider.fmu\" cannot be started in"),
        ("SliderCrank.fmu", "Old.fmu", "simulator.fmu: Old.fmu is of FMI 1.0, expected 2.0 or 3.0"),
        ("SliderCrank.fmu", "Text.fmu", "simulator.fmu: Text.fmu cannot be read: File is not a zip file"),
        (
            "pin_turn",
            "pin_turned",
            "simulator.map: pin.angle: SliderCrank.fmu has no variable pin_turned; did you mean pin_turn?",
        ),
        (
            "largest(torque)",
            "largest(tork)",
            "simulator.map: peak: SliderCrank.fmu has no variable tork; did you mean torque?",
        ),
        (
            "largest(",
            "biggest(",
            "simulator.map: peak: biggest(...) is not known; known: largest, smallest, mean, last",
        ),
        (
            "pin.angle",
            "pins.angle",
            "simulator.map: pins.angle is no input, output or field of a joint; did you mean pin.angle?",
        ),
        (
            "name = \"load\"",
            "name = \"laod\"",
            "simulator.map: SliderCrank.fmu has no variable laod; did you mean load?",
        ),
    ] {
        assert!(text.contains(from), "{from}");
        let source = scene_in(folder.path(), &text.replacen(from, to, 1));
        let found = match EvaluationSlots::open(&source).unwrap() {
            Err(error) => error.to_string(),
            Ok(_) => evaluate(&source, &[5.0, 1e-13]).unwrap_err().to_string(),
        };
        assert!(found.contains(said), "{to}: {found}");
    }
}

#[test]
fn an_fmu_gives_a_whole_life() {
    let Some((folder, _)) = slider_crank() else { return };
    let text = r#"
scene = { name = "speed" }
simulator = { KEYS, map = { fastest = "largest(speed)" } }
life = { cycles = 2, checkpoint_every = 1 }
outputs = [{ name = "fastest", unit = "rad/s" }, { name = "speed", unit = "rad/s" }]
limit_states = [{ name = "fast", output = "fastest", threshold = 100 }]
variables = [{ name = "load", mean = 5, std = "5 %" }]
"#
    .replace("KEYS", "python = \"./python\", fmu = \"SliderCrank.fmu\"");
    let life = evaluate(&scene_in(folder.path(), &text), &[5.0]).unwrap().unwrap();
    assert_eq!(life.cycles, [1, 2]);
    let [fastest, speed] = [&life.histories[0], &life.histories[1]];
    // The controller lets the speed of 20 pi rad/s go up and down.
    assert!(
        fastest[0] > 62.9 && fastest[1] >= fastest[0] && (40.0..fastest[1]).contains(&speed[1]),
        "{life:?}"
    );
}

#[test]
fn an_fmu_wears_its_pin() {
    let Some((folder, text)) = slider_crank() else { return };
    let source = scene_in(folder.path(), &text);
    let life = |load| evaluate(&source, &[load, 1e-13]).unwrap().unwrap();
    let (light, heavy) = (life(5.0), life(10.0));
    // Archard: V = K F s, in proportion to the cycles.
    let [first, .., last] = light.histories[0][..] else { panic!("four checkpoints") };
    assert!((last / first / 4.0 - 1.0).abs() < 0.02, "{:?}", light.histories[0]);
    // The controlled crank turns at 20 pi rad/s to some per cent.
    let expected = 4000.0 * 1e-13 * 5e-3 * force_over_turn(5.0);
    assert!((last / expected - 1.0).abs() < 0.08, "{last}, at constant speed {expected}");
    assert!(heavy.histories[0][3] > 1.01 * last && heavy.histories[1][0] > 1.1 * light.histories[1][0]);
}

/// Integral over a turn of the crank at constant speed of the force on its pin over the angle in the rod's bore [N rad], under a `load` of the
/// slider [N]: crank of 20 mm, massless rod of 80 mm, slider of 0.5 kg.
fn force_over_turn(load: f64) -> f64 {
    use std::f64::consts::{PI, TAU};
    let (crank, rod, speed) = (0.02_f64, 0.08_f64, 20.0 * PI);
    let parts = 2000;
    let at = |k: i32| {
        let (s, c) = (TAU * (f64::from(k) + 0.5) / f64::from(parts)).sin_cos();
        let root = (rod * rod - (crank * s).powi(2)).sqrt();
        let bent = crank * crank * (c * c - s * s) / root + crank.powi(4) * (s * c).powi(2) / root.powi(3);
        let inertia = -0.5 * speed * speed * (crank * c + bent);
        let cosine = root / rod;
        ((inertia + load) / cosine).abs() * (1.0 + crank * c / rod / cosine) * TAU / f64::from(parts)
    };
    (0..parts).map(at).sum()
}
