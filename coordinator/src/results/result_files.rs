//! The result files of a finished study: `summary.json`, `reliability.csv`, `samples.csv`. Each is written under a
//! temporary name and renamed, so that a reader never finds half a file.

use crate::results::csv_table::{csv, number, plain_text};
use crate::results::store::{CampaignFile, StoreError, is_unusable_path};
use crate::results::summary::{PerLimitState, ReliabilityRange, StudySummary};
use common::scene::Scene;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// A result file that cannot be written.
#[derive(Debug, Error)]
pub enum ResultFileError {
    /// The file cannot be written.
    #[error("{path}: {1}", path = .0.display())]
    Write(PathBuf, #[source] std::io::Error),
    /// The result has a number that JSON cannot represent.
    #[error("summary.json: a result is not a finite number: {0}")]
    NotFinite(serde_json::Error),
    /// The campaign file cannot be read.
    #[error(transparent)]
    Store(#[from] StoreError),
}

impl ResultFileError {
    /// True if the user named a file or folder that cannot be used (exit code 2), false for other failures (exit code 1).
    pub fn is_bad_input(&self) -> bool {
        match self {
            Self::Write(_, source) => is_unusable_path(source),
            Self::NotFinite(_) => false,
            Self::Store(error) => error.is_bad_input(),
        }
    }
}

/// Writes a file completely or not at all: a temporary file in the same folder, flushed to the disk, then renamed. A
/// symbolic link stays, and its target is written. Devices and pipes, such as `/dev/stdout`, are written to directly.
///
/// # Errors
/// [`ResultFileError::Write`].
pub fn write_atomically(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> Result<(), ResultFileError>,
) -> Result<(), ResultFileError> {
    let failed = |source| ResultFileError::Write(path.into(), source);
    if is_stream(path) {
        let mut stream = std::io::BufWriter::new(File::options().write(true).open(path).map_err(failed)?);
        fill(&mut stream)?;
        return stream.flush().map_err(failed);
    }
    let target = path.canonicalize().unwrap_or_else(|_| path.to_path_buf());
    let path = target.as_path();
    let mut name = std::ffi::OsString::from(".");
    name.push(path.file_name().unwrap_or_default());
    name.push(".part");
    let part = path.with_file_name(name);
    let write = || {
        let mut file = std::io::BufWriter::new(File::create(&part).map_err(failed)?);
        fill(&mut file)?;
        let file = file.into_inner().map_err(|error| failed(error.into_error()))?;
        file.sync_all().map_err(failed)?;
        std::fs::rename(&part, path).map_err(failed)?;
        // The name of a file is on the disk with its folder.
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        File::open(folder.unwrap_or(Path::new("."))).and_then(|folder| folder.sync_all()).map_err(failed)
    };
    let written = write();
    if written.is_err() {
        // The rest of a failed attempt is useless; a failure to remove it adds nothing to the first error.
        let _ = std::fs::remove_file(&part);
    }
    written
}

/// Whether the path names a device, a pipe or an open file of a process, which a new file must not replace.
fn is_stream(path: &Path) -> bool {
    let is_special = std::fs::metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir());
    is_special || path.starts_with("/dev/fd") || path.starts_with("/dev/stdout") || path.starts_with("/proc")
}

/// Creates a folder and those above it, if missing.
///
/// # Errors
/// [`ResultFileError::Write`].
pub fn create_folder(path: &Path) -> Result<(), ResultFileError> {
    std::fs::create_dir_all(path).map_err(|source| ResultFileError::Write(path.into(), source))
}

/// Writes text to a file, completely or not at all.
///
/// # Errors
/// [`ResultFileError::Write`].
pub fn write_text(path: &Path, text: &str) -> Result<(), ResultFileError> {
    let failed = |source| ResultFileError::Write(path.into(), source);
    write_atomically(path, |file| file.write_all(text.as_bytes()).map_err(failed))
}

/// `summary.json` as text.
///
/// # Errors
/// [`ResultFileError::NotFinite`]: JSON would turn infinity into `null`.
pub fn summary_json(summary: &StudySummary) -> Result<String, ResultFileError> {
    let mut text = serde_json::to_string_pretty(summary).map_err(ResultFileError::NotFinite)?;
    serde_json::from_str::<StudySummary>(&text).map_err(ResultFileError::NotFinite)?;
    text.push('\n');
    Ok(text)
}

/// `reliability.csv` as text: `cycles`, then `R_<limit state>, se_<limit state>` in the scene's order, then
/// `R_total, se_total`; then, in the same order, `low_<limit state>, high_<limit state>`, the 95 % interval of R, every error that is
/// known included.
pub fn reliability_csv(summary: &StudySummary) -> String {
    let keys: Vec<&str> = summary.limit_states.iter().map(String::as_str).chain(["total"]).collect();
    let mut columns = vec!["cycles".to_owned()];
    for [first, second] in [["R_", "se_"], ["low_", "high_"]] {
        columns.extend(keys.iter().flat_map(|key| [format!("{first}{key}"), format!("{second}{key}")]));
    }
    let value = |values: &PerLimitState, key: &str| values.get(key).copied().map_or(String::new(), number);
    let ends = |range: Option<ReliabilityRange>| {
        range.map(|range| [number(range.lower), number(range.upper)]).unwrap_or_default()
    };
    let rows = summary.reliability.iter().map(|row| {
        let estimates =
            keys.iter().flat_map(|key| [value(&row.reliability, key), value(&row.standard_error, key)]);
        let intervals = keys.iter().flat_map(|key| ends(row.interval_of(key)));
        [row.cycles.to_string()].into_iter().chain(estimates).chain(intervals)
    });
    csv(columns, rows)
}

/// Writes `samples.csv`: one row per recorded evaluation with `id`, every random variable by name (SI), every
/// output at every checkpoint as `<output>_<unit>@<cycles>` (empty if the evaluation failed), `failure`,
/// `worker`, `wall_s`, `finished_at`, and `level`, 0 for the working accuracy.
///
/// # Errors
/// [`ResultFileError`].
pub fn write_samples_csv(path: &Path, campaign: &CampaignFile, scene: &Scene) -> Result<(), ResultFileError> {
    let checkpoints = scene.life.checkpoints();
    let failed = |error: csv::Error| ResultFileError::Write(path.into(), error.into());
    write_atomically(path, |file| {
        let mut writer = csv::Writer::from_writer(file);
        let mut columns = vec!["id".to_owned()];
        columns.extend(scene.variables.iter().map(|variable| variable.name.clone()));
        for output in &scene.outputs {
            let key = output.kind.unit().key(&output.name);
            columns.extend(checkpoints.iter().map(|cycles| format!("{key}@{cycles}")));
        }
        columns.extend(["failure", "worker", "wall_s", "finished_at", "level"].map(str::to_owned));
        writer.write_record(columns.iter().map(|name| plain_text(name))).map_err(failed)?;
        campaign.for_each(|stored| {
            let mut cells = vec![stored.id.to_string()];
            cells.extend(stored.sample.iter().copied().map(number));
            for (row, output) in scene.outputs.iter().enumerate() {
                let unit = output.kind.unit();
                cells.extend(checkpoints.iter().map(|cycles| {
                    let value = stored.outcome.as_ref().ok().and_then(|evaluation| {
                        let column = evaluation.cycles.iter().position(|checkpoint| checkpoint == cycles)?;
                        Some(*evaluation.histories.get(row)?.get(column)?)
                    });
                    value.map_or(String::new(), |si| number(unit.to_file(si)))
                }));
            }
            let failure = stored.outcome.err().map_or(String::new(), |failure| failure.to_string());
            let [failure, worker] = [&failure, &stored.worker].map(|text| plain_text(text));
            cells.extend([failure, worker, number(stored.wall), stored.finished_at.to_string()]);
            cells.push(stored.level.to_string());
            writer.write_record(&cells).map_err(failed)
        })?;
        writer.flush().map_err(|source| ResultFileError::Write(path.into(), source))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::test_study;

    #[test]
    fn the_summary_has_the_keys_of_the_contract_and_reads_back() {
        let summary = test_study::study().summary;
        let text = summary_json(&summary).unwrap();
        let json: serde_json::Value = serde_json::from_str(&text).unwrap();
        for key in [
            "scene",
            "seed",
            "method",
            "accuracy",
            "evaluations",
            "limit_states",
            "reliability",
            "moments",
            "sensitivity",
            "convergence",
            "timing_s",
            "workers",
        ] {
            assert!(json.get(key).is_some(), "{key}");
        }
        let keys = |value: &serde_json::Value| value.as_object().unwrap().keys().cloned().collect::<Vec<_>>();
        assert_eq!(keys(&json["evaluations"]), ["added", "failed", "initial", "total"]);
        assert_eq!(
            keys(&json["reliability"][0]),
            ["asymmetry", "cycles", "interval", "parts", "standard_error", "total", "wear"]
        );
        assert_eq!(
            keys(&json["moments"][0]),
            ["asymmetry_mean_rpm", "asymmetry_std_rpm", "cycles", "wear_mean_m", "wear_std_m"]
        );
        for key in ["cycles", "limit_state", "variable", "d_pf_d_mean", "d_pf_d_std", "standard_error"] {
            assert!(json["sensitivity"][0].get(key).is_some(), "{key}");
        }
        for key in ["total", "simulation", "surrogate", "idle"] {
            assert!(json["timing_s"][key].is_number(), "{key}");
        }
        assert!(json["convergence"]["stopped_because"].is_string());
        assert_eq!(serde_json::from_str::<StudySummary>(&text).unwrap().reliability.len(), 72);
    }

    /// Studies by earlier versions lack what was added since.
    #[test]
    fn a_summary_without_later_fields_is_read() {
        let mut json = serde_json::to_value(test_study::study().summary).unwrap();
        let later =
            ["schema", "created", "scene_sha256", "limits", "variables", "failure_points", "predictions"];
        for key in later {
            assert!(json.as_object_mut().unwrap().remove(key).is_some(), "{key}");
        }
        let mut summary: StudySummary = serde_json::from_value(json).unwrap();
        assert_eq!((summary.schema, summary.created.as_str(), summary.limits.len()), (0, "", 0));
        // The report of such a study states them from its scene.
        summary.identify(&test_study::scene(), "abc", "2026-01-31T12:00:00.000Z");
        assert_eq!((summary.schema, summary.limits.len(), summary.variables.len()), (1, 2, 30));
        assert!(summary.scene_sha256.starts_with("ba7816bf"), "{}", summary.scene_sha256);
    }

    #[test]
    fn a_summary_with_an_infinite_number_is_refused() {
        let mut summary = test_study::study().summary;
        summary.convergence.rounds[0].min_u = f64::INFINITY;
        assert!(matches!(summary_json(&summary), Err(ResultFileError::NotFinite(_))));
    }

    #[test]
    fn reliability_csv_reads_back_exactly() {
        let summary = test_study::study().summary;
        let text = reliability_csv(&summary);
        let mut lines = text.lines();
        assert_eq!(
            lines.next().unwrap(),
            "cycles,R_wear,se_wear,R_asymmetry,se_asymmetry,R_total,se_total,\
             low_wear,high_wear,low_asymmetry,high_asymmetry,low_total,high_total"
        );
        for (line, row) in lines.by_ref().zip(&summary.reliability) {
            let values: Vec<f64> = line.split(',').map(|value| value.parse().unwrap()).collect();
            assert_eq!(values[0], f64::from(row.cycles));
            assert_eq!(values[1], row.reliability["wear"]);
            assert_eq!(values[6], row.standard_error["total"]);
            assert_eq!(
                (values[9], values[12]),
                (row.interval["asymmetry"].lower, row.interval["total"].upper)
            );
        }
        assert_eq!(text.lines().count(), 73);
    }

    #[test]
    fn samples_csv_has_a_column_for_every_value_and_a_row_for_every_evaluation() {
        let dir = tempfile::tempdir().unwrap();
        let scene = test_study::scene();
        let campaign = test_study::campaign(dir.path());
        let path = dir.path().join("samples.csv");
        write_samples_csv(&path, &campaign, &scene).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        let header: Vec<&str> = text.lines().next().unwrap().split(',').collect();
        assert_eq!(header.len(), 1 + scene.variables.len() + 2 * 72 + 5);
        let at = |name: &str| header.iter().position(|column| *column == name).unwrap();
        let first: Vec<&str> = text.lines().nth(1).unwrap().split(',').collect();
        let stored = campaign.evaluation(0).unwrap().unwrap();
        let evaluation = stored.outcome.unwrap();
        let rod = scene.variables.iter().position(|variable| variable.name == "rod_length").unwrap();
        assert_eq!(first[at("rod_length")].parse::<f64>().unwrap(), stored.sample[rod]);
        assert_eq!(first[at("max_wear_depth_m@64000")].parse::<f64>().unwrap(), evaluation.histories[0][63]);
        let rpm = first[at("angular_velocity_difference_rpm@64000")].parse::<f64>().unwrap();
        assert!((rpm * std::f64::consts::PI / 30.0 - evaluation.histories[1][63]).abs() < 1e-12);
        assert_eq!(text.lines().count() - 1, campaign.count().unwrap());
        assert!(text.contains(
            "\"at cycle 61000, t = 0.05 s, the bound of 200000 steps per cycle was reached; allow more"
        ));
        // Nothing of the temporary file remains.
        let parts = std::fs::read_dir(dir.path())
            .unwrap()
            .filter(|entry| entry.as_ref().unwrap().file_name().to_string_lossy().ends_with(".part"));
        assert_eq!(parts.count(), 0);
    }

    #[test]
    fn issue_a_device_was_replaced_by_a_file_and_a_full_one_was_no_error() {
        let full = Path::new("/dev/full");
        if full.exists() {
            let error = write_text(full, "text").unwrap_err().to_string();
            assert!(error.starts_with("/dev/full: "), "{error}");
            assert!(!std::fs::metadata(full).unwrap().is_file());
        }
        write_text(Path::new("/dev/null"), "text").unwrap();
        assert!(!std::fs::metadata("/dev/null").unwrap().is_file());
    }

    #[cfg(unix)]
    #[test]
    fn a_symbolic_link_stays_and_its_target_is_written() {
        let dir = tempfile::tempdir().unwrap();
        let [file, link] = ["file", "link"].map(|name| dir.path().join(name));
        std::fs::write(&file, "old").unwrap();
        std::os::unix::fs::symlink("file", &link).unwrap();
        write_text(&link, "new").unwrap();
        assert!(std::fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(std::fs::read_to_string(&file).unwrap(), "new");
    }

    #[test]
    fn a_failed_write_leaves_the_old_file_and_no_rest() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("summary.json");
        write_text(&path, "old").unwrap();
        let failed = write_atomically(&path, |file| {
            file.write_all(b"half").unwrap();
            Err(ResultFileError::Write(path.clone(), std::io::Error::other("disk full")))
        });
        assert!(failed.is_err());
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 1);
    }
}
