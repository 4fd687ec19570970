//! `coordinator schema`: the JSON Schemas of scenes and of results.

use super::error::CommandError;
use super::output::print;

/// JSON Schema (2020-12) of the language of scenes.
const SCENE: &str = include_str!("../../schemas/scene.schema.json");

/// JSON Schema (2020-12) of `summary.json`.
const SUMMARY: &str = include_str!("../../schemas/summary.schema.json");

/// Prints the schema of scenes, or of `summary.json`.
///
/// # Errors
/// [`CommandError::Output`].
pub fn schema(results: bool) -> Result<(), CommandError> {
    print(if results { SUMMARY } else { SCENE })
}
