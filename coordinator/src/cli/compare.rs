//! `coordinator compare`: a page with the curves of several finished studies, and the curves as CSV.

use super::error::CommandError;
use super::output::{check_destination, print, to_json};
use super::stored_study::summary_of;
use clap::Args;
use coordinator::presentation::report::ReportError;
use coordinator::presentation::report::compare::{ComparedStudy, check, csv, html};
use coordinator::results::result_files::write_text;
use coordinator::results::store::CampaignFile;
use serde_json::json;
use std::path::{Path, PathBuf};

/// Arguments of `coordinator compare`.
#[derive(Debug, Clone, Args)]
pub struct CompareArguments {
    /// Folders of the studies
    #[arg(required = true, num_args = 2.., value_name = "DIR")]
    pub dirs: Vec<PathBuf>,
    /// The page; the CSV file has the same name with .csv
    #[arg(long, value_name = "FILE.html")]
    pub out: PathBuf,
}

/// Writes the page and its CSV, and prints their paths.
///
/// # Errors
/// [`CommandError`] if a study is not finished, or the studies cannot be compared.
pub fn compare(arguments: &CompareArguments, as_json: bool) -> Result<(), CommandError> {
    let page = &arguments.out;
    let numbers = page.with_extension("csv");
    if numbers == *page {
        let fault = "is the name of the CSV file: expected a name that ends in .html".to_owned();
        return Err(CommandError::Destination { file: page.clone(), fault });
    }
    check_destination(Some(page))?;
    check_destination(Some(&numbers))?;
    let names = names(&arguments.dirs);
    let studies: Vec<ComparedStudy> =
        arguments.dirs.iter().zip(names).map(|(dir, name)| study(dir, name)).collect::<Result<_, _>>()?;
    check(&studies)?;
    write_text(page, &html(&studies).map_err(ReportError::from)?)?;
    write_text(&numbers, &csv(&studies))?;
    if as_json {
        return print(&to_json(&json!({ "page": page, "csv": numbers }))?);
    }
    print(&format!("{}\n{}\n", page.display(), numbers.display()))
}

fn study(dir: &Path, name: String) -> Result<ComparedStudy, CommandError> {
    Ok(ComparedStudy { name, summary: summary_of(&CampaignFile::look(dir)?)? })
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
