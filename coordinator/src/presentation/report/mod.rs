//! The report of a study: `report.html`, one file without references to the network or to other files, and every figure of
//! it as an SVG file in `figures/`, with its numbers as CSV.

mod animation;
pub mod answer;
mod bars;
pub mod compare;
pub mod drawing;
mod figure;
mod figures;
pub mod format;
mod grooves;
mod input;
pub mod life;
pub mod life_change;
mod mechanism;
pub mod nominal_page;
mod page;
pub mod palette;
mod plot;
mod png;
pub mod polar;
mod stated;
mod stated_errors;
mod studied;
mod tables;
#[cfg(test)]
mod tests;
pub mod untested;
mod words;
mod written;

pub use figure::Figure;
pub use figures::reliability as reliability_figure;
pub use input::{
    CheckpointDistribution, DISTRIBUTIONS_DOCUMENT, FailedRun, OutputInfo, ReportInput, SUMMARY_DOCUMENT,
    SimulatedSample, VariableInfo, WorkTotals, equal_edges,
};
pub use life::{failure_probability, reliability};
pub use mechanism::Mechanism;
pub use page::{standalone, wrapped};
pub use plot::{Axis, Plot, PlotError, Points, Scale, Series, Shape};
pub use png::{PngError, PngMaker};
pub use stated_errors::StatedAt;

use page::FigureFiles;

use crate::results::result_files::{
    ResultFileError, create_folder, reliability_csv, summary_json, write_bytes, write_samples_csv, write_text,
};
use crate::results::store::{CampaignFile, StoreError};
use crate::results::summary::StudySummary;
use common::scene::Scene;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Reasons why a report cannot be written.
#[derive(Debug, Error)]
pub enum ReportError {
    /// A figure cannot be drawn.
    #[error(transparent)]
    Plot(#[from] PlotError),
    /// A file cannot be written.
    #[error(transparent)]
    File(#[from] ResultFileError),
    /// The campaign file cannot be read or written.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// A figure has no picture.
    #[error(transparent)]
    Png(#[from] PngError),
}

impl ReportError {
    /// True if the user named a file or folder that cannot be used (exit code 2), false for other failures (exit code 1).
    pub fn is_bad_input(&self) -> bool {
        match self {
            Self::File(error) => error.is_bad_input(),
            Self::Store(error) => error.is_bad_input(),
            Self::Plot(_) | Self::Png(_) => false,
        }
    }
}

/// A report in memory.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// Text of `report.html`.
    pub html: String,
    /// Figures of the page, also written as files of their own.
    pub figures: Vec<Figure>,
}

/// Renders the report; a function of its input alone.
///
/// # Errors
/// [`PlotError`].
pub fn render(input: &ReportInput) -> Result<Report, PlotError> {
    rendered(input, FigureFiles::NextToPage)
}

/// Renders the report as a page without links to files; a function of its input alone.
///
/// # Errors
/// [`PlotError`].
pub fn render_alone(input: &ReportInput) -> Result<Report, PlotError> {
    rendered(input, FigureFiles::Absent)
}

fn rendered(input: &ReportInput, files: FigureFiles) -> Result<Report, PlotError> {
    let reliability = [figures::reliability(&input.summary)?, figures::first_failure(input)?];
    let sections = page::Sections {
        studied: studied::figure(input).into_iter().collect(),
        reliability: reliability.into_iter().flatten().collect(),
        rates: figures::failure_rates(&input.summary)?,
        outputs: [figures::distributions(input)?, figures::histories(input)?].concat(),
        inputs: figures::input_histograms(input)?,
        combinations: figures::parallel_coordinates(input)?.into_iter().collect(),
        sensitivity: figures::sensitivities(input)?,
        variance: figures::variance_contributions(input)?,
        motion: animation::animation(input),
        bores: figures::bores(input),
        orbits: figures::orbits(input),
        first_cycle: figures::first_cycle(input)?,
        last_cycle: figures::last_cycle(input)?,
        predictions: figures::predicted_against_simulated(input)?,
        learning: figures::learning(input)?,
        numerical: figures::numerical(input)?,
    };
    let html = page::html(input, &sections, files);
    Ok(Report { html, figures: sections.into_figures() })
}

/// Writes `report.html`, and every figure of it as `figures/*.svg` with its numbers as `figures/*.csv`, into `dir`;
/// returns the path of the page.
///
/// # Errors
/// [`ReportError`].
pub fn write(dir: &Path, input: &ReportInput) -> Result<PathBuf, ReportError> {
    let report = render(input)?;
    write_figures(dir, &report.figures)?;
    let path = dir.join("report.html");
    write_text(&path, &report.html)?;
    Ok(path)
}

/// Writes figures as `figures/*.svg` with their numbers as `figures/*.csv` into `dir`.
fn write_figures(dir: &Path, figures: &[Figure]) -> Result<(), ResultFileError> {
    let folder = dir.join("figures");
    create_folder(&folder)?;
    for figure in figures {
        write_text(&folder.join(format!("{}.svg", figure.name)), &page::standalone(figure))?;
        write_text(&folder.join(format!("{}.csv", figure.name)), &figure.csv)?;
    }
    Ok(())
}

/// Ends a study: stores its results in the campaign file, then writes every file of its folder ([`write_all`]);
/// returns the path of the page.
///
/// # Errors
/// [`ReportError`].
pub fn deliver(
    campaign: &mut CampaignFile,
    scene: &Scene,
    summary: &StudySummary,
    distributions: &[CheckpointDistribution],
) -> Result<PathBuf, ReportError> {
    // Checked before anything is stored: numbers that JSON cannot hold could not be read back.
    summary_json(summary)?;
    campaign.put_document(DISTRIBUTIONS_DOCUMENT, &distributions)?;
    campaign.put_document(SUMMARY_DOCUMENT, summary)?;
    let written = write_all(campaign, scene, campaign.dir())?;
    Ok(written.expect("the summary was stored two statements ago"))
}

/// Writes `summary.json`, `reliability.csv`, `samples.csv`, `scene.toml`, `report.html` and `figures/` of a finished study from
/// its campaign file alone into the folder `dir`, which is created if missing; returns the path of the page, or `None` if
/// the study has not been finished.
///
/// # Errors
/// [`ReportError`].
pub fn write_all(campaign: &CampaignFile, scene: &Scene, dir: &Path) -> Result<Option<PathBuf>, ReportError> {
    let Some(input) = ReportInput::from_campaign(campaign, scene)? else { return Ok(None) };
    create_folder(dir)?;
    write_text(&dir.join("summary.json"), &summary_json(&input.summary)?)?;
    write_text(&dir.join("reliability.csv"), &reliability_csv(&input.summary))?;
    write_samples_csv(&dir.join("samples.csv"), campaign, scene)?;
    write_text(&dir.join("scene.toml"), &input.scene_source)?;
    write(dir, &input).map(Some)
}

/// Writes every figure of the report of a finished study as `figures/*.png` into the folder `dir`; returns their number, or `None` if the
/// study has not been finished.
///
/// # Errors
/// [`ReportError`].
pub fn write_pictures(
    campaign: &CampaignFile,
    scene: &Scene,
    dir: &Path,
) -> Result<Option<usize>, ReportError> {
    let Some(input) = ReportInput::from_campaign(campaign, scene)? else { return Ok(None) };
    let (maker, figures) = (PngMaker::new()?, render(&input)?.figures);
    let folder = dir.join("figures");
    for figure in &figures {
        let picture = maker.png(figure)?;
        let path = folder.join(format!("{}.png", figure.name));
        write_bytes(&path, &picture)?;
    }
    Ok(Some(figures.len()))
}
