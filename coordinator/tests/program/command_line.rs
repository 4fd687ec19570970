//! What the real `coordinator` prints when all is well, against the names that scripts and notebooks rely on.

use crate::{coordinator, json, printed as text};
use serde_json::Value;

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

fn keys(value: &Value) -> Vec<&str> {
    value.as_object().unwrap().keys().map(String::as_str).collect()
}

#[test]
fn simulate_prints_the_contract() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("out.json");
    let simulate = ["simulate", "four-bar", "--accuracy", "draft"];
    let output = coordinator(&[&simulate[..], &["--out", file.to_str().unwrap()]].concat());
    assert!(output.stderr.is_empty());
    let said = String::from_utf8(output.stdout).unwrap();
    let lines: Vec<&str> = said.lines().collect();
    assert!(lines.len() == 6 && lines[0].starts_with("four-bar: 8 000 cycles, accuracy draft, "), "{said}");
    assert!(
        lines[1].starts_with("max_wear_depth: 0 unworn, ") && lines[1].ends_with(" µm at the end of life"),
        "{said}"
    );
    let groove = "joint crank: a groove at ";
    assert!(lines[4].starts_with(groove) && lines[4].contains(" is narrower than the journal"), "{said}");
    assert!(
        lines[3].starts_with("limit state wear: ") && lines[3].contains("limit 8.00 µm, margin "),
        "{said}"
    );
    assert!(lines[3].contains("reached after about 5 9"), "{said}");
    let quiet = coordinator(&[&simulate[..], &["-q", "--out", file.to_str().unwrap()]].concat());
    assert!(quiet.status.success() && quiet.stdout.is_empty() && quiet.stderr.is_empty());
    let found: Value = serde_json::from_str(&std::fs::read_to_string(&file).unwrap()).unwrap();

    assert_eq!((found["scene"].as_str(), found["accuracy"].as_str()), (Some("four-bar"), Some("draft")));
    let cycles: Vec<f64> = (1..=8).map(|k| 1000.0 * f64::from(k)).collect();
    assert_eq!(numbers(&found["cycles"]), cycles);
    let wear = numbers(&found["max_wear_depth_m"]);
    assert_eq!(wear.len(), cycles.len());
    assert!(wear[0] > 0.0 && wear.is_sorted(), "wear only grows: {wear:?}");
    assert_eq!(found["coupler_joint_speed_rpm"].as_array().unwrap().len(), cycles.len());

    let first = &found["first_cycle"];
    let points = numbers(&first["time_s"]).len();
    for (group, labels) in [
        ("rocker_angle_deg", ["coupler", "rocker"].as_slice()),
        ("rocker_speed_rpm", &["coupler", "rocker"]),
        ("joint_force_N", &["coupler", "crank", "rocker"]),
    ] {
        assert_eq!(keys(&first[group]), labels, "{group}");
        for label in labels {
            assert_eq!(numbers(&first[group][label]).len(), points, "{group} {label}");
        }
    }
    // Its range is the worker's business; that degrees are meant, and not radians, is this command's.
    let angle = numbers(&first["rocker_angle_deg"]["rocker"]);
    assert!(angle.iter().all(|angle| (60.0..180.0).contains(angle)));

    let joints = found["joints"].as_array().unwrap();
    assert_eq!(
        joints.iter().map(|joint| joint["name"].as_str().unwrap()).collect::<Vec<_>>(),
        ["crank", "coupler", "rocker"]
    );
    for joint in joints {
        assert!(joint["peak_force_N"].as_f64().unwrap() > 1.0);
        assert_eq!(numbers(&joint["wear_depth_m"]).len(), 36);
    }
    let largest = joints.iter().flat_map(|joint| numbers(&joint["wear_depth_m"])).fold(0.0, f64::max);
    assert_eq!(Some(&largest), wear.last());
    let worn = &found["worn"];
    assert_eq!(keys(worn), ["cycles", "last_cycle", "wear_depth_m"]);
    assert_eq!(keys(&worn["last_cycle"]), keys(first));
    for joint in joints {
        let lives = worn["wear_depth_m"][joint["name"].as_str().unwrap()].as_array().unwrap();
        assert_eq!(lives.len(), numbers(&worn["cycles"]).len());
        assert_eq!(lives.last(), Some(&joint["wear_depth_m"]));
    }
    for counter in ["steps", "rejected_steps", "newton_iterations"] {
        assert!(found["diagnostics"][counter].is_u64(), "{counter}");
    }
    assert_eq!(keys(&found["diagnostics"]["free_flight_fraction"]), ["coupler", "crank", "rocker"]);
    assert!(found["wall_s"].as_f64().unwrap() > 0.0);
}

#[test]
fn settings_change_the_simulation() {
    let simulate = |setting: &str| {
        json(&["simulate", "four-bar", "--accuracy", "draft", "--set", setting])["joints"][0]["peak_force_N"]
            .as_f64()
            .unwrap()
    };
    // The load decides the forces; the unit is read.
    let (usual, doubled, same) = (
        simulate("load_torque=-0.8 N m"),
        simulate("load_torque=-1.6N m"),
        simulate("load_torque=-800 N mm"),
    );
    assert!(doubled > 1.5 * usual, "{usual} {doubled}");
    assert!((same - usual).abs() <= 1e-9 * usual, "{usual} {same}");
    assert_ne!(simulate("parameters.crank_length=19mm"), usual);
}

#[test]
fn scenes_are_listed_shown_and_valid() {
    let list = json(&["scenes", "--json"]);
    let names: Vec<&str> =
        list.as_array().unwrap().iter().map(|scene| scene["name"].as_str().unwrap()).collect();
    let expected = [
        "flapping-wing",
        "flapping-wing-tolerances",
        "flapping-wing-experiment",
        "flapping-wing-as-published",
        "four-bar",
        "slider-crank",
        "pendulum",
        "andrews-squeezer",
    ];
    assert_eq!(names, expected);
    let folder = tempfile::tempdir().unwrap();
    let listed = text(&["scenes"]);
    for name in names {
        assert!(listed.contains(name));
        // What is shown can be saved, changed and used.
        let file = folder.path().join(format!("{name}.toml"));
        std::fs::write(&file, text(&["scenes", "--show", name])).unwrap();
        let file = file.to_str().unwrap();
        assert_eq!(json(&["check", file, "--quick", "--json"])["valid"], Value::Bool(true));
        assert_eq!(json(&["explain", file, "--quick", "--json"])["name"], Value::from(name));
    }
}

#[test]
fn check_lists_parameters_that_nothing_reads() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("four-bar.toml");
    let scene = text(&["scenes", "--show", "four-bar"]);
    std::fs::write(&file, scene.replacen("[parameters]", "[parameters]\nspare = \"3 mm\"", 1)).unwrap();
    let file = file.to_str().unwrap();
    let found = text(&["check", file]);
    let line = scene.lines().position(|line| line == "[parameters]").unwrap() + 2;
    assert!(
        found.contains(&format!("{file}:{line}:9: warning: parameters.spare: nothing reads it\n")),
        "{found}"
    );
    assert!(
        found.contains("nominal wear: 9.96 µm after 8 000 cycles, limit 8.00 µm, margin -25 %"),
        "{found}"
    );
    assert_eq!(json(&["check", file, "--json"])["nominal"][0]["limit_state"], "wear");
    assert_eq!(json(&["check", file, "--json"])["unused_parameters"], serde_json::json!(["spare"]));
    assert_eq!(json(&["check", "four-bar", "--json"])["unused_parameters"], serde_json::json!([]));
}

#[test]
fn shells_and_manuals() {
    assert!(text(&["completions", "bash"]).contains("complete -F _coordinator"));
    assert!(text(&["completions", "zsh"]).starts_with("#compdef coordinator"));
    let page = text(&["man"]);
    assert!(page.contains(".TH coordinator 1") && page.contains("SUBCOMMANDS"), "{page}");
}

#[test]
fn explain_says_what_is_modelled() {
    let found = text(&["explain"]);
    for part in [
        "crank: turns at 480.0 r/min, prescribed",
        "2 bodies with prescribed motion cost nothing",
        "island 1, with its own time steps: right_rod + right_rocker; 6 unknowns",
        "island 2, with its own time steps: left_rod + left_rocker; 6 unknowns",
        "Every cycle is simulated dynamically: output angular_velocity_difference needs the dynamics",
        "clearance 23.50 um",
        "local-hertz",
        "spring of 95 N/m",
        "limit state wear: failed from 30.0000 um on",
        "limit state asymmetry: failed from 25.0000 r/min on",
        "mean 40.0549, std 5e-4, from 40.0534 to 40.0564 mm",
        "72000 cycles of 0.125000 s",
    ] {
        assert!(found.contains(part), "no \"{part}\" in:\n{found}");
    }
    let quick = text(&["explain", "--quick"]);
    assert!(
        quick.contains("72000 cycles") && found.contains("Nominal wear") && !quick.contains("Nominal wear")
    );
}

#[test]
fn every_command_helps_with_an_example() {
    assert!(text(&["--help"]).contains("coordinator --workers auto"));
    let commands = [
        "run",
        "resume",
        "simulate",
        "tradeoff",
        "sensitivity",
        "report",
        "scenes",
        "check",
        "explain",
        "schema",
        "completions",
        "man",
    ];
    for command in commands {
        let help = text(&[command, "--help"]);
        assert!(help.contains("Example") && help.contains(&format!("coordinator {command}")), "{help}");
    }
}

#[test]
fn an_error_budget_chooses_the_accuracy() {
    let chosen = |budget: &str| {
        let output = coordinator(&["simulate", "four-bar", "--max-error", budget]);
        let told = String::from_utf8(output.stderr).unwrap();
        let found: Value = serde_json::from_slice(&output.stdout).unwrap();
        let name = found["accuracy"].as_str().unwrap().to_owned();
        assert!(told.contains(&format!("accuracy {name}: the cheapest")), "{told}");
        (name, found["diagnostics"]["steps"].as_u64().unwrap())
    };
    let (loose, tight) = (chosen("50%"), chosen("0.01"));
    assert_eq!(loose.0, "draft+step-x1.41");
    assert!(loose.1 < tight.1, "{loose:?} {tight:?}");
}

#[test]
fn tradeoff_measures_every_setting_and_writes_its_files() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("tradeoff");
    let table = text(&[
        "tradeoff",
        "four-bar",
        "--samples",
        "2",
        "--setting",
        "draft",
        "--setting",
        "balanced",
        "--setting",
        "step-x1.41+jump-2000",
        "--workers",
        "2",
        "--out",
        out.to_str().unwrap(),
        "--quiet",
    ]);
    for part in ["**draft**", "**balanced**", "| step-x1.41+jump-2000", "| stated | R |"] {
        assert!(table.contains(part), "no {part:?} in {table}");
    }
    assert_eq!(std::fs::read_to_string(out.join("tradeoff.md")).unwrap(), table);
    // Three settings, two points, two outputs, eight checkpoints.
    assert_eq!(std::fs::read_to_string(out.join("values.csv")).unwrap().lines().count(), 1 + 3 * 2 * 2 * 8);
    let csv = std::fs::read_to_string(out.join("tradeoff.csv")).unwrap();
    let mut lines = csv.lines();
    let head: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column = |name: &str| head.iter().position(|h| *h == name).unwrap();
    let balanced = lines.find(|line| line.starts_with("balanced,")).unwrap();
    let value = |name: &str| balanced.split(',').nth(column(name)).unwrap().parse::<f64>().unwrap();
    assert!(value("max_wear_depth_error") < 4e-3, "{balanced}");
    assert!(value("max_wear_depth_within_twice") >= 0.95, "{balanced}");
    assert_eq!(value("failures"), 0.0);
}
