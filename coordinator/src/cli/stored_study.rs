//! A study in its folder, finished or not, with its scene, settings and evaluations.

use super::error::CommandError;
use super::foreign_study::{ForeignPart, ForeignStudy};
use common::scene::{Scene, SceneSource};
use coordinator::analyses::designs::{DESIGNS_DOCUMENT, DesignSpace, StoredSpace};
use coordinator::presentation::report::SUMMARY_DOCUMENT;
use coordinator::results::store::{CampaignFile, FILE_NAME, StoreError};
use coordinator::results::summary::StudySummary;
use coordinator::study::{Observed, Settings, SimulatedPoint, StoredOutcome};
use std::path::Path;

/// Name of the document with the reason why a study ended without a result.
pub const END_DOCUMENT: &str = "end";

/// A campaign file with its scene and settings.
pub struct StoredStudy {
    /// The campaign file.
    pub campaign: CampaignFile,
    /// The scene with its text.
    pub source: SceneSource,
    /// Settings of the study.
    pub settings: Settings,
}

impl StoredStudy {
    /// Opens the folder of a study for reading, which may be running.
    ///
    /// # Errors
    /// [`CommandError::Store`] or [`CommandError::Foreign`].
    pub fn look(dir: &Path) -> Result<Self, CommandError> {
        Self::read(CampaignFile::look(dir)?)
    }

    /// Reads scene and settings of an open campaign file.
    ///
    /// # Errors
    /// [`CommandError::Foreign`].
    pub fn read(campaign: CampaignFile) -> Result<Self, CommandError> {
        let source = scene_of(&campaign)?;
        let settings = Settings::from_stored(&campaign.meta().settings)
            .map_err(|error| foreign(&campaign, ForeignPart::Settings(error)))?;
        Ok(Self { campaign, source, settings })
    }

    /// The scene at its nominal point.
    pub fn scene(&self) -> &Scene {
        self.source.nominal()
    }

    /// The first property in which two studies differ so that their evaluations cannot be compared.
    pub fn difference(&self, other: &Self) -> Option<&'static str> {
        let (a, b) = (self.scene(), other.scene());
        let accuracy = |study: &Self| study.settings.accuracy.setting.accuracy;
        if a.variables != b.variables {
            Some("random variables")
        } else if a.limit_states != b.limit_states || a.outputs != b.outputs {
            Some("limit states")
        } else if a.life.checkpoints() != b.life.checkpoints() {
            Some("checkpoints of life")
        } else if accuracy(self) != accuracy(other) {
            Some("accuracies")
        } else {
            None
        }
    }

    /// The evaluations that gave a result, in the order of their numbers.
    ///
    /// # Errors
    /// [`CommandError::Store`].
    pub fn simulated(&self) -> Result<Vec<SimulatedPoint>, CommandError> {
        let mut all = Vec::new();
        self.campaign.for_each(|stored| -> Result<(), StoreError> {
            if let Ok(evaluation) = stored.outcome {
                all.push(SimulatedPoint {
                    sample: stored.sample,
                    observed: Observed::from_evaluation(evaluation),
                });
            }
            Ok(())
        })?;
        Ok(all)
    }

    /// All evaluations, failed ones included, in the order of their numbers.
    ///
    /// # Errors
    /// [`CommandError::Store`].
    pub fn outcomes(&self) -> Result<Vec<StoredOutcome>, CommandError> {
        let mut all = Vec::new();
        self.campaign.for_each(|stored| -> Result<(), StoreError> {
            let outcome = stored.outcome.map(Observed::from_evaluation);
            all.push(StoredOutcome { sample: stored.sample, outcome });
            Ok(())
        })?;
        Ok(all)
    }
}

/// The error of a command on the results of a study that has none, with the reason if it is known.
pub fn not_finished(campaign: &CampaignFile) -> CommandError {
    let dir = campaign.dir().to_path_buf();
    // A file that cannot be read any further has no known reason.
    match campaign.document(END_DOCUMENT) {
        Ok(Some(reason)) => CommandError::EndedWithoutResult { dir, reason },
        _ => CommandError::NotFinished { dir },
    }
}

/// The summary of a finished study.
///
/// # Errors
/// [`CommandError::Store`], [`CommandError::NotFinished`] or [`CommandError::EndedWithoutResult`].
pub fn summary_of(campaign: &CampaignFile) -> Result<StudySummary, CommandError> {
    campaign.document(SUMMARY_DOCUMENT)?.ok_or_else(|| not_finished(campaign))
}

/// The scene stored in a campaign file.
///
/// # Errors
/// [`CommandError::Foreign`].
pub fn scene_of(campaign: &CampaignFile) -> Result<SceneSource, CommandError> {
    SceneSource::parse(&campaign.meta().scene_source, &origin(campaign))
        .map_err(|faults| foreign(campaign, ForeignPart::Scene(faults)))
}

fn foreign(campaign: &CampaignFile, part: ForeignPart) -> CommandError {
    let program = campaign.meta().version.clone();
    ForeignStudy { file: origin(campaign), program, part }.into()
}

fn origin(campaign: &CampaignFile) -> String {
    campaign.dir().join(FILE_NAME).display().to_string()
}

/// Keys of the design variables of a study.
///
/// # Errors
/// [`CommandError::Store`].
pub fn design_keys(campaign: &CampaignFile) -> Result<Vec<String>, CommandError> {
    let stored = campaign.document::<StoredSpace>(DESIGNS_DOCUMENT)?;
    Ok(stored.map_or(vec![], |stored| stored.variables.into_iter().map(|variable| variable.key).collect()))
}

/// The design variables of a study, if it has any.
///
/// # Errors
/// [`CommandError::Store`], and the faults of a stored space.
pub fn stored_space(campaign: &CampaignFile) -> Result<Option<DesignSpace>, CommandError> {
    let stored = campaign.document::<StoredSpace>(DESIGNS_DOCUMENT)?;
    let origin = campaign.dir().display().to_string();
    Ok(stored.map(|stored| DesignSpace::from_stored(stored, &origin)).transpose()?)
}
