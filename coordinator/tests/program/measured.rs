//! Scenes with measured values, through the commands: what `check` prints, and a study that goes on without the files.

use crate::printed;
use std::path::{Path, PathBuf};

/// The measured scene and its files in a folder.
fn measured(folder: &Path) -> PathBuf {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../common/tests/scenes");
    for name in ["measured.toml", "measured-torque.csv", "measured-clearances.csv", "measured-friction.csv"] {
        std::fs::copy(scenes.join(name), folder.join(name)).unwrap();
    }
    folder.join("measured.toml")
}

#[test]
fn the_test_of_a_fit_is_shown() {
    let folder = tempfile::tempdir().unwrap();
    let scene = measured(folder.path());
    let scene = scene.to_str().unwrap();
    let text = printed(&["check", scene]);
    for piece in [
        "clearance_crank: lognormal fitted to 40 measured values from ",
        "Anderson-Darling A^2 = ",
        "others: normal p = ",
        "friction: empirical distribution of 25 measured values from 0.0",
        "failures rarer than about 1 in 25 need a fit",
    ] {
        assert!(text.contains(piece), "no \"{piece}\" in\n{text}");
    }
    let found = crate::json(&["check", scene, "--json"]);
    let families = found["measured"][0]["families"].as_array().unwrap();
    let p = |word: &str| {
        let of_word = families.iter().find(|test| test["family"] == word).unwrap();
        of_word["p"].as_f64().unwrap()
    };
    // The values were drawn from a lognormal distribution; an exponential one has another shape.
    assert!(p("lognormal") > 0.05 && p("exponential") < 0.01, "{families:?}");
    assert!(printed(&["explain", scene]).contains("friction: empirical distribution"));

    let text = std::fs::read_to_string(scene).unwrap();
    std::fs::write(scene, text.replace("\"lognormal\"", "\"weibull\"")).unwrap();
    let text = printed(&["check", scene]);
    assert!(text.contains("the measured values are unlikely for this family (p = 0.00"), "{text}");
    assert!(text.contains("measured.toml:17:7"), "{text}");
}

#[test]
fn a_study_goes_on_without_the_files() {
    let folder = tempfile::tempdir().unwrap();
    let scene = measured(folder.path());
    let text = std::fs::read_to_string(&scene).unwrap() + "\n[life]\ncycles = 2000\n";
    std::fs::write(&scene, text).unwrap();
    let study = folder.path().join("study");
    let study = study.to_str().unwrap();
    let arguments =
        ["run", scene.to_str().unwrap(), "--accuracy", "draft", "--initial", "12", "-q", "--out", study];
    printed(&[&arguments[..], &["--max-evaluations", "14"]].concat());
    for name in ["measured.toml", "measured-torque.csv", "measured-clearances.csv", "measured-friction.csv"] {
        std::fs::remove_file(folder.path().join(name)).unwrap();
    }
    printed(&["resume", study, "--max-evaluations", "16", "-q"]);
    let page = std::fs::read_to_string(Path::new(study).join("report.html")).unwrap();
    assert!(page.contains("empirical"), "the distribution of friction is in the report");
    assert!(
        page.contains("unit = &quot;N m&quot;") || page.contains("unit = \"N m\""),
        "the torque is in the appendix"
    );
}
