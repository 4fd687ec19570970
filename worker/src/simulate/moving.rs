//! One island under way: its state and the tools that carry it.

use crate::integrate::{Advance, AdvanceError};
use crate::mechanism::{Island, Pose};
use crate::outputs::{BodyTrack, Recorder};
use crate::wear::{WearRate, WearStep};
use common::accuracy::Accuracy;
use common::failure::SimulationFailure;

/// Smallest time step, as a fraction of the cycle: far below the duration of any contact.
pub const SMALLEST_STEP: f64 = 1e-9;

/// An island with its state and tools.
#[derive(Clone)]
pub struct Moving {
    pub island: Island,
    pub advance: Advance,
    pub recorder: Recorder,
    pub q: Vec<f64>,
    pub v: Vec<f64>,
    /// State from which the next warm-up starts.
    pub saved: (Vec<f64>, Vec<f64>),
    pub rates: Vec<WearRate>,
    pub steps: Vec<WearStep>,
    pub depth: Vec<Vec<f64>>,
}

impl Moving {
    /// Starts the island from the ideal mechanism's pose; bodies of the scene in `tracked` are recorded.
    pub fn new(island: Island, pose: &Pose, tracked: &[usize], period: f64, accuracy: &Accuracy) -> Self {
        let pick = |from: &[Option<[f64; 3]>]| -> Vec<f64> {
            island.bodies.iter().flat_map(|&b| from[b].unwrap_or_default()).collect()
        };
        let (q, v) = (pick(&pose.q), pick(&pose.v));
        let slots = (0..island.bodies.len()).filter(|&s| tracked.contains(&island.bodies[s])).collect();
        let (n, joints) = (island.coordinates(), island.joints.len());
        Moving {
            advance: Advance::new(
                n,
                joints,
                accuracy.step_tolerance,
                accuracy.largest_step * period,
                SMALLEST_STEP * period,
                accuracy.steps_bound,
            ),
            recorder: Recorder::new(&island, slots, period, accuracy.wear_samples),
            saved: (q.clone(), v.clone()),
            q,
            v,
            rates: island
                .joints
                .iter()
                .map(|j| WearRate::new(j.wear_coefficient, j.width, &j.contact, &j.profile))
                .collect(),
            steps: island
                .joints
                .iter()
                .map(|j| WearStep::new(j.profile.points(), accuracy.wear_tolerance))
                .collect(),
            depth: island.joints.iter().map(|j| vec![0.0; j.profile.points()]).collect(),
            island,
        }
    }

    /// The recorded track of a body of the scene, if it is in this island.
    pub fn track(&self, body: usize) -> Option<&BodyTrack> {
        self.recorder.track_of(&self.island, body)
    }
}

/// Names the joint and the life of what stopped an island.
pub fn failure(error: AdvanceError, cycle: u32, island: &Island, bound: u64) -> SimulationFailure {
    match error {
        AdvanceError::StepTooSmall { time, step, error } => {
            SimulationFailure::StepTooSmall { cycle, time, step, error }
        }
        AdvanceError::TooManySteps { time } => SimulationFailure::TooManySteps { cycle, time, bound },
        AdvanceError::OutOfRange { time, joint, penetration } => SimulationFailure::OutOfRange {
            cycle,
            time,
            joint: island.joints[joint].name.clone(),
            penetration,
        },
        AdvanceError::NotFinite { time } => {
            SimulationFailure::NotFinite { cycle, time, quantity: "the force".into() }
        }
    }
}
