//! `coordinator sensitivity` and `coordinator report`: results of a finished study, without a new evaluation.
//!
//! Prints a page to a PDF file with a browser of this machine.

use super::learn::confidence as confidence_level;
use super::shared::ReportTexts;
use super::stored_study::{not_finished, scene_of};
use super::{CommandError, Done, OpenedStudy, print, summary_of, to_json};
use clap::Args;
use coordinator::analyses::learn::confident_answer;
use coordinator::presentation::report;
use coordinator::presentation::report::answer::{Answer, AnswerPart, Table};
use coordinator::presentation::report::format::{number_of_cycles, signed_with_width};
use coordinator::results::store::CampaignFile;
use coordinator::results::summary::{SensitivityRow, SobolRow, StudySummary};
use coordinator::statistics::reliability::REACH;
use coordinator::statistics::updating::ConfidentReliability;
use serde_json::{Value, json};
use std::ffi::OsStr;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Number of variables shown per limit state.
const SHOWN: usize = 10;

/// Arguments of `coordinator report`.
#[derive(Debug, Clone, Args)]
pub struct ReportArguments {
    /// Folder of the study
    pub dir: PathBuf,
    /// Folder for the files, created if missing [default: that of the study]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print the report to report.pdf as well, with a browser of this machine (Chromium, Chrome, Edge)
    #[arg(long)]
    pub pdf: bool,
    /// R and the lives at this confidence as well, with what the samples of measured variables leave open, in confidence.html
    #[arg(long, value_name = "SHARE", value_parser = confidence_level)]
    pub confidence: Option<f64>,
    #[command(flatten)]
    pub texts: ReportTexts,
}

/// Writes the result files and the report of a finished study again.
///
/// # Errors
/// [`CommandError::Store`], [`CommandError::BadInput`], [`CommandError::Failed`], or the error of a file that cannot be written.
pub fn report(arguments: &ReportArguments, as_json: bool) -> Done {
    let ReportArguments { dir, out, pdf, confidence, texts } = arguments;
    let (campaign, texts) = (CampaignFile::look(dir)?, texts.given());
    let stated = confidence.map(|confidence| at_confidence(dir, confidence)).transpose()?;
    let page = match out {
        Some(out) => write_results(&campaign, out, &texts)?,
        None => write_results(&campaign, dir, &texts).map_err(|error| error.of_report_in(dir))?,
    };
    let printed =
        pdf.then(|| print_page(&page, &std::env::var_os("PATH").unwrap_or_default())).transpose()?;
    let confidence_page = stated.as_ref().map(|(answer, _)| answer.write(out.as_ref().unwrap_or(dir)));
    let confidence_page = confidence_page.transpose()?;
    if as_json {
        let mut written = json!({ "report": page });
        if let Some(file) = printed {
            written["pdf"] = json!(file);
        }
        if let Some((_, confident)) = stated {
            written["confident"] = json!(confident);
        }
        return print(&to_json(&written)?);
    }
    let text = stated.map_or(String::new(), |(answer, _)| answer.text() + "\n");
    let files = [Some(page), printed, confidence_page].into_iter().flatten();
    print(&files.fold(text, |text, file| text + &format!("{}\n", file.display())))
}

/// R and the lives of a finished study at a confidence, with what the samples of its measured variables leave open.
///
/// # Errors
/// As [`OpenedStudy::confident`].
pub fn at_confidence(dir: &Path, confidence: f64) -> Done<(Answer, ConfidentReliability)> {
    let opened = OpenedStudy::open(dir, false)?;
    let confident = opened.confident(&opened.present()?, confidence)?;
    let StudySummary { scene, reliability, .. } = &opened.summary;
    let end = f64::from(opened.study.scene().life.cycles);
    Ok((confident_answer(&confident, scene, reliability, end), confident))
}

/// Writes every result file of a finished study to the folder `out`, with these texts by their keys in a scene; returns the path of the
/// report.
///
/// # Errors
/// [`CommandError::BadInput`], or the error of a file that cannot be written.
pub fn write_results(campaign: &CampaignFile, out: &Path, texts: &[(&'static str, &str)]) -> Done<PathBuf> {
    let source = scene_of(campaign)?;
    report::write_all(campaign, source.nominal(), out, texts)?.ok_or_else(|| not_finished(campaign))
}

/// Prints the sensitivities of the failure probabilities of a finished study.
///
/// # Errors
/// [`CommandError::Store`], [`CommandError::BadInput`].
pub fn sensitivity(dir: &Path, as_json: bool) -> Done {
    let summary = summary_of(&CampaignFile::look(dir)?)?;
    if as_json {
        return print(&to_json(&rows_with_sobol(&summary))?);
    }
    let states = summary.limit_states.iter().map(String::as_str).chain(["total"]);
    let parts: Vec<AnswerPart> = states.flat_map(|state| of_state(&summary, state)).collect();
    let title = format!("Sensitivities of the failure probabilities of {}", summary.scene);
    print(&Answer { title, parts, ..Answer::default() }.text())
}

/// The rows of the sensitivities, with the Sobol indices of the same variable at the same checkpoint as `sobol` where there are any.
fn rows_with_sobol(summary: &StudySummary) -> Vec<Value> {
    let with_sobol = |row: &SensitivityRow| {
        let mut object = json!(row);
        if let Some(sobol) = sobol_of(summary, row) {
            object["sobol"] = json!({
                "first_order": sobol.first_order,
                "total": sobol.total,
                "standard_error": sobol.standard_error,
            });
        }
        object
    };
    summary.sensitivity.iter().map(with_sobol).collect()
}

/// The Sobol indices of the variable of a sensitivity, of the same limit state at the same checkpoint.
fn sobol_of<'a>(summary: &'a StudySummary, row: &SensitivityRow) -> Option<&'a SobolRow> {
    let same = |sobol: &&SobolRow| {
        (&sobol.limit_state, sobol.cycles, &sobol.variable) == (&row.limit_state, row.cycles, &row.variable)
    };
    summary.sobol.iter().find(same)
}

/// The sensitivities of a limit state, or of the system as `total`, where its reliability is nearest one half.
fn of_state(summary: &StudySummary, state: &str) -> Vec<AnswerPart> {
    let Some(cycles) = checkpoint_nearest_one_half(summary, state) else {
        let none = format!("{state}: no sensitivity, the failure probability is 0 or 1 at every checkpoint");
        return vec![AnswerPart::Text(none)];
    };
    let bounded = summary.variables.iter().any(|row| row.lower.is_some() || row.upper.is_some());
    let mut meaning = format!(
        "{state}, at {}: derivatives of the failure probability by the mean and the standard deviation (std) of a variable{}, times \
         its standard deviation: to first order the change for an increase by one; ± 1.96 standard errors of sampling alone",
        number_of_cycles(cycles).replace('\u{a0}', ""),
        if bounded { ", with the bounds of bounded variables held" } else { "" }
    );
    let mut head = vec!["variable", "mean", "std"];
    if summary.sobol.iter().any(|row| row.limit_state == *state && row.cycles == cycles) {
        meaning += "\nSobol indices: share of the variance of the output by the variable alone (first order), and with its interactions (total)";
        head.extend(["Sobol first order", "Sobol total"]);
    }
    let rows = strongest(summary, state, cycles);
    let note = format!("({SHOWN} of {} variables, those of the largest changes; --json has all)", rows.len());
    let shown = (rows.len() > SHOWN).then(|| ((0..SHOWN).collect(), note));
    let table = Table::new("", head, rows.into_iter().map(|row| cells(summary, row)));
    vec![AnswerPart::Text(meaning), AnswerPart::Table(Table { shown, ..table })]
}

fn cells(summary: &StudySummary, row: &SensitivityRow) -> Vec<String> {
    let [of_mean, of_std] = row.scaled_errors().map(|error| REACH * error);
    let own = [
        row.variable.clone(),
        signed_with_width(row.scaled.d_pf_d_mean, of_mean),
        signed_with_width(row.scaled.d_pf_d_std, of_std),
    ];
    let of_variance =
        |s: &SobolRow| [(s.first_order, s.standard_error.first_order), (s.total, s.standard_error.total)];
    let shown = |(share, error): (f64, f64)| format!("{share:.3} ± {:.3}", REACH * error);
    own.into_iter().chain(sobol_of(summary, row).into_iter().flat_map(of_variance).map(shown)).collect()
}

/// Of the checkpoints with derivatives, the one where the reliability is nearest one half.
fn checkpoint_nearest_one_half(summary: &StudySummary, state: &str) -> Option<u32> {
    let has_derivatives = |cycles: u32| strongest(summary, state, cycles).iter().any(|row| row.is_known());
    let known = summary.reliability.iter().filter(|row| has_derivatives(row.cycles));
    let distances = known.filter_map(|row| Some((row.cycles, (row.reliability.get(state)? - 0.5).abs())));
    distances.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(cycles, _)| cycles)
}

/// The variables, those with the largest changes first.
fn strongest<'s>(summary: &'s StudySummary, state: &str, cycles: u32) -> Vec<&'s SensitivityRow> {
    let of_state = |row: &&SensitivityRow| row.cycles == cycles && row.limit_state == state;
    let mut rows: Vec<_> = summary.sensitivity.iter().filter(of_state).collect();
    rows.sort_by(|a, b| b.strength().total_cmp(&a.strength()));
    rows
}

/// Browsers that print without a window, in the order of preference.
const BROWSERS: [&str; 5] =
    ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "microsoft-edge"];

/// The first browser in the folders of `path`, the value of the environment variable PATH.
fn browser(path: &OsStr) -> Option<PathBuf> {
    BROWSERS.iter().find_map(|name| {
        std::env::split_paths(path).map(|folder| folder.join(name)).find(|file| file.is_file())
    })
}

/// Prints a page to the file of the same name that ends in `.pdf`, with a browser from the folders of `path`; returns the
/// file.
///
/// # Errors
/// [`CommandError::Failed`] if none of the browsers is there, starts or writes a file.
pub fn print_page(page: &Path, path: &OsStr) -> Done<PathBuf> {
    let no_pdf = |fault: String| CommandError::Failed(format!("no PDF: {fault}"));
    let browser = browser(path).ok_or_else(|| {
        let (browsers, page) = (BROWSERS.join(", "), page.display());
        no_pdf(format!(
            "none of {browsers} is on the path; open {page} in any browser and print it to a file, its style sheet is made for A4"
        ))
    })?;
    let not_started =
        |error: std::io::Error| no_pdf(format!("{} cannot be started: {error}", browser.display()));
    let page = std::path::absolute(page).map_err(not_started)?;
    let file = page.with_extension("pdf");
    if let Err(error) = std::fs::remove_file(&file)
        && error.kind() != std::io::ErrorKind::NotFound
    {
        return Err(not_started(error));
    }
    // A profile of its own: a browser with open windows would take the page over and print nothing.
    let profile = tempfile::tempdir().map_err(not_started)?;
    let mut command = Command::new(&browser);
    command
        .args([
            "--headless",
            "--disable-gpu",
            "--disable-background-networking",
            "--no-first-run",
            "--no-pdf-header-footer",
        ])
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .arg(format!("--print-to-pdf={}", file.display()));
    // Chromium refuses to start as root (the owner of the new profile) in its sandbox; the page is this program's own and loads
    // nothing.
    if std::fs::metadata(profile.path()).map_err(not_started)?.uid() == 0 {
        command.arg("--no-sandbox");
    }
    let done = command.arg(&page).output().map_err(not_started)?;
    if file.is_file() {
        return Ok(file);
    }
    let messages = String::from_utf8_lossy(&done.stderr);
    let message = messages.lines().rev().find(|line| !line.trim().is_empty()).unwrap_or("none");
    Err(no_pdf(format!("{} wrote no file; its last message: {message}", browser.display())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::fs::PermissionsExt;

    /// A folder with a program `google-chrome` of these lines of the shell, and a page next to it.
    fn with_browser(lines: &str) -> (tempfile::TempDir, PathBuf) {
        let dir = tempfile::tempdir().expect("a folder");
        let program = dir.path().join("google-chrome");
        std::fs::write(&program, format!("#!/bin/sh\n{lines}\n")).expect("a program");
        std::fs::set_permissions(&program, std::fs::Permissions::from_mode(0o755)).expect("its rights");
        let page = dir.path().join("report.html");
        std::fs::write(&page, "<p>a</p>").expect("a page");
        (dir, page)
    }

    #[test]
    fn a_browser_on_the_path_prints_the_page() {
        let lines = "for word; do case $word in --print-to-pdf=*) out=${word#*=};; esac; last=$word; done\n\
                     /bin/cp \"$last\" \"$out\"";
        let (dir, page) = with_browser(lines);
        let file = print_page(&page, dir.path().as_os_str()).expect("a PDF file");
        assert_eq!(file, dir.path().join("report.pdf"));
        assert_eq!(std::fs::read_to_string(file).expect("the copy"), "<p>a</p>");
    }

    #[test]
    fn without_a_file_or_a_browser_there_is_a_sentence() {
        let (dir, page) = with_browser("echo first >&2; echo no display >&2; exit 3");
        // A file from before is no result.
        std::fs::write(page.with_extension("pdf"), "old").expect("an old file");
        let said = print_page(&page, dir.path().as_os_str()).unwrap_err().to_string();
        assert!(said.ends_with("google-chrome wrote no file; its last message: no display"), "{said}");
        let said = print_page(&page, OsStr::new("")).unwrap_err().to_string();
        assert!(
            said.starts_with("no PDF: none of chromium, ") && said.contains("report.html in any browser"),
            "{said}"
        );
    }
}
