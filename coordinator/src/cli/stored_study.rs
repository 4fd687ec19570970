//! A study in its folder, finished or not, with its scene, settings and evaluations.

use super::error::CommandError;
use common::scene::{Scene, SceneSource};
use coordinator::results::store::{CampaignFile, FILE_NAME, StoreError};
use coordinator::study::{Observed, Settings, SimulatedPoint, StoredOutcome};
use std::path::Path;

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
    /// Opens the folder of a study.
    ///
    /// # Errors
    /// [`CommandError::Store`], [`CommandError::Scene`] or [`CommandError::ForeignSettings`].
    pub fn open(dir: &Path) -> Result<Self, CommandError> {
        Self::read(CampaignFile::open(dir)?)
    }

    /// Reads scene and settings of an open campaign file.
    ///
    /// # Errors
    /// [`CommandError::Scene`] or [`CommandError::ForeignSettings`].
    pub fn read(campaign: CampaignFile) -> Result<Self, CommandError> {
        let source = scene_of(&campaign)?;
        let settings = Settings::from_stored(&campaign.meta().settings).map_err(|error| {
            CommandError::ForeignSettings { file: origin(&campaign), reason: error.to_string() }
        })?;
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

/// The scene stored in a campaign file.
///
/// # Errors
/// [`CommandError::Scene`].
pub fn scene_of(campaign: &CampaignFile) -> Result<SceneSource, CommandError> {
    Ok(SceneSource::parse(&campaign.meta().scene_source, &origin(campaign))?)
}

fn origin(campaign: &CampaignFile) -> String {
    campaign.dir().join(FILE_NAME).display().to_string()
}
