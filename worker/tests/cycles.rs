//! The wear loop around programs that give one cycle: this program's own mechanics as such a program, against the built-in simulator; the
//! journal of a life; and replies that are wrong. The programs are this worker and shell scripts.

use common::accuracy::Accuracy;
use common::external::{SampleResult, SlotError, SlotRequest, StopSignal};
use common::outputs::Evaluation;
use common::scene::SceneSource;
use worker::evaluation_slots::EvaluationSlots;
use worker::simulate::{SimulateOptions, simulate};

const WORKER: &str = env!("CARGO_BIN_EXE_worker");

/// The joints of the built-in four-bar, whose cycles a program gives.
const SCENE: &str = r#"
[scene]
name = "four-bar-by-program"
[simulator]
gives = "cycle"
PROGRAM
[parameters]
wear_coefficient = "1e-13 1/Pa"
clearance = "30 um"
load_torque = "-0.8 N m"
[materials.steel]
elastic_modulus = "206 GPa"
poisson_ratio = 0.3
[materials.bronze]
elastic_modulus = "105 GPa"
poisson_ratio = 0.34
JOINTS
[[outputs]]
name = "max_wear_depth"
type = "largest-wear"
[[outputs]]
name = "coupler_joint_speed"
unit = "rad/s"
[[limit_states]]
name = "wear"
output = "max_wear_depth"
threshold = "8 um"
[life]
period = "1/15 * 1 s"
cycles = 8000
checkpoint_every = 1000
[study]
accuracy = "draft"
[[variables]]
name = "wear_coefficient"
changes = ["parameters.wear_coefficient"]
distribution = "truncated-normal"
std = "5 %"
[[variables]]
name = "load_torque"
changes = ["parameters.load_torque"]
distribution = "truncated-normal"
std = "3 %"
[[variables]]
name = "clearance_crank"
changes = ["joints.crank.radial_clearance"]
distribution = "truncated-normal"
std = "2 um"
"#;

const JOINT: &str = r#"
[[joints]]
name = "NAME"
journal_radius = "4 mm"
radial_clearance = "clearance"
width = "10 mm"
journal_material = "steel"
bushing_material = "bronze"
contact_law = "local-hertz"
wear_coefficient = "wear_coefficient"
"#;

/// Wear coefficient, torque and clearance of the crank, off their means [1/Pa, N m, m].
const SAMPLE: [f64; 3] = [1.04e-13, -0.83, 31e-6];

/// The scene with these lines in `[simulator]`.
fn scene(program: &str) -> SceneSource {
    let joints = ["crank", "coupler", "rocker"].map(|name| JOINT.replace("NAME", name)).concat();
    let text = SCENE.replace("PROGRAM", program).replace("JOINTS", &joints);
    SceneSource::parse(&text, "four-bar-by-program.toml").unwrap_or_else(|faults| panic!("{faults}"))
}

fn evaluate(source: &SceneSource, sample: &[f64]) -> Result<SampleResult, SlotError> {
    let slots = EvaluationSlots::open(source).unwrap().unwrap();
    slots.slot(0).evaluate(SlotRequest { id: 7, level: 0, sample }, &StopSignal::default())
}

fn served(more: &str) -> SceneSource {
    scene(&format!("program = [\"{WORKER}\", \"--serve-cycle\", \"four-bar\"]\n{more}"))
}

/// The same life by the built-in simulator, with `more` in its scene.
fn built_in(more: &str) -> Evaluation {
    let own = SceneSource::parse(&format!("extends = \"four-bar\"\n{more}"), "own").unwrap();
    let [wear_coefficient, load_torque, clearance] = SAMPLE;
    let settings = [
        ("wear_coefficient", wear_coefficient),
        ("load_torque", load_torque),
        ("clearance_crank", clearance),
    ];
    let sample = own.sample_with(&settings.map(|(name, value)| (name.to_owned(), value))).unwrap();
    let scene = own.resolve_sample(&sample).unwrap();
    simulate(&scene, &Accuracy::draft(), SimulateOptions::default()).unwrap()
}

/// Operating conditions that change what the program simulates, and one of them also what the cycle wears.
const CONDITIONS: &str = r#"
[[conditions]]
name = "light"
share = 0.75
changes = { parameters.load_torque = "0.5 * load_torque" }
[[conditions]]
name = "heavy"
share = 0.25
changes = { parameters.load_torque = "1.2 * load_torque", parameters.wear_coefficient = "1.5 * wear_coefficient" }
"#;

#[test]
fn own_mechanics_as_a_program_wear_like_the_built_in_ones() {
    for conditions in ["", CONDITIONS] {
        let life = evaluate(&served(&format!("tier = \"contact\"\n{conditions}")), &SAMPLE).unwrap().unwrap();
        assert_alike(&life, &built_in(conditions), 1e-3);
    }
}

/// Asserts that the outputs of two lives agree within a share of their values, and their surfaces within twice that of the deepest place.
fn assert_alike(life: &Evaluation, own: &Evaluation, tolerance: f64) {
    assert_eq!(life.cycles, own.cycles);
    for (k, (found, expected)) in life.histories.iter().zip(&own.histories).enumerate() {
        for ((found, expected), error) in found.iter().zip(expected).zip(&life.errors[k]) {
            assert!(
                (found - expected).abs() <= tolerance * expected,
                "output {k}: {found}, built in {expected}"
            );
            assert!(*error > 0.0 && *error < 0.05 * expected);
        }
    }
    for (found, expected) in life.joints.iter().zip(&own.joints) {
        let [found, expected] = [found, expected].map(|joint| (joint.name.clone(), joint.wear_depth.clone()));
        assert_eq!(found.0, expected.0);
        let deepest = expected.1.iter().copied().fold(0.0, f64::max);
        let off = found.1.iter().zip(&expected.1).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 2.0 * tolerance * deepest, "{}: {off} of {deepest}", found.0);
    }
}

#[test]
fn one_cycle_of_ideal_joints_serves_a_whole_life() {
    let life = evaluate(&served("tier = \"reaction\""), &SAMPLE).unwrap().unwrap();
    let own = built_in("");
    assert_eq!(life.diagnostics.simulated_cycles, 1);
    let depths = life.histories[0].iter().zip(&own.histories[0]).zip(&life.errors[0]);
    for ((found, expected), error) in depths {
        // What the wear changes in the forces is left out.
        assert!(
            (found - expected).abs() <= error + 0.02 * expected,
            "{found} +- {error}, built in {expected}"
        );
    }
    assert!(life.histories[1].iter().all(|speed| *speed == life.histories[1][0]));
}

/// A program of a shell script, which may call the worker as `served`.
fn script(text: &str, more: &str) -> SceneSource {
    let text = format!("served() {{ {WORKER} --serve-cycle four-bar; }}\n{text}");
    scene(&format!("program = [\"sh\", \"-c\", '''\n{text}\n''']\n{more}"))
}

#[test]
fn a_program_that_ignores_the_surfaces_is_found_out() {
    let repeats = script(
        "read line; reply=$(echo \"$line\" | served); echo \"$reply\"; while read line; do echo \"$reply\"; done",
        "tier = \"contact\"",
    );
    let said = evaluate(&repeats, &SAMPLE).unwrap_err().to_string();
    assert!(said.contains("joints have the same contacts as on the surfaces before"), "{said}");
}

#[test]
fn a_bad_reply_is_named_with_its_field() {
    for (edit, said) in [
        ("s/force_y/force_z/g", "cycle 0: joints.crank.force_y is missing"),
        ("s/rocker/rocket/g", "cycle 0: joints.rocker is missing; found: coupler, crank, rocket"),
        ("s/:7/:8/", "its id is 8, expected 7"),
    ] {
        let edited = script(&format!("served | sed -u {edit}"), "tier = \"contact\"");
        let found = evaluate(&edited, &SAMPLE).unwrap_err().to_string();
        assert!(found.contains(said), "{edit}: {found}");
    }
}

#[test]
fn a_life_goes_on_from_its_journal() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().display();
    let more = format!("tier = \"contact\"\njournal = \"{path}\"");
    let whole = evaluate(&served("tier = \"contact\""), &SAMPLE).unwrap().unwrap();
    // Every process ends before its third reply.
    let count = format!(
        "while read line; do echo \"$line\" >> {path}/requests; [ $(wc -l < {path}/requests) -gt 2 ] && exit 1; echo \"$line\" | served; done"
    );
    let died = evaluate(&script(&count, &more), &SAMPLE).unwrap().unwrap_err().to_string();
    assert!(died.contains("exit status: 1"), "{died}");
    let requests = || std::fs::read_to_string(folder.path().join("requests")).unwrap().lines().count();
    assert_eq!(requests(), 4);
    let goes_on = format!("tee -a {path}/requests | served");
    let life = evaluate(&script(&goes_on, &more), &SAMPLE).unwrap().unwrap();
    assert_eq!((&life.histories, &life.errors), (&whole.histories, &whole.errors));
    // The two replies were not asked for again, the third one by the two processes that ended.
    assert_eq!(requests() as u64, whole.diagnostics.simulated_cycles + 2);
    let kept = std::fs::read_dir(folder.path()).unwrap().count();
    assert_eq!(kept, 1, "the journal of a life that has ended");
}

/// True if Python has these packages; else the test is skipped by their names.
fn has_packages(what: &str, packages: &str) -> bool {
    let import = std::process::Command::new("python3").args(["-c", &format!("import {packages}")]).output();
    let found = import.is_ok_and(|output| output.status.success());
    if !found {
        eprintln!("skipped: {what}: python3 has not all of {packages}");
    }
    found
}

/// A folder of the Python package.
fn python_package(inner: &str) -> std::path::PathBuf {
    std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../deploy/python")
        .join(inner)
        .canonicalize()
        .unwrap()
}

#[test]
fn the_four_bar_of_other_programs_wears_like_the_built_in_one() {
    for program in ["mujoco", "exudyn"] {
        if !has_packages("the four-bar", program) {
            continue;
        }
        let path = python_package("examples/four-bar").join(format!("{program}.toml"));
        let source = SceneSource::load(path.to_str().unwrap()).unwrap();
        let life = evaluate(&source, &SAMPLE).unwrap().unwrap();
        let own = built_in("");
        for ((found, expected), error) in life.histories[0].iter().zip(&own.histories[0]).zip(&life.errors[0])
        {
            eprintln!(
                "{program}: {found:e} +- {error:e}, built in {expected:e}: {:+.2} %",
                100.0 * (found / expected - 1.0)
            );
            // Friction, which the ideal joints have not, takes up to 2 % of the forces.
            assert!((found - expected).abs() <= error + 0.03 * expected);
        }
        let speed = life.histories[1][0] / own.histories[1][0] - 1.0;
        assert!(speed.abs() < 5e-3, "{program}: {speed}");
    }
}

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
