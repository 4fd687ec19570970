//! The campaign of a study as its workers receive it.

use super::error::CommandError;
use common::accuracy::NamedAccuracy;
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
    let simulator = scene.simulator.as_ref().map(|simulator| CampaignSimulator {
        id: SimulatorId::new(simulator, scene),
        timeout: simulator.timeout,
        licences: None,
    });
    let stored = serde_json::to_string(settings)?;
    let campaign = of_mechanism(source, settings.accuracy.setting.clone(), &stored);
    Ok(CampaignSpec { simulator, resumed, ..campaign })
}

/// A campaign of evaluations of a mechanism; its id is a digest of the scene and of the plan.
pub fn of_mechanism(source: &SceneSource, accuracy: NamedAccuracy, plan: &str) -> CampaignSpec {
    let digest = common::scene::source::digest(&format!("{plan}\n{}", source.text()));
    CampaignSpec {
        // The low half of a 128-bit hash is a 64-bit hash.
        id: digest as u64,
        scene: source.text().to_owned(),
        accuracy: accuracy.accuracy,
        accuracy_name: accuracy.name,
        build: Some(worker::BUILD),
        shape: Some(EvaluationShape::of(source.nominal())),
        simulator: None,
        cross_check: None,
        resumed: false,
    }
}
