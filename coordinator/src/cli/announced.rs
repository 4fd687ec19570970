//! The campaign of a study as its workers receive it.

use super::error::CommandError;
use common::evaluation_shape::EvaluationShape;
use common::external::SimulatorId;
use common::scene::SceneSource;
use coordinator::farm::dispatch::{CampaignSimulator, CampaignSpec};
use coordinator::study::Settings;

/// The campaign as announced to workers. A study has the same id whenever it is resumed.
///
/// # Errors
/// [`CommandError::Json`].
pub fn announced(
    source: &SceneSource,
    settings: &Settings,
    resumed: bool,
) -> Result<CampaignSpec, CommandError> {
    let scene = source.nominal();
    let stored = serde_json::to_string(settings)?;
    let digest = common::scene::source::digest(&format!("{stored}\n{}", source.text()));
    let accuracy = settings.accuracy.setting.clone();
    Ok(CampaignSpec {
        // The low half of a 128-bit hash is a 64-bit hash.
        id: digest as u64,
        scene: source.text().to_owned(),
        accuracy: accuracy.accuracy,
        accuracy_name: accuracy.name,
        build: Some(worker::BUILD),
        shape: Some(EvaluationShape::of(scene)),
        simulator: scene.simulator.as_ref().map(|simulator| CampaignSimulator {
            id: SimulatorId::new(simulator, scene),
            timeout: simulator.timeout,
            licences: None,
        }),
        cross_check: None,
        resumed,
    })
}
