//! One island under way: its state and the tools that carry it.

use crate::integrate::{Advance, AdvanceError, Dynamics};
use crate::mechanism::{Island, Pose};
use crate::outputs::{Recorder, Wanted};
use crate::wear::{WearRate, WearStep};
use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::scene::Scene;

/// Smallest time step, as a fraction of the cycle.
pub const SMALLEST_STEP: f64 = 1e-9;
/// Smallest time step over the time in which the fastest contact vibration turns by one radian, where that is less:
/// a slow mechanism with light bodies needs some 0.06 of it where its journals find their bores.
const SMALLEST_PHASE: f64 = 1e-3;

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
    /// State at which the cycle last measured began.
    pub begun: (Vec<f64>, Vec<f64>),
    pub rates: Vec<WearRate>,
    pub steps: Vec<WearStep>,
    pub depth: Vec<Vec<f64>>,
}

/// What carries an island through a cycle and records it.
pub struct Tools {
    advance: Advance,
    recorder: Recorder,
}

impl Moving {
    /// Starts the island from the ideal mechanism's pose; what is `wanted` is recorded.
    pub fn new(island: Island, pose: &Pose, scene: &Scene, wanted: &Wanted, accuracy: &Accuracy) -> Self {
        let pick = |from: &[Option<[f64; 3]>]| -> Vec<f64> {
            island.bodies.iter().flat_map(|&b| from[b].unwrap_or_default()).collect()
        };
        let (q, v) = (pick(&pose.q), pick(&pose.v));
        Moving {
            advance: advance(&island, scene.life.period, accuracy),
            recorder: Recorder::new(&island, scene, wanted, accuracy.wear_samples),
            saved: (q.clone(), v.clone()),
            begun: (q.clone(), v.clone()),
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

    /// Tools for another accuracy of the time steps, with nothing recorded yet.
    pub fn tools(&self, period: f64, accuracy: &Accuracy) -> Tools {
        let mut recorder = self.recorder.clone();
        recorder.clear();
        Tools { advance: advance(&self.island, period, accuracy), recorder }
    }

    /// Changes tools.
    pub fn exchange(&mut self, tools: &mut Tools) {
        std::mem::swap(&mut self.advance, &mut tools.advance);
        std::mem::swap(&mut self.recorder, &mut tools.recorder);
    }
}

fn advance(island: &Island, period: f64, accuracy: &Accuracy) -> Advance {
    let (q, v) = island.scales();
    let fastest = q.iter().zip(v).fold(0.0_f64, |a, (q, v)| a.max(v / q));
    Advance::new(
        island.linearised(),
        accuracy.step_tolerance,
        accuracy.largest_step * period,
        (SMALLEST_STEP * period).min(SMALLEST_PHASE / fastest),
        accuracy.steps_bound,
    )
}

/// Names the joint and the life of what stopped an island.
pub fn failure(error: AdvanceError, cycle: u32, island: &Island) -> SimulationFailure {
    let name = |joint: usize| island.joints[joint].name.clone();
    match error {
        AdvanceError::StepTooSmall { time, step, error, joint } => {
            SimulationFailure::StepTooSmall { cycle, time, joint: joint.map(name), step, error }
        }
        AdvanceError::TooManySteps { time, bound, joint } => {
            SimulationFailure::TooManySteps { cycle, time, joint: joint.map(name), bound }
        }
        AdvanceError::OutOfRange { time, joint, penetration } => {
            SimulationFailure::OutOfRange { cycle, time, joint: name(joint), penetration }
        }
        AdvanceError::Singular { time } => SimulationFailure::Singular { cycle, time },
        AdvanceError::NotFinite { time } => {
            SimulationFailure::NotFinite { cycle, time, quantity: "the force".into() }
        }
    }
}
