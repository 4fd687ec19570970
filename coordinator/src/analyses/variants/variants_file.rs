//! Reader of a file of variants, TOML: named sets of changes of the scene and of the accuracy.
//!
//! ```toml
//! [[variants]]
//! name = "foundation"
//! set = { "joints.*.contact_law" = "foundation" }
//!
//! [[variants]]
//! name = "more points"
//! accuracy = "balanced+points-x2"
//! ```

use crate::analyses::scene_settings::with_keys;
use crate::study::FIRST_VARIANT;
use common::accuracy::NamedAccuracy;
use common::scene::{Faults, InputFile, Scene, SceneSource, Section};
use serde::{Deserialize, Serialize};
use toml::Table;

/// Most variants that a study may have had.
const MOST: usize = 200;

/// A variant of the model of a study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ModelVariant {
    /// Name of the variant.
    pub name: String,
    /// What it changes, `key = value`.
    pub changes: Vec<String>,
    /// Text of its scene.
    pub scene: String,
    /// Its accuracy; `None` for that of the study.
    pub accuracy: Option<NamedAccuracy>,
    /// Level of its evaluations, given when it is stored.
    pub level: u8,
    /// False for one of an earlier file, whose evaluations remain.
    pub is_asked: bool,
}

impl ModelVariant {
    /// These variants, after those that the campaign file has `known`: one that is the same keeps its evaluations.
    pub fn merged(mut known: Vec<Self>, asked: &[Self]) -> Vec<Self> {
        known.iter_mut().for_each(|variant| variant.is_asked = false);
        for variant in asked {
            let is_same =
                |old: &&mut Self| (&old.scene, &old.accuracy) == (&variant.scene, &variant.accuracy);
            if let Some(old) = known.iter_mut().find(is_same) {
                *old = Self { level: old.level, ..variant.clone() };
                continue;
            }
            let level =
                FIRST_VARIANT + u8::try_from(known.len().min(MOST)).unwrap_or(u8::MAX - FIRST_VARIANT);
            known.push(Self { level, ..variant.clone() });
        }
        known
    }
}

/// Reads the variants of a scene.
///
/// # Errors
/// All faults.
pub fn read(file: &InputFile, source: &SceneSource) -> Result<Vec<ModelVariant>, Faults> {
    file.read(|file| {
        let rows = file.rows("variants");
        if rows.is_empty() || rows.len() > MOST {
            file.inconsistent("variants", format!("allowed: 1 to {MOST} [[variants]]"));
        }
        rows.into_iter().filter_map(|(name, mut row)| variant(name, &mut row, source)).collect()
    })
}

fn variant(name: &str, row: &mut Section, base: &SceneSource) -> Option<ModelVariant> {
    let before = row.fault_count();
    let none = toml::Value::Table(Table::new());
    let given = row.get("set").unwrap_or(&none);
    let keys = given.as_table().unwrap_or_else(|| {
        row.wrong_type("set", given, "a table of keys of the scene and their values");
        none.as_table().expect("a table")
    });
    let text = row.text_or("accuracy", "the name of an accuracy", "").unwrap_or_default();
    let accuracy = if text.is_empty() { Ok(None) } else { text.parse::<NamedAccuracy>().map(Some) };
    if let Err(error) = &accuracy {
        row.inconsistent("accuracy", error.to_string());
    }
    if !text.is_empty() && base.nominal().simulator.is_some() {
        row.inconsistent("accuracy", "a scene that names its own simulator has no accuracy");
    }
    row.finish();
    if keys.is_empty() && text.is_empty() {
        row.inconsistent("name", format!("{name} changes nothing; give it `set` or `accuracy`"));
    }
    let source = match with_keys(base, "set", keys) {
        Ok(source) => source,
        Err(Faults(faults)) => {
            for fault in faults {
                row.inconsistent("set", fault.to_string());
            }
            return None;
        }
    };
    if let Some(what) = other_study(base.nominal(), source.nominal()) {
        row.inconsistent("set", format!("{name} changes the {what} of the study; a variant changes the model alone, `what-if` the rest"));
    }
    let changes = keys.iter().map(|(key, value)| format!("{key} = {value}"));
    let of_accuracy = (!text.is_empty()).then(|| format!("accuracy = {text}"));
    let changes = changes.chain(of_accuracy).collect();
    let (name, scene, accuracy) = (name.to_owned(), source.text().to_owned(), accuracy.ok()?);
    let variant = ModelVariant { name, changes, scene, accuracy, level: 0, is_asked: true };
    (row.fault_count() == before).then_some(variant)
}

/// What two scenes differ in that makes them different studies.
fn other_study(a: &Scene, b: &Scene) -> Option<&'static str> {
    let variables = [a, b].map(|scene| scene.variables.iter().map(|v| (&v.name, &v.distribution)));
    let outputs = [a, b].map(|scene| scene.outputs.iter().map(|output| &output.name));
    let ([own, others], [names, other_names]) = (variables, outputs);
    let differences = [
        (own.ne(others), "random variables"),
        (names.ne(other_names), "outputs"),
        (a.limit_states != b.limit_states, "limit states"),
        (a.life.checkpoints() != b.life.checkpoints(), "checkpoints"),
    ];
    differences.into_iter().find_map(|(differ, what)| differ.then_some(what))
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::scene::Fault;

    fn read_text(text: &str) -> Result<Vec<ModelVariant>, Faults> {
        let source = SceneSource::builtin("four-bar").unwrap();
        read(&InputFile::parse(text, "variants.toml").unwrap(), &source)
    }

    #[test]
    fn keys_of_the_scene_and_the_accuracy_are_changed() {
        let found = read_text(
            "[[variants]]\nname = \"foundation\"\nset = { \"joints.*.contact_law\" = \"foundation\" }\n\
             [[variants]]\nname = \"film\"\nset = { \"parameters.film_damping\" = \"120 N s/m\" }\naccuracy = \"draft+points-x2\"\n",
        )
        .unwrap();
        assert_eq!(found[0].scene.matches("contact_law = \"foundation\"").count(), 3);
        assert_eq!(found[0].changes, ["joints.*.contact_law = \"foundation\""]);
        assert_eq!(found[1].accuracy.as_ref().unwrap().accuracy.points, 2);
        assert!(found[1].scene.contains("film_damping = \"120 N s/m\""));
        let stored = ModelVariant::merged(vec![], &found);
        assert_eq!([stored[0].level, stored[1].level], [FIRST_VARIANT, FIRST_VARIANT + 1]);
        // Another file: what is the same keeps its level, whatever its name.
        let renamed = ModelVariant { name: "thicker film".to_owned(), ..found[1].clone() };
        let merged = ModelVariant::merged(stored, &[renamed]);
        assert_eq!((merged.len(), merged[0].is_asked, merged[1].is_asked), (2, false, true));
        assert_eq!((merged[1].name.as_str(), merged[1].level), ("thicker film", FIRST_VARIANT + 1));
    }

    #[test]
    fn the_variants_of_the_published_drive_are_those_of_its_scene() {
        let text = include_str!("../../../doc/reproduction/variants.toml");
        let source = SceneSource::builtin("flapping-wing").unwrap();
        let found = read(&InputFile::parse(text, "variants.toml").unwrap(), &source).unwrap();
        assert_eq!(found.len(), text.matches("[[variants]]").count());
        assert!(found[0].scene.contains("film_damping = \"7.1676 N s/m\""));
    }

    #[test]
    fn faults_have_their_lines() {
        let text = "[[variants]]\nname = \"a\"\n[[variants]]\nname = \"b\"\nset = { \"joints.hinge.contact_law\" = \"foundation\" }\n\
            [[variants]]\nname = \"c\"\nset = { \"joints.*.contact_law\" = \"hertz\" }\naccuracy = \"fine\"\n\
            [[variants]]\nname = \"d\"\nset = { \"limit_states.wear.threshold\" = \"9 um\" }\nsets = 1\n";
        let Err(Faults(faults)) = read_text(text) else { panic!("faults") };
        let placed = |fault: &Fault| format!("{} {fault}", fault.location.as_ref().unwrap());
        let all = faults.iter().map(placed).collect::<Vec<_>>().join("\n");
        for says in [
            "a changes nothing",
            "variants.toml:5",
            "the scene has no such key",
            "variants.toml:8",
            "local-hertz",
            "neither a preset",
            "changes the limit states of the study",
            "sets",
        ] {
            assert!(all.contains(says), "{says}: {all}");
        }
        assert!(read_text("").is_err());
    }
}
