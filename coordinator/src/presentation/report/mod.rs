//! The report of a study: `report.html`, one file without references to the network or to other files, and every figure of
//! it as an SVG file in `figures/`, with its numbers as CSV.

mod animation;
pub mod answer;
mod bars;
mod chapters;
pub mod compare;
pub mod drawing;
mod figures;
mod input;
pub mod levels;
pub mod life;
mod mechanism;
pub mod nominal_page;
mod page;
pub mod palette;
mod plot;
pub mod polar;
mod sliders;
mod studied;
mod tables;
#[cfg(test)]
mod tests;
pub mod untested;
pub mod variants;
mod words;
mod written;

pub use super::format;
pub use crate::results::csv_table::csv;
pub use answer::{Answer, AnswerPart, Table};
pub use chapters::page as render;
pub use figures::{ComparedStudy, LifeAxis, VaryingLoads, reliability as reliability_figure};
pub use input::{
    CheckpointDistribution, DISTRIBUTIONS_DOCUMENT, EXPLICIT_DOCUMENT, ReportInput, SUMMARY_DOCUMENT,
    SimulatedSample, WorkTotals,
};
pub use life::{failure_probability, reliability};
pub use page::{Drawing, Figure, LiveStatus, Page, captioned, standalone};
pub use palette::{Ink, SERIES};
pub use plot::{Axis, Band, Plot, Points, Scale, Series, Shape, tick_label};
pub use tables::{table, table_of, table_of_text};
pub use written::WrittenScene;

use crate::results::result_files::{
    ResultFileError, create_folder, reliability_csv, summary_json, write_samples_csv, write_text,
};
use crate::results::store::CampaignFile;
use crate::results::summary::StudySummary;
use bars::Bars;
use common::scene::Scene;
use std::path::{Path, PathBuf};

/// Writes `report.html`, and every figure of it as `figures/*.svg` with its numbers as `figures/*.csv`, into `dir`;
/// returns the path of the page.
///
/// # Errors
/// [`ResultFileError`].
pub fn write(dir: &Path, input: &ReportInput) -> Result<PathBuf, ResultFileError> {
    let page = render(input, true);
    write_figures(dir, &page.figures)?;
    let path = dir.join("report.html");
    write_text(&path, &page.html(None))?;
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
/// [`ResultFileError`].
pub fn deliver(
    campaign: &mut CampaignFile,
    scene: &Scene,
    summary: &StudySummary,
    distributions: &[CheckpointDistribution],
) -> Result<PathBuf, ResultFileError> {
    // Checked before anything is stored: numbers that JSON cannot hold could not be read back.
    summary_json(summary)?;
    campaign.put_document(DISTRIBUTIONS_DOCUMENT, &distributions)?;
    campaign.put_document(SUMMARY_DOCUMENT, summary)?;
    let written = write_all(campaign, scene, &campaign.dir, &[])?;
    Ok(written.expect("the summary was stored two statements ago"))
}

/// Writes `summary.json`, `reliability.csv`, `samples.csv`, `scene.toml`, `report.html` and `figures/` of a finished study from
/// its campaign file alone into the folder `dir`, which is created if missing; the page states `texts` by their keys in a scene in place of
/// those of the scene. Returns the path of the page, or `None` if the study has not been finished.
///
/// # Errors
/// [`ResultFileError`].
pub fn write_all(
    campaign: &CampaignFile,
    scene: &Scene,
    dir: &Path,
    texts: &[(&'static str, &str)],
) -> Result<Option<PathBuf>, ResultFileError> {
    let Some(mut input) = ReportInput::from_campaign(campaign, scene)? else { return Ok(None) };
    input.sign(texts);
    create_folder(dir)?;
    write_text(&dir.join("summary.json"), &summary_json(&input.summary)?)?;
    write_text(&dir.join("reliability.csv"), &reliability_csv(&input.summary))?;
    write_samples_csv(&dir.join("samples.csv"), campaign, scene)?;
    write_text(&dir.join("scene.toml"), &input.meta.scene_source)?;
    write(dir, &input).map(Some)
}
