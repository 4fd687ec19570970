//! `coordinator compare`: a page with the curves of several finished studies, and the curves as CSV.

use super::error::CommandError;
use super::output::{check_destination, print, to_json, unusable};
use super::stored_study::{scene_of, summary_of};
use clap::Args;
use common::scene::SceneSource;
use coordinator::analyses::scene_difference::{DifferingKey, differing_keys};
use coordinator::presentation::report::ReportError;
use coordinator::presentation::report::compare::{ComparedStudy, check, csv, gain, html};
use coordinator::results::result_files::{create_folder, write_text};
use coordinator::results::store::CampaignFile;
use coordinator::study::LEVELS;
use serde::Serialize;
use serde_json::json;
use std::path::{Path, PathBuf};

/// Arguments of `coordinator compare`.
#[derive(Debug, Clone, Args)]
pub struct CompareArguments {
    /// Folders of the studies
    #[arg(required = true, num_args = 2.., value_name = "DIR")]
    pub dirs: Vec<PathBuf>,
    /// The page, FILE.html, with the CSV file of the same name next to it; or the folder for compare.html and compare.csv
    #[arg(long, value_name = "DIR-or-FILE.html")]
    pub out: PathBuf,
}

/// Writes the page and its CSV, and prints the keys in which the scenes differ, the gains in life, and the paths.
///
/// # Errors
/// [`CommandError`] if a study is not finished, or the studies cannot be compared.
pub fn compare(arguments: &CompareArguments, as_json: bool) -> Result<(), CommandError> {
    let out = &arguments.out;
    let is_folder = out.extension().is_none() || out.is_dir();
    let page = &if is_folder { out.join("compare.html") } else { out.clone() };
    let numbers = page.with_extension("csv");
    if numbers == *page {
        let fault = "is the name of the CSV file: expected a name that ends in .html".to_owned();
        return Err(unusable(page, fault));
    }
    if !is_folder {
        check_destination(Some(page))?;
        check_destination(Some(&numbers))?;
    }
    let names = names(&arguments.dirs);
    let studies: Vec<ComparedStudy> =
        arguments.dirs.iter().zip(names).map(|(dir, name)| study(dir, name)).collect::<Result<_, _>>()?;
    check(&studies)?;
    let scenes: Vec<SceneSource> =
        arguments.dirs.iter().map(|dir| scene_of(&CampaignFile::look(dir)?)).collect::<Result<_, _>>()?;
    let mut differing = differing_keys(&scenes.iter().collect::<Vec<_>>());
    let accuracies: Vec<Option<String>> =
        studies.iter().map(|study| Some(study.summary.accuracy.clone())).collect();
    if accuracies.iter().any(|accuracy| *accuracy != accuracies[0]) {
        differing.insert(0, DifferingKey { key: "accuracy of the study".to_owned(), values: accuracies });
    }
    let value = |value: &Option<String>| value.clone().unwrap_or_else(|| "\u{2013}".to_owned());
    let table: Vec<(String, Vec<String>)> =
        differing.iter().map(|row| (row.key.clone(), row.values.iter().map(value).collect())).collect();
    if is_folder {
        create_folder(out)?;
    }
    write_text(page, &html(&studies, &table).map_err(ReportError::from)?)?;
    write_text(&numbers, &csv(&studies))?;
    let gains = gains(&studies);
    if as_json {
        let document = json!({ "page": page, "csv": numbers, "differences": differing, "gains": gains });
        return print(&to_json(&document)?);
    }
    let mut text = String::new();
    for (key, values) in table.iter().take(MOST_LINES) {
        text += &format!("{key}: {}\n", values.join(" | "));
    }
    if table.len() > MOST_LINES {
        text += &format!("and {} further keys, see the page\n", table.len() - MOST_LINES);
    }
    for gain in gains.iter().filter(|gain| gain.limit_state == "total") {
        text += &format!(
            "life at R = {}, {} against {} [cycles]: {}\n",
            gain.reliability, gain.study, studies[0].name, gain.in_words
        );
    }
    print(&format!("{text}{}\n{}\n", page.display(), numbers.display()))
}

fn study(dir: &Path, name: String) -> Result<ComparedStudy, CommandError> {
    Ok(ComparedStudy { name, summary: summary_of(&CampaignFile::look(dir)?)? })
}

/// Most differing keys printed on the terminal.
const MOST_LINES: usize = 12;

/// GainInLife in life of a study against the first one.
#[derive(Debug, Serialize)]
struct GainInLife {
    study: String,
    limit_state: String,
    /// Level of R to which both lives belong [1].
    reliability: f64,
    /// Difference of the lives [cycles]; absent where one of them is not resolved.
    cycles: Option<f64>,
    /// Limits of its 95 % interval [cycles].
    lower: Option<f64>,
    upper: Option<f64>,
    #[serde(skip)]
    in_words: String,
}

/// Gains of all studies but the first, per curve and level; none for studies of a single checkpoint.
fn gains(studies: &[ComparedStudy]) -> Vec<GainInLife> {
    let first = &studies[0];
    if first.summary.is_static() {
        return vec![];
    }
    let curves = first.summary.limit_states.iter().map(String::as_str).chain(["total"]);
    let of_curve = |name: &str| {
        let of_study = |k: usize, level: f64| {
            let (change, in_words) = gain(studies, k, (name, level));
            GainInLife {
                study: studies[k].name.clone(),
                limit_state: name.to_owned(),
                reliability: level,
                cycles: change.map(|change| change.value),
                lower: change.and_then(|change| change.lower),
                upper: change.and_then(|change| change.upper),
                in_words: in_words.replace('\u{a0}', " "),
            }
        };
        (1..studies.len()).flat_map(|k| LEVELS.map(|level| of_study(k, level))).collect::<Vec<_>>()
    };
    curves.flat_map(of_curve).collect()
}

/// Names of the studies: those of their folders if these differ, else the paths as given.
fn names(dirs: &[PathBuf]) -> Vec<String> {
    let given = |dir: &PathBuf| dir.display().to_string();
    let last = |dir: &PathBuf| {
        dir.file_name().map_or_else(|| given(dir), |name| name.to_string_lossy().into_owned())
    };
    let short: Vec<String> = dirs.iter().map(last).collect();
    let different = short.iter().collect::<std::collections::BTreeSet<_>>().len() == dirs.len();
    if different { short } else { dirs.iter().map(given).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn studies_are_called_by_their_folders_where_these_differ() {
        let dirs = |all: &[&str]| names(&all.iter().map(PathBuf::from).collect::<Vec<_>>());
        assert_eq!(dirs(&["a/steel", "a/bronze/"]), ["steel", "bronze"]);
        assert_eq!(dirs(&["a/study", "b/study"]), ["a/study", "b/study"]);
    }
}
