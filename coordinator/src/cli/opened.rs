//! A study that was begun, finished or not, and what it has simulated.

use super::error::CommandError;
use super::options::StudyOptions;
use common::scene::{Scene, SceneSource};
use coordinator::results::store::{CampaignFile, FILE_NAME, StoreError};
use coordinator::study::{Observed, Simulated};
use std::path::Path;

/// A campaign and what it is of.
pub struct Opened {
    campaign: CampaignFile,
    /// Scene.
    pub scene: Scene,
    /// How it is studied.
    pub options: StudyOptions,
}

impl Opened {
    /// Opens the folder of a study.
    pub fn new(dir: &Path) -> Result<Self, CommandError> {
        let campaign = CampaignFile::open(dir)?;
        let origin = dir.join(FILE_NAME).display().to_string();
        let scene = SceneSource::parse(&campaign.meta().scene_source, &origin)?.nominal().clone();
        let options = serde_json::from_value(campaign.meta().settings.clone())
            .map_err(|error| CommandError::ForeignSettings { file: origin, reason: error.to_string() })?;
        Ok(Self { campaign, scene, options })
    }

    /// What keeps the simulations of one from being compared with those of the other.
    pub fn difference(&self, other: &Self) -> Option<&'static str> {
        let (a, b) = (&self.scene, &other.scene);
        let accuracy = |opened: &Self| opened.options.accuracy.setting.accuracy;
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

    /// What was simulated and gave a result, in the order of the evaluations.
    pub fn simulated(&self) -> Result<Vec<Simulated>, CommandError> {
        let mut all = Vec::new();
        self.campaign.for_each(|stored| -> Result<(), StoreError> {
            if let Ok(evaluation) = stored.outcome {
                all.push(Simulated { sample: stored.sample, observed: Observed::of(evaluation) });
            }
            Ok(())
        })?;
        Ok(all)
    }
}
