//! Tables and samples from CSV files: the scene stands alone once it is read, and every fault has its place in the file it is in.

use common::random::{Distribution, Family};
use common::scene::{Fault, Load, Over, SceneSource};
use std::path::Path;

const SCENE: &str = include_str!("../scenes/measured.toml");
const TORQUE: &str = include_str!("../scenes/measured-torque.csv");
const CLEARANCES: &str = include_str!("../scenes/measured-clearances.csv");
const FRICTION: &str = include_str!("../scenes/measured-friction.csv");
const SHA256_OF_TORQUE: &str = "bf9f1b8f84ff71b304d9a3be8a8dde53c0e6fd97dad781406dde8878a2a8aa2d";

fn measured() -> SceneSource {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scenes/measured.toml");
    SceneSource::load(path.to_str().unwrap()).unwrap()
}

/// The result for the measured scene after replacing one piece of one of its files.
fn changed(from: &str, to: &str) -> Result<SceneSource, Vec<Fault>> {
    let folder = tempfile::tempdir().unwrap();
    let mut found = false;
    for (name, text) in [
        ("measured.toml", SCENE),
        ("measured-torque.csv", TORQUE),
        ("measured-clearances.csv", CLEARANCES),
        ("measured-friction.csv", FRICTION),
    ] {
        found |= text.contains(from);
        std::fs::write(folder.path().join(name), text.replacen(from, to, 1)).unwrap();
    }
    assert!(found, "no file has {from}");
    SceneSource::load(folder.path().join("measured.toml").to_str().unwrap()).map_err(|faults| faults.0)
}

#[test]
fn columns_become_curves_and_distributions() {
    let source = measured();
    let scene = source.nominal();
    let torque = scene.loads.iter().find_map(|load| match load {
        Load::VariableTorque { name, torque, .. } if name == "bench" => Some(torque),
        _ => None,
    });
    let torque = torque.expect("a measured torque");
    assert!(matches!(torque.over, Over::Angle(_)));
    assert_eq!((torque.table.at.len(), torque.table.value[0]), (13, -0.1));
    assert_eq!(torque.table.at[1], 30.0 * std::f64::consts::PI / 180.0);

    let found = &source.measured;
    assert_eq!((found[0].name.as_str(), found[0].samples.len()), ("clearance_crank", 40));
    let gaps: Vec<f64> =
        CLEARANCES.lines().skip(2).map(|line| line.split_once(';').unwrap().1.parse().unwrap()).collect();
    for (found, written) in found[0].samples.iter().zip(&gaps) {
        assert!((found / (written * 1e-6) - 1.0).abs() < 1e-15);
    }
    assert_eq!(found[0].family, Some(Family::Lognormal));
    // Largest likelihood: mean and standard deviation of the logarithms.
    let logs: Vec<f64> = gaps.iter().map(|x| (x * 1e-6).ln()).collect();
    let median = (logs.iter().sum::<f64>() / 40.0).exp();
    let law = |name: &str| &source.variables().iter().find(|v| v.name == name).unwrap().distribution;
    assert!((law("clearance_crank").quantile(0.5) / median - 1.0).abs() < 1e-12);
    assert!(matches!(law("friction"), Distribution::Empirical(_)));
    assert_eq!((found[1].family, found[1].samples.len()), (None, 25));
}

/// Workers, the campaign file and the report have the text alone.
#[test]
fn the_text_needs_no_csv_file() {
    let source = measured();
    let alone = SceneSource::parse(source.text(), "sent").unwrap();
    assert!(!source.text().contains("csv ="));
    assert_eq!(alone.nominal(), source.nominal());
    assert_eq!((alone.text(), alone.digest()), (source.text(), source.digest()));
    assert_eq!(alone.measured, source.measured);
    // Another value in a file is another scene.
    let other = changed("30,-0.125", "30,-0.126").unwrap();
    assert_ne!(other.digest(), source.digest());
}

#[test]
fn issue_values_of_a_csv_file_did_not_say_where_they_are_from() {
    let source = measured();
    let document = &source.document;
    let row = |list: &str, name: &str| {
        let rows = document[list].as_array().unwrap();
        rows.iter().find(|row| row["name"].as_str() == Some(name)).unwrap().clone()
    };
    // By `sha256sum`.
    let load = row("loads", "bench")["torque"]["source"].as_str().unwrap().to_owned();
    assert_eq!(load, format!("measured-torque.csv, SHA-256 {SHA256_OF_TORQUE}"));
    let samples = row("variables", "clearance_crank")["samples"]["source"].as_str().unwrap().to_owned();
    assert!(samples.starts_with("measured-clearances.csv, SHA-256 "), "{samples}");
    // Other values in their place are not of that file.
    let text = "[scene]\nname = \"other\"\nextends = \"measured.toml\"\n[[loads]]\nname = \"bench\"\n[loads.torque]\n\
                at = [\"0 deg\", \"360 deg\"]\nvalue = [\"1 N mm\", \"1 N mm\"]\n";
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in [
        ("measured.toml", SCENE),
        ("measured-torque.csv", TORQUE),
        ("measured-clearances.csv", CLEARANCES),
        ("measured-friction.csv", FRICTION),
        ("other.toml", text),
    ] {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let other = SceneSource::load(folder.path().join("other.toml").to_str().unwrap()).unwrap();
    assert!(
        !other.text().contains("measured-torque.csv") && other.text().contains("measured-clearances.csv")
    );
}

#[test]
fn issue_a_scene_with_a_csv_file_lost_its_comments() {
    let source = measured();
    for line in SCENE.lines().filter(|line| line.starts_with('#') || line.starts_with('[')) {
        assert!(source.text().contains(line), "{line}\n{}", source.text());
    }
    // The order of the tables is that of the scene that it extends.
    let heads =
        |text: &str| text.lines().filter(|l| l.starts_with('[')).map(str::to_owned).collect::<Vec<_>>();
    let text = heads(source.text());
    let mut rest = text.iter();
    let base = heads(SceneSource::builtin("four-bar").unwrap().text());
    assert!(base.iter().all(|head| rest.any(|found| found == head)), "{text:?}");
}

#[test]
fn a_list_with_one_unit_is_the_list_with_units() {
    let text = |torque: &str, samples: &str| {
        let scene = SCENE
            .replace("csv = \"measured-torque.csv\", columns = [\"angle\", \"torque\"]", torque)
            .replace("{ csv = \"measured-clearances.csv\", column = \"gap\" }", samples)
            .replace("{ csv = \"measured-friction.csv\" }", "[0.04, 0.05, 0.06]");
        SceneSource::parse(&scene, "my.toml").unwrap()
    };
    let each = text(
        "at = [\"0 deg\", \"120.7 deg\", \"360 deg\"], value = [\"1 N mm\", \"0.3 N mm\", \"1 N mm\"]",
        "[\"20.1 um\", \"22 um\", \"23 um\", \"24.7 um\", \"30 um\"]",
    );
    let once = text(
        "at = { unit = \"deg\", values = [0, 120.7, 360] }, value = { unit = \"N mm\", values = [1, 0.3, 1] }",
        "{ unit = \"um\", values = [20.1, 22, 23, 24.7, 30] }",
    );
    assert_eq!(each.nominal().loads, once.nominal().loads);
    assert_eq!(each.measured, once.measured);
}

#[test]
fn a_fault_points_into_the_file_it_is_in() {
    let mut wrong = Vec::new();
    for [from, to, place, says] in crate::rows("a_fault_points_into_the_file_it_is_in") {
        let Err(found) = changed(from, to) else { panic!("{to} is no fault") };
        let fault = found.iter().find(|fault| fault.to_string().contains(says));
        let Some(fault) = fault else {
            wrong.push(format!("{to}: {found:#?}"));
            continue;
        };
        let at = fault.location.as_ref().unwrap_or_else(|| panic!("{fault} has no place")).to_string();
        if !at.ends_with(place) {
            wrong.push(format!("{to}: {at} instead of {place}: {fault}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// One fault for a unit of the wrong kind, whatever the number of values.
#[test]
fn a_wrong_unit_is_one_fault() {
    let Err(found) = changed("[N m]", "[mm]") else { panic!("a length is no torque") };
    assert_eq!(found.len(), 1, "{found:#?}");
}

#[test]
fn a_scene_without_a_file_names_no_csv_file() {
    let faults = SceneSource::parse(SCENE, "sent").unwrap_err().to_string();
    assert!(faults.contains("this scene has no file that it is relative to"), "{faults}");
}

/// Samples above replace the parameters below, and parameters above the samples below.
#[test]
fn a_scene_that_extends_changes_the_kind_of_a_distribution() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scenes");
    let above = tempfile::tempdir().unwrap();
    let base = folder.join("measured.toml").display().to_string();
    let text = format!(
        "[scene]\nname = \"again\"\nextends = '{base}'\n[[variables]]\nname = \"clearance_crank\"\nmean = \"25 um\"\n\
         std = \"1 um\"\ndistribution = \"normal\"\n"
    );
    let path = above.path().join("again.toml");
    std::fs::write(&path, text).unwrap();
    let again = SceneSource::load(path.to_str().unwrap()).unwrap();
    let law = &again.variables().iter().find(|v| v.name == "clearance_crank").unwrap().distribution;
    assert_eq!(law, &Distribution::normal(25e-6, 1e-6).unwrap());
    assert_eq!(again.measured.len(), 1);
}
