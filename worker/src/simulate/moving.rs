//! One island under way: its state and the tools that carry it.

use crate::integrate::{Advance, AdvanceError, Stepped};
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
    /// From where the next warm-up starts.
    pub saved: Kept,
    /// Where the cycle last measured began.
    pub begun: Kept,
    pub rates: Vec<WearRate>,
    pub steps: Vec<WearStep>,
    pub depth: Vec<Vec<f64>>,
}

/// An instant to come back to: the state, and the damping that each joint's contact began with.
#[derive(Clone)]
pub struct Kept {
    q: Vec<f64>,
    v: Vec<f64>,
    /// `(joints,)` [s/m].
    damping: Vec<f64>,
}

impl Kept {
    /// The island's joints as they are, at this state.
    pub fn new(island: &Island, q: &[f64], v: &[f64]) -> Self {
        let mut kept = Kept { q: q.to_vec(), v: v.to_vec(), damping: vec![0.0; island.joints.len()] };
        kept.keep(island, q, v);
        kept
    }

    /// The same, of another instant.
    pub fn keep(&mut self, island: &Island, q: &[f64], v: &[f64]) {
        self.q.copy_from_slice(q);
        self.v.copy_from_slice(v);
        for (damping, joint) in self.damping.iter_mut().zip(&island.joints) {
            *damping = joint.contact.surface().damping;
        }
    }

    /// Brings the state and the joints back.
    pub fn restore(&self, island: &mut Island, q: &mut [f64], v: &mut [f64]) {
        q.copy_from_slice(&self.q);
        v.copy_from_slice(&self.v);
        for (damping, joint) in self.damping.iter().zip(&mut island.joints) {
            joint.contact.restore_damping(*damping);
        }
    }
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
            saved: Kept::new(&island, &q, &v),
            begun: Kept::new(&island, &q, &v),
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

#[cfg(test)]
mod tests {
    use crate::simulate::run::Run;
    use crate::simulate::together::alone;
    use common::accuracy::Accuracy;
    use common::scene::{ContactDamping, JointKind, RestitutionLaw, SceneSource};

    #[test]
    fn issue_a_cycle_begun_again_started_with_the_damping_of_another_instant() {
        let mut scene = SceneSource::builtin("slider-crank").expect("built in").nominal().clone();
        for joint in &mut scene.joints {
            if let JointKind::Clearance(clearance) = &mut joint.kind {
                clearance.contact_damping = ContactDamping::Restitution {
                    law: RestitutionLaw::Flores,
                    coefficient: 0.95,
                    least_speed: 1e-4,
                };
            }
        }
        let accuracy = Accuracy::draft();
        alone(|desk| async {
            let mut run = Run::assemble(desk, &scene, &accuracy).expect("assembled");
            let damping = |run: &Run| -> Vec<f64> {
                let joints = run.islands.iter().flat_map(|m| &m.island.joints);
                joints.map(|j| j.contact.surface().damping).collect()
            };
            let state = |run: &Run| -> Vec<f64> {
                run.islands.iter().flat_map(|m| m.q.iter().chain(&m.v)).copied().collect()
            };
            run.settle().await.expect("settled");
            let began = damping(&run);
            run.measure().await.expect("measured");
            assert_ne!(damping(&run), began, "no contact began anew within the cycle");
            // The time steps of a cycle begun again start small, those of the first went on from the settling.
            let mut again = async || {
                run.begin_again(&accuracy);
                let resumed = damping(&run);
                run.measure().await.expect("measured");
                (resumed, state(&run), run.motion_outputs())
            };
            let (first, second) = (again().await, again().await);
            assert_eq!(first.0, began);
            assert_eq!(first, second);
        });
    }
}
