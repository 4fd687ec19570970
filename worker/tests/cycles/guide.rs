//! A guide that wears, in the wear loop: this program's own mechanics as the program, against the built-in simulator; and the load of an ideal
//! slider, against a closed form.

use crate::{WORKER, assert_alike, evaluate};
use common::accuracy::Accuracy;
use common::scene::SceneSource;
use worker::simulate::{SimulateOptions, simulate};

/// A crank moves a slider of 60 by 20 mm to and fro by 40 mm, pressed down by 300 N in its middle.
const MECHANISM: &str = include_str!("scenes/guide.toml");

/// Keys of the guide in both scenes.
const RAIL: &str = r#"name = "rail", type = "guide", length = "60 mm", height = "20 mm", width = "20 mm", clearance = "20 um", guide_start = "40 mm", guide_end = "160 mm", slider_material = "steel", guide_material = "steel", wears = "SURFACES", wear_coefficient = "1e-13 1/Pa", control_points = 41"#;

const OUTPUTS: &str =
    r#"outputs = [{ name = "wear", type = "largest-wear" }, { name = "volume", type = "worn-volume" }]"#;

/// The scene of a program with these keys of `[simulator]`, in which these surfaces wear.
fn by_program(simulator: &str, surfaces: &str) -> SceneSource {
    let text = format!(
        r#"
scene = {{ name = "pressed slider by program" }}
simulator = {{ gives = "cycle", {simulator} }}
parameters = {{ load = "300 N" }}
materials.steel = {{ elastic_modulus = "207 GPa", poisson_ratio = 0.3 }}
joints = [{{ {RAIL} }}]
{OUTPUTS}
limit_states = [{{ name = "worn", output = "wear", threshold = "40 um" }}]
life = {{ period = "1 s", cycles = 20000, checkpoint_every = 4000 }}
study = {{ accuracy = "draft" }}
variables = [{{ name = "load", changes = ["parameters.load"], std = "5 %" }}]
"#
    );
    SceneSource::parse(&text.replace("SURFACES", surfaces), "guide.toml")
        .unwrap_or_else(|faults| panic!("{faults}"))
}

#[test]
fn a_guide_of_own_mechanics_wears_like_the_built_in_one() {
    let folder = tempfile::tempdir().unwrap();
    for surfaces in ["guide", "slider", "both"] {
        let path = folder.path().join(format!("{surfaces}.toml"));
        let text = MECHANISM.replace("RAIL", RAIL).replace("OUTPUTS", OUTPUTS).replace("SURFACES", surfaces);
        std::fs::write(&path, &text).unwrap();
        let own = SceneSource::parse(&text, "own").unwrap_or_else(|faults| panic!("{faults}"));
        let mut own = simulate(own.nominal(), &Accuracy::draft(), SimulateOptions::default()).unwrap();
        own.joints.retain(|joint| joint.name == "rail");
        let program = format!("program = [\"{WORKER}\", \"--serve-cycle\", \"{}\"]", path.display());
        let life = evaluate(&by_program(&format!("tier = \"contact\", {program}"), surfaces), &[300.0]);
        // Of its own cycles the error of their time steps is stated, of the program's that of their instants.
        assert_alike(&life.unwrap().unwrap(), &own, [1e-3, 2.0]);
        let life = evaluate(&by_program(&format!("tier = \"reaction\", {program}"), surfaces), &[300.0]);
        let life = life.unwrap().unwrap();
        for ((found, expected), error) in life.histories[0].iter().zip(&own.histories[0]).zip(&life.errors[0])
        {
            assert!(
                (found - expected).abs() <= error + 0.02 * expected,
                "{surfaces}: {found} +- {error}, built in {expected}"
            );
        }
    }
}

/// A program that gives this load of the slider at four places of a stroke of 40 mm, over which it slides at 80 mm/s.
fn loaded(load: &str) -> SceneSource {
    let reply = format!(
        r#"{{"id": 7, "time": [0, 0.25, 0.5, 0.75], "joints": {{"rail": {{{load}, "position": [0.08, 0.1, 0.12, 0.1], "sliding": [0.08, 0.08, 0.08, 0.08]}}}}}}"#
    );
    let script = format!("while read line; do echo '{reply}'; done");
    by_program(&format!("tier = \"reaction\", program = [\"sh\", \"-c\", '''{script}''']"), "slider")
}

#[test]
fn an_ideal_slider_wears_evenly_under_its_load() {
    let load = r#""force": [-300, -300, -300, -300], "moment": [0, 0, 0, 0]"#;
    let life = evaluate(&loaded(load), &[300.0]).unwrap().unwrap();
    let cycle = life.first_cycle.as_ref().unwrap();
    let [(rail, position)] = &cycle.slider_position[..] else { panic!("one slider") };
    // A straight line between the instants; after the last one the place stays.
    let at = |share: f64| position[(share * (position.len() - 1) as f64).round() as usize];
    assert_eq!((rail.as_str(), position.len()), ("rail", cycle.time.len()));
    for (share, expected) in [(0.0, 0.08), (0.125, 0.09), (0.5, 0.12), (0.625, 0.11)] {
        assert!((at(share) - expected).abs() < 1e-4, "{share}: {}", at(share));
    }
    // K F S / A of every cycle.
    let expected = 1e-13 * 300.0 * 0.08 / (0.06 * 0.02) * 20_000.0;
    let found = life.histories[0].last().unwrap();
    assert!((found / expected - 1.0).abs() < 1e-3, "{found}, expected {expected}");
}

#[test]
fn issue_a_guide_before_a_hinge_had_the_depths_of_the_hinge() {
    let reply = r#"{"id": 7, "time": [0, 0.25, 0.5, 0.75], "joints": {
        "rail": {"force": [-300, -300, -300, -300], "moment": [0, 0, 0, 0], "position": [0.08, 0.1, 0.12, 0.1], "sliding": [0.08, 0.08, 0.08, 0.08]},
        "pin": {"force_x": [9, 9, 9, 9], "force_y": [0, 0, 0, 0], "angle": [0, 1.5708, 3.1416, 4.7124]}}}"#;
    let reply = reply.replace('\n', "");
    let program = format!(
        "program = [\"sh\", \"-c\", \"\"\"while read line; do echo '{}'; done\"\"\"]",
        reply.replace('"', "\\\"")
    );
    let pin = "{ name = \"pin\", journal_radius = \"4 mm\", radial_clearance = \"30 um\", width = \"10 mm\", journal_material = \"steel\", \
               bushing_material = \"steel\", contact_law = \"foundation\", wear_coefficient = \"1e-13 1/Pa\" }";
    let text = by_program(&format!("tier = \"reaction\", {program}"), "slider").text().to_owned();
    let text = text.replace("control_points = 41 }]", &format!("control_points = 41 }}, {pin}]"));
    let life = evaluate(&SceneSource::parse(&text, "both.toml").unwrap(), &[300.0]).unwrap().unwrap();
    let [rail, pin] = &life.joints[..] else { panic!("two joints") };
    assert_eq!([&rail.name, &pin.name], ["rail", "pin"]);
    assert_eq!([rail.peak_force, pin.peak_force], [300.0, 9.0]);
    let wears = |depths: &[f64]| depths.iter().any(|depth| *depth > 0.0);
    assert!(wears(&pin.wear_depth) && wears(&rail.journal_wear_depth), "{rail:?}");
}

#[test]
fn loads_that_the_faces_cannot_carry_are_named() {
    for (load, said) in [
        (r#""force": [-300, -300, -300, -300]"#, "joints.rail.moment is missing"),
        (
            r#""force": [-3, -3, -3, -3], "moment": [1, 1, 1, 1], "normal": [3, 3, 3, 3]"#,
            "joints.rail.normal[0] is less than the faces need for force and moment",
        ),
        (
            r#""force": [-3, 300, -3, 300], "moment": [0, 0, 0, 0]"#,
            "joints.rail.force and moment jump between instants",
        ),
    ] {
        let found = evaluate(&loaded(load), &[300.0]).unwrap_err().to_string();
        assert!(found.contains(said), "{load}: {found}");
    }
}
