//! `coordinator compare`: the curves of several finished studies on one page, and as CSV.

use super::output::{file_of, or_here, unusable};
use super::stored_study::scene_of;
use super::{CommandError, Destination, Done, answer_with, summary_of};
use clap::Args;
use common::scene::SceneSource;
use coordinator::analyses::scene_difference::{DifferingKey, differing_keys};
use coordinator::presentation::report::compare::{ComparedStudy, answer, change_between, check};
use coordinator::results::store::CampaignFile;
use coordinator::results::summary::StudySummary;
use coordinator::study::LEVELS;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Arguments of `coordinator compare`.
#[derive(Debug, Clone, Args)]
pub struct CompareArguments {
    /// Folders of the studies
    #[arg(required = true, num_args = 2.., value_name = "DIR")]
    pub dirs: Vec<PathBuf>,
    /// Folder for compare.html, .md, .json and .csv, created if missing; or the page, FILE.html, with those files next to it
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// Writes the page with its files, and prints lives, gains in life and the keys in which the scenes differ.
///
/// # Errors
/// [`CommandError`] if a study is not finished, or the studies cannot be compared.
pub fn compare(arguments: &CompareArguments, as_json: bool) -> Done {
    let out = arguments.out.as_deref().map(destination).transpose()?;
    let name = out.as_ref().map_or("compare", |(_, name)| name).to_owned();
    let names = names(&arguments.dirs);
    let studies: Vec<ComparedStudy> =
        arguments.dirs.iter().zip(names).map(study).collect::<Result<_, _>>()?;
    check(&studies).map_err(CommandError::bad_input)?;
    let scenes: Vec<SceneSource> =
        arguments.dirs.iter().map(|dir| scene_of(&CampaignFile::look(dir)?)).collect::<Result<_, _>>()?;
    let mut differing = differing_keys(&scenes.iter().collect::<Vec<_>>());
    let levels = |summary: &StudySummary| match &summary.levels {
        Some(levels) => levels.names.join(", "),
        None => summary.accuracy.clone(),
    };
    let accuracies: Vec<Option<String>> = studies.iter().map(|study| Some(levels(&study.summary))).collect();
    if accuracies.iter().any(|accuracy| *accuracy != accuracies[0]) {
        differing.insert(0, DifferingKey { key: "accuracy of the study".to_owned(), values: accuracies });
    }
    let value = |value: &Option<String>| value.clone().unwrap_or_else(|| "\u{2013}".to_owned());
    let table: Vec<(String, Vec<String>)> =
        differing.iter().map(|row| (row.key.clone(), row.values.iter().map(value).collect())).collect();
    let folder = out.map(|(folder, _)| folder);
    let [page, numbers] = ["html", "csv"].map(|end| Some(folder.as_ref()?.join(format!("{name}.{end}"))));
    let gains = gains(&studies);
    let document = json!({ "page": page, "csv": numbers, "differences": differing, "gains": gains });
    answer_with(&answer(name, studies, &table), &document, folder.map(Destination::Folder).as_ref(), as_json)
}

/// Folder of the files, and their name without its ending.
fn destination(out: &Path) -> Done<(PathBuf, String)> {
    let page = file_of(out, "compare.html")?;
    if page.extension().is_none_or(|end| end != "html") {
        return Err(unusable(out, "expected a folder, or a name that ends in .html".to_owned()));
    }
    let name = page.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    Ok((page.parent().map(or_here).unwrap_or(&page).to_owned(), name))
}

fn study((dir, name): (&PathBuf, String)) -> Done<ComparedStudy> {
    let summary = summary_of(&CampaignFile::look(dir)?)?;
    if !summary.designs.is_empty() {
        tracing::warn!(
            "{name}: the curves are those of a design drawn at random: `coordinator designs` compares designs"
        );
    }
    Ok(ComparedStudy { name, summary })
}

/// Gains of all studies but the first, per curve and level; none for studies of a single checkpoint.
fn gains(studies: &[ComparedStudy]) -> Vec<Value> {
    let first = &studies[0];
    if first.summary.is_static() {
        return vec![];
    }
    let curves = first.summary.limit_states.iter().map(String::as_str).chain(["total"]);
    let of_curve = |name: &str| {
        let of_study = |k: usize, level: f64| {
            let (change, _) = change_between([&first.summary, &studies[k].summary], (name, level));
            json!({ "study": studies[k].name, "limit_state": name, "reliability": level,
    "cycles": change.map(|change| change.value), "lower": change.and_then(|change| change.lower),
    "upper": change.and_then(|change| change.upper) })
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
