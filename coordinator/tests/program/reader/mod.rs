//! The reader's test: from the tables of a report alone a stranger writes the scene again, and it is the same scene.

mod outputs;
mod page;
mod scene;

use common::scene::SceneSource;
use ring::digest::{SHA256, digest};
use scene::rebuilt;
use std::process::Command;

/// Hash of everything that a scene resolves to.
fn hash(scene: &common::scene::Scene) -> String {
    let text = serde_json::to_string(scene).unwrap();
    digest(&SHA256, text.as_bytes()).as_ref().iter().map(|byte| format!("{byte:02x}")).collect()
}

#[test]
fn the_tables_of_a_four_bar_give_the_same_scene() {
    is_rebuilt(&as_run("four-bar", 3000), &[]);
}

#[test]
fn the_tables_of_the_drive_give_the_same_scene() {
    is_rebuilt(&as_run("flapping-wing", 3000), &[]);
}

/// An ideal pin, a hinge and a guide with clearance, a load by a curve and gravity.
#[test]
fn issue_the_materials_of_guides_were_in_no_table() {
    let needle = include_str!("../../../../common/tests/scenes/needle.toml");
    // Softer, so that it is simulated in longer steps.
    let needle = needle.replace("\"210 GPa\"", "\"2.1 GPa\"").replace("\"105 GPa\"", "\"1.05 GPa\"");
    let needle = format!("{needle}\n[study]\naccuracy = \"draft\"\n");
    is_rebuilt(&needle, &["--method", "monte-carlo", "--samples", "2", "--accuracy", "draft"]);
}

/// A built-in scene with a short life and the settings of a small study.
fn as_run(name: &str, cycles: u32) -> String {
    format!(
        "[scene]\nname = \"{name}\"\nextends = \"{name}\"\n[life]\ncycles = {cycles}\n[study]\npopulation = 2000\ninitial = 6\nmax_evaluations = 6\n\
         accuracy = \"draft\"\nlevels = [\"draft\", \"draft+halved-1\"]\n"
    )
}

/// Runs a study of a scene with these options, and writes the scene again from its report.
fn is_rebuilt(scene: &str, options: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    let (study, file) = (folder.path().join("study"), folder.path().join("own.toml"));
    std::fs::write(&file, scene).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_coordinator"));
    command.args(["run", "-q"]).arg(&file).arg("--out").arg(&study).args(options);
    let output = command.output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let page = std::fs::read_to_string(study.join("report.html")).unwrap();
    // The raw text of the scene, which the appendix lists, is not read.
    let (tables, appendix) = page.split_once("<summary>Scene</summary>").unwrap();
    assert!(appendix.contains("[[bodies]]") && !tables.contains("[[bodies]]"));
    let text = toml::to_string(&rebuilt(tables)).unwrap();
    let again = SceneSource::parse(&text, "again").unwrap_or_else(|faults| panic!("{faults}\n{text}"));
    let original = SceneSource::parse(scene, "own").unwrap();
    assert_eq!(again.nominal(), original.nominal(), "{text}");
    assert_eq!(hash(again.nominal()), hash(original.nominal()));
    // Every sample of the variables gives the same mechanism, so that a study has the same bits.
    for j in 0..50 {
        let probability = |k: usize| ((f64::from(j) + 0.5) * (2.0 + k as f64).sqrt()).fract().max(1e-3);
        let values = original.variables().iter().enumerate();
        let sample: Vec<f64> =
            values.map(|(k, variable)| variable.distribution.quantile(probability(k))).collect();
        let [a, b] = [&again, &original].map(|source| source.resolve_sample(&sample).unwrap());
        assert_eq!(hash(&a), hash(&b), "{sample:?}");
    }
    assert_ne!(
        hash(
            &again
                .resolve_sample(&original.means().iter().map(|mean| 1.01 * mean).collect::<Vec<_>>())
                .unwrap()
        ),
        hash(original.nominal())
    );
}
