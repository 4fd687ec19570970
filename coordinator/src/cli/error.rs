//! Why a command ended early, in one message, with its exit code.

use common::failure::SimulationFailure;
use common::scene::{Faults, Motion, Scene};
use std::path::PathBuf;
use thiserror::Error;

/// What ended a command.
#[derive(Debug, Error)]
pub enum CommandError {
    /// The scene or a setting is faulty.
    #[error(transparent)]
    Scene(#[from] Faults),
    /// The ideal linkage cannot turn through its cycle.
    #[error(
        "{origin}: the linkage locks: joint {joint} cannot be closed at {angle}, a gap of {gap} mm remains; \
         check lengths and start positions"
    )]
    LockedLinkage {
        /// File or name of the scene.
        origin: String,
        /// Joint with the largest gap.
        joint: String,
        /// Where the drive stands, in words.
        angle: String,
        /// Remaining gap [mm].
        gap: f64,
    },
    /// The scene is valid but asks for something this version does not model.
    #[error("{origin}: not modelled yet: {what}")]
    NotModelled {
        /// File or name of the scene.
        origin: String,
        /// What.
        what: String,
    },
    /// The simulation has no result.
    #[error("{origin}: the simulation failed: {failure}")]
    Simulation {
        /// File or name of the scene.
        origin: String,
        /// Why.
        failure: SimulationFailure,
    },
    /// Options of a study before a command.
    #[error("options of a study go after `run`: coordinator run --workers ...")]
    MisplacedOptions,
    /// A result that JSON cannot hold.
    #[error("the result cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// A file cannot be written.
    #[error("{}: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// Standard output is closed.
    #[error("standard output: {0}")]
    Output(#[source] std::io::Error),
}

impl CommandError {
    /// Exit code of the process.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Scene(_)
            | Self::LockedLinkage { .. }
            | Self::NotModelled { .. }
            | Self::MisplacedOptions => 2,
            Self::Simulation { .. } | Self::Json(_) | Self::Write { .. } => 1,
            // Whoever closed the pipe has read all it wanted.
            Self::Output(error) if error.kind() == std::io::ErrorKind::BrokenPipe => 0,
            Self::Output(_) => 1,
        }
    }

    /// A failure of the physics, told apart from an input that cannot work.
    pub fn of_simulation(origin: &str, scene: &Scene, failure: SimulationFailure) -> Self {
        let origin = origin.to_owned();
        match failure {
            SimulationFailure::CannotAssemble { joint, time, gap } => {
                let (angle, gap) = (drive_at(scene, time), (gap * 1e6).round() / 1e3);
                Self::LockedLinkage { origin, joint, angle, gap }
            }
            SimulationFailure::NotModelled { what } => Self::NotModelled { origin, what },
            failure => Self::Simulation { origin, failure },
        }
    }
}

/// Where the driven bodies stand at a time, e.g. `crank angle 123.4 deg`.
fn drive_at(scene: &Scene, time: f64) -> String {
    let angles: Vec<String> = scene
        .bodies
        .iter()
        .filter_map(|body| match body.motion {
            Motion::Driven { start_angle, speed, .. } => {
                let turned = (start_angle + speed * time).to_degrees().rem_euclid(360.0);
                Some(format!("{} angle {turned:.1} deg", body.name))
            }
            _ => None,
        })
        .collect();
    if angles.is_empty() { format!("t = {time} s") } else { angles.join(", ") }
}
