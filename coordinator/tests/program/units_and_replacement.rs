//! Decisions from a finished study with the real `coordinator`: `update` and `replace`.

use crate::{json, refused};
use serde_json::Value;
use std::path::Path;

#[test]
fn a_study_answers_for_units_and_replacement() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (study, units, out) = (crate::finished_study().to_str().unwrap(), at("units.csv"), at("fleet"));

    let missing = refused(&["update", study, "--measured", &at("no.csv")], 2);
    assert!(missing.contains("no.csv: cannot be read: there is no such file"), "{missing}");

    // Of two units the one that has worn more has the shorter remaining life.
    let observed = "unit,cycles,quantity,value,error\nA,3000,max_wear_depth,4.4 um,0.1 um\n\
        B,3000,max_wear_depth,5 um,0.1 um\nB,3000,survived\nB,,load_torque,-0.81 N m,0.01 N m\n";
    std::fs::write(&units, observed).unwrap();
    let fleet = json(&["update", study, "--measured", &units, "--out", &out, "--json"]);
    let left = |k: usize| fleet["units"][k]["remaining"]["p50"].as_f64().unwrap();
    assert!(left(0) > left(1) && left(1) > 0.0, "{} {}", left(0), left(1));
    assert!(fleet["units"][1]["reliability"][0]["total"].as_f64().unwrap() > 0.999);
    assert!(fleet["evaluations"] == 0 && fleet["lives"].is_array() && fleet["reliability"].is_array());
    for name in ["update.html", "update.json", "units.csv"] {
        assert!(Path::new(&out).join(name).is_file(), "{name}");
    }
    std::fs::write(&units, "A,3000,depth,4 um,1 um\nA,9000,max_wear_depth,4 N,1 um\n").unwrap();
    let message = refused(&["update", study, "--measured", &units], 2);
    assert!(message.contains("units.csv:1:8") && message.contains("units.csv:2:23"), "{message}");
    assert!(refused(&["update", study, "--measured", &at("none.csv")], 2).contains("none.csv"));

    // The population of three units: a failure with its life, a unit that still runs, and one that was measured.
    let (fleet, learned) = (at("fleet.csv"), at("learned"));
    let observed = "unit,cycles,quantity,value,error\nA,5200,failed,wear,50\nB,4500,survived\n\
        C,3000,max_wear_depth,4.6 um,0.2 um\nC,3000,survived\n";
    std::fs::write(&fleet, observed).unwrap();
    let answer = json(&["learn", study, "--data", &fleet, "--out", &learned, "--json"]);
    let life = &answer["confident"]["lives"][1];
    assert!(life["at_least"].as_f64().unwrap() < life["median"].as_f64().unwrap(), "{life}");
    assert!(answer["evaluations"] == 0 && answer["parameters"].as_array().unwrap().len() == 2, "{answer}");
    for name in ["learn.html", "learn.json", "reliability.csv", "figures/confident-reliability.svg"] {
        assert!(Path::new(&learned).join(name).is_file(), "{name}");
    }
    std::fs::write(&fleet, "A,5200,failed,waer\npopulation,,friction.men\n").unwrap();
    let message = refused(&["learn", study, "--data", &fleet], 2);
    assert!(message.contains("fleet.csv:1:15") && message.contains("fleet.csv:2:13"), "{message}");
    let message = refused(&["what-if", study, "--confidence", "90%"], 2);
    assert!(message.contains("measured samples"), "{message}");

    let answer = json(&["replace", study, "--failure-cost", "10", "--inspect-every", "1000", "--json"]);
    let age = &answer["age"];
    let number = |value: &Value| value.as_f64().unwrap();
    assert!(number(&age["lower"]) <= number(&age["value"]) && number(&age["value"]) <= number(&age["upper"]));
    assert!(number(&answer["inspections"][0]["cost_rate"]) > 0.0);
    for (arguments, allowed) in [
        (&["--failure-cost", "0.5"][..], "above --planned-cost 1"),
        (&["--failure-cost", "10", "--curve", "noise"], "allowed: wear, total"),
        (&["--failure-cost", "10", "--inspect-every", "90000"], "cycles"),
        (&["--failure-cost", "10", "--inspect-at", "4000,3000"], "increasing"),
        (&["--failure-cost", "10", "--inspect-every", "500", "--inspect-error", "1 N"], "--inspect-error"),
        (&["--failure-cost", "10", "--inspect-cost", "1"], "--inspect-every"),
    ] {
        let message = refused(&[&["replace", study], arguments].concat(), 2);
        assert!(message.contains(allowed), "{arguments:?}: {message}");
    }
}

/// The study's own curves are those of a design drawn at random between 18 and 28 um; the scene has 30 um.
#[test]
fn issue_units_of_a_study_of_designs_had_a_design_drawn_at_random() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (study, units) = (at("study"), at("units.csv"));
    let run = "run four-bar --accuracy draft --samples 4000 --initial 16 --max-evaluations 24 --quiet --out";
    let design = ["--design", "parameters.clearance=18 um..28 um"];
    crate::printed(&run.split(' ').chain([study.as_str()]).chain(design).collect::<Vec<_>>());
    let present = json(&["what-if", &study, "--json"])["before"]["reliability"].clone();
    std::fs::write(&units, "A,0,survived\n").unwrap();
    let fleet = json(&["update", &study, "--measured", &units, "--json"]);
    let replaced = json(&["replace", &study, "--failure-cost", "10", "--json"]);
    assert_eq!([&fleet["reliability"], &replaced["reliability"]], [&present; 2]);
    // A unit of which nothing is known has the reliability of that design.
    let total = |rows: &Value, cycles: u64| {
        let row = rows.as_array().unwrap().iter().find(|row| row["cycles"] == cycles).unwrap();
        row["total"].as_f64().unwrap()
    };
    let of_unit = &fleet["units"][0]["reliability"];
    for cycles in [5000, 6000, 7000] {
        let [unit, of_design] = [of_unit, &present].map(|rows| total(rows, cycles));
        assert!((unit - of_design).abs() < 0.03, "{cycles}: {unit} {of_design}");
    }
    std::fs::write(&units, "A,5000,survived\n").unwrap();
    let message = refused(&["learn", &study, "--data", &units], 2);
    assert!(message.contains("clearance_crank follows clearance"), "{message}");
    let compared = crate::coordinator(&["compare", &study, &study]);
    assert!(String::from_utf8_lossy(&compared.stderr).contains("drawn at random"), "{compared:?}");
}
