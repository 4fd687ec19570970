//! What direct simulation has shown of a study: `verified.json` in its folder, written by the example `verify` and stated in the report.

use super::result_files::{ResultFileError, write_text};
use serde::{Deserialize, Serialize};
use std::io::ErrorKind;
use std::path::Path;

/// Name of the file.
const FILE: &str = "verified.json";

/// A comparison of a study with simulations that it was not fitted to.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct VerificationRow {
    /// When it was made, UTC, e.g. `2026-11-23T23:18:38Z`.
    pub made: String,
    /// Evaluations of the study at that time.
    pub evaluations: usize,
    /// What was compared with what.
    pub compared: String,
    /// What was found.
    pub found: String,
}

/// The comparisons of the study in a folder; none without the file.
///
/// # Errors
/// The file cannot be read, in words.
pub fn verifications(dir: &Path) -> Result<Vec<VerificationRow>, String> {
    let failed = |error: &dyn ToString| format!("{FILE} cannot be read: {}", error.to_string());
    match std::fs::read_to_string(dir.join(FILE)) {
        Ok(text) => serde_json::from_str(&text).map_err(|error| failed(&error)),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(vec![]),
        Err(error) => Err(failed(&error)),
    }
}

/// Adds a comparison to those of the study in a folder, in place of an earlier one of the same.
///
/// # Errors
/// [`ResultFileError::Write`].
pub fn add_verification(dir: &Path, row: VerificationRow) -> Result<(), ResultFileError> {
    // A file that cannot be read is replaced.
    let mut all = verifications(dir).unwrap_or_default();
    all.retain(|known| known.compared != row.compared);
    all.push(row);
    let text = serde_json::to_string_pretty(&all).map_err(ResultFileError::NotFinite)?;
    write_text(&dir.join(FILE), &(text + "\n"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_comparison_is_replaced_by_a_later_one_of_the_same() {
        let dir = tempfile::tempdir().unwrap();
        assert_eq!(verifications(dir.path()), Ok(vec![]));
        let row = |compared: &str, evaluations: usize| VerificationRow {
            made: "2026-11-23T23:18:38Z".to_owned(),
            evaluations,
            compared: compared.to_owned(),
            found: "nothing".to_owned(),
        };
        for (compared, evaluations) in [("a", 60), ("b", 60), ("a", 80)] {
            add_verification(dir.path(), row(compared, evaluations)).unwrap();
        }
        assert_eq!(verifications(dir.path()), Ok(vec![row("b", 60), row("a", 80)]));
        std::fs::write(dir.path().join(FILE), "{").unwrap();
        assert!(verifications(dir.path()).unwrap_err().starts_with("verified.json cannot be read"));
    }
}
