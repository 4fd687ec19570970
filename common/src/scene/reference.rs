//! Published results of a built-in scene, which tests, calibration and reports compare with.

use super::builtin;
use super::faults::Faults;
use super::input::InputFile;
use super::section::Section;
use std::collections::BTreeMap;

/// The published results of a built-in scene by name, in SI units and cycles; empty if none are known.
///
/// They stand with their source in `common/scenes/NAME.reference.toml`.
///
/// # Errors
/// Faults of that file.
pub fn published_results(scene: &str) -> Result<BTreeMap<String, f64>, Faults> {
    let Some(text) = builtin::reference(scene) else { return Ok(BTreeMap::new()) };
    InputFile::parse(text, scene)?.read(|file| {
        let published = file.section("published", "a table of results");
        let results = published.iter().flat_map(Section::entries).filter_map(|(name, value)| {
            let found = file.cx.value(&format!("published.{name}"), value, None)?;
            Some((name.clone(), found.value))
        });
        results.collect()
    })
}
