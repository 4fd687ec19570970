//! The wear loop around programs that give one cycle: this program's own mechanics as such a program, against the built-in simulator; the
//! journal of a life; and replies that are wrong. The programs are this worker and shell scripts, FMUs and models of a UM-Bridge server.

mod fmu;
mod guide;
mod umbridge;

use common::accuracy::Accuracy;
use common::external::{SampleResult, SlotError, SlotRequest, StopSignal};
use common::outputs::{BodyTrace, Evaluation};
use common::scene::SceneSource;
use worker::evaluation_slots::EvaluationSlots;
use worker::simulate::{SimulateOptions, simulate};

const WORKER: &str = env!("CARGO_BIN_EXE_worker");

/// The joints of the built-in four-bar, whose cycles a program gives.
const SCENE: &str = include_str!("scenes/cycles.toml");

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
    let request = SlotRequest { id: 7, level: 0, with_first_cycle: true, sample };
    slots.slot(0).evaluate(request, &StopSignal::default())
}

fn served(more: &str) -> SceneSource {
    scene(&format!("program = [\"{WORKER}\", \"--serve-cycle\", \"four-bar\"]\n{more}"))
}

/// The same life by the built-in simulator, with `more` in its scene.
fn built_in(more: &str) -> Evaluation {
    own_life(more, SimulateOptions::default())
}

fn own_life(more: &str, options: SimulateOptions) -> Evaluation {
    let own =
        SceneSource::parse(&format!("scene = {{ extends = \"four-bar\", name = \"own\" }}\n{more}"), "own")
            .unwrap();
    let [wear_coefficient, load_torque, clearance] = SAMPLE;
    let settings = [
        ("wear_coefficient", wear_coefficient),
        ("load_torque", load_torque),
        ("clearance_crank", clearance),
    ];
    let sample = own.sample_with(&settings.map(|(name, value)| (name.to_owned(), value))).unwrap();
    let scene = own.resolve_sample(&sample).unwrap();
    simulate(&scene, &Accuracy::draft(), options).unwrap()
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
        // Its own cycles are probed for the error of their time steps.
        assert_alike(&life, &built_in(conditions), [1e-5, 0.2]);
    }
}

/// Asserts that outputs and stated errors of two lives agree within shares of their values, and their surfaces within that of the deepest
/// place.
fn assert_alike(life: &Evaluation, own: &Evaluation, [of_values, of_errors]: [f64; 2]) {
    assert_eq!(life.cycles, own.cycles);
    let of = |of: &[Vec<f64>]| of.concat();
    let values = of(&own.histories);
    for (k, (found, expected)) in of(&life.histories).iter().zip(&values).enumerate() {
        assert!((found - expected).abs() <= of_values * expected, "value {k}: {found}, built in {expected}");
    }
    for (k, (found, expected)) in of(&life.errors).iter().zip(of(&own.errors)).enumerate() {
        // Errors of a hundredth of what the values may differ by tell nothing.
        let least = 0.01 * of_values * values[k];
        let off = (found - expected).abs();
        assert!(
            off <= of_errors * expected || found.max(expected) <= least,
            "error {k}: {found}, {expected}"
        );
    }
    for (found, expected) in life.joints.iter().zip(&own.joints) {
        assert_eq!(found.name, expected.name);
        let deepest = expected.wear_depth.iter().copied().fold(0.0, f64::max);
        let pairs = found.wear_depth.iter().zip(&expected.wear_depth);
        let off = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off <= of_values * deepest, "{}: {off} of {deepest}", found.name);
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

#[test]
fn cycles_of_a_program_are_displayed_as_those_of_the_built_in_mechanics() {
    let life = evaluate(&served("tier = \"contact\""), &SAMPLE).unwrap().unwrap();
    let own = own_life("", SimulateOptions::WITH_FIRST_CYCLE);
    let last = |life: &Evaluation| life.worn.as_ref().and_then(|worn| worn.last_cycle.clone());
    for (found, expected) in [(life.first_cycle.clone(), own.first_cycle.clone()), (last(&life), last(&own))]
    {
        let (found, expected) = (found.unwrap(), expected.unwrap());
        assert_eq!(found.time, expected.time);
        for (of_program, built_in) in found.joint_force.iter().zip(&expected.joint_force) {
            assert_eq!(of_program.0, built_in.0);
            let squares = |values: &mut dyn Iterator<Item = f64>| values.map(|x| x * x).sum::<f64>();
            let pairs = of_program.1.iter().zip(&built_in.1);
            let off = squares(&mut pairs.map(|(a, b)| a - b)) / squares(&mut built_in.1.iter().copied());
            assert!(off.sqrt() < 0.2, "{}: {}", of_program.0, off.sqrt());
            let journal = found.journal(&of_program.0).unwrap();
            let clearance = if of_program.0 == "crank" { SAMPLE[2] } else { 30e-6 };
            for ((force, e), size) in journal.force.iter().zip(&journal.eccentricity).zip(&of_program.1) {
                let reach = e[0].hypot(e[1]);
                assert!(reach < clearance + 20e-6, "{}: {reach}", of_program.0);
                // A straight line between two vectors is within that between their sizes.
                assert!(force[0].hypot(force[1]) <= size + 1e-9);
            }
        }
        let turns = |body: &BodyTrace| (body.angle[1000] - body.angle[0]).abs() / std::f64::consts::TAU;
        let whole = found.bodies.iter().map(|body| (body.label.as_str(), turns(body).round()));
        assert_eq!(whole.collect::<Vec<_>>(), [("crank", 1.0), ("coupler", 0.0), ("rocker", 0.0)]);
    }
    let [worn, of_own] = [&life, &own].map(|life| life.worn.as_ref().unwrap());
    assert_eq!((&worn.cycles, worn.wear_depth.len()), (&of_own.cycles, of_own.wear_depth.len()));
    let reaction = evaluate(&served("tier = \"reaction\""), &SAMPLE).unwrap().unwrap();
    assert!(reaction.first_cycle.is_some() && last(&reaction).is_none(), "one cycle serves the whole life");
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
