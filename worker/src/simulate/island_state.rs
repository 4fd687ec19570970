//! One island of a running evaluation: its state, and what integrates, records and wears it.

use crate::integrate::{StepControl, Stepped, Stepper};
use crate::mechanism::{Island, Pose, WearingPair};
use crate::outputs::{Recorder, RecordingRequest};
use crate::wear::{FinerBore, StepTolerance, WearHistory, WearRate, WearStep, step_tolerance};
use common::accuracy::Accuracy;
use common::scene::Scene;
use std::f64::consts::TAU;

/// Lower bound of the time step, as a fraction of the cycle [1]: a guard against steps that never become small enough, far below the steps of slow
/// mechanisms where a slider lifts off its guide (less than 1e-9 at 6 r/min and `reference`).
const SMALLEST_STEP: f64 = 1e-12;
/// Lower bound of the time step times the highest angular frequency of a contact vibration, where that is shorter [1]. Slow
/// mechanisms with light bodies need about 0.06 while the journals settle.
const SMALLEST_PHASE: f64 = 1e-6;

/// Time of the state in a cycle from which the warm-up of the next one starts with this accuracy, at the same phase [s].
pub(crate) fn kept_time(scene: &Scene, accuracy: &Accuracy) -> f64 {
    let warm_up = accuracy.warm_up;
    let kept = if warm_up < 1.0 { 1.0 - warm_up } else { (-warm_up).rem_euclid(1.0) };
    kept * scene.life.period
}

/// An island with its state, its stepper and recorder, and the wear of its joints.
#[derive(Clone)]
pub struct IslandState {
    /// Bodies, joints and loads, with the bores as worn so far.
    pub island: Island,
    /// Integrates the island.
    pub stepper: Stepper,
    /// Records the measured cycle.
    pub recorder: Recorder,
    /// Positions `(n,)` [m, rad].
    pub q: Vec<f64>,
    /// Velocities `(n,)` [m/s, rad/s].
    pub v: Vec<f64>,
    /// Time of the state [s].
    pub time: f64,
    /// Whole turns of the bodies per cycle `(n / 3,)` [1].
    pub turns: Vec<f64>,
    /// State from which the next warm-up starts.
    pub warm_up_start: StateSnapshot,
    /// State at the start of the cycle measured last.
    pub cycle_start: StateSnapshot,
    /// Wear rate of each pair of surfaces, as [`Island::pairs`] has them `(pairs,)`.
    pub rates: Vec<WearRate>,
    /// Wear step of each pair `(pairs,)`.
    pub steps: Vec<WearStep>,
    /// Each pair with more control points, for the error of the wear `(pairs,)`.
    pub finer: Vec<FinerBore<WearRate>>,
    /// Each pair with twice as many again, if the motion is compared on them (`partial_life.rs`), else empty `(pairs,)`.
    pub finest: Vec<FinerBore<WearRate>>,
    /// Wear depth of each pair at the control points of its first surface, then of the second if that wears `(pairs, depths)` [m].
    pub depth: Vec<Vec<f64>>,
}

/// A state to return to: time, coordinates, velocities, and the damping fixed at each joint's last impact.
#[derive(Clone)]
pub struct StateSnapshot {
    time: f64,
    q: Vec<f64>,
    v: Vec<f64>,
    /// Damping of the joints `(joints,)` [s/m].
    damping: Vec<f64>,
    /// Damping of the guides with clearance `(guides, 4)` [s/m].
    pad_damping: Vec<[f64; 4]>,
}

impl StateSnapshot {
    /// Time [s], positions and velocities `(n,)`.
    pub(crate) fn state(&self) -> (f64, &[f64], &[f64]) {
        (self.time, &self.q, &self.v)
    }

    /// A snapshot of the state `q`, `v` `(n,)` at `time` [s] and of the island's joints as they are.
    pub(crate) fn new(island: &Island, time: f64, q: &[f64], v: &[f64]) -> Self {
        StateSnapshot {
            time,
            q: q.to_vec(),
            v: v.to_vec(),
            damping: island.joints.iter().map(|joint| joint.contact.surface().damping).collect(),
            pad_damping: island.guides.iter().map(|guide| guide.flat.damping).collect(),
        }
    }
}

/// Stepper of an island for a cycle at another accuracy, and the contact histories of that cycle.
pub type CycleTools = (Stepper, Vec<WearHistory>);

impl IslandState {
    /// Starts the island where the ideal mechanism has its bodies in `pose`, with their whole `turns` per cycle `(bodies,)` [1]; its recorder
    /// records what is `requested`.
    pub(crate) fn new(
        island: Island,
        (pose, turns): (&Pose, &[f64]),
        scene: &Scene,
        requested: &RecordingRequest,
        accuracy: &Accuracy,
    ) -> Self {
        let pick = |from: &[Option<[f64; 3]>]| -> Vec<f64> {
            island.bodies.iter().flat_map(|&b| from[b].unwrap_or_default()).collect()
        };
        let (q, v) = (pick(&pose.q), pick(&pose.v));
        let tolerance = step_tolerance(&scene.wear, accuracy.wear_tolerance);
        IslandState {
            stepper: stepper(&island, scene.life.period, accuracy),
            recorder: Recorder::new(&island, scene, requested, accuracy.wear_samples),
            warm_up_start: StateSnapshot::new(&island, pose.time, &q, &v),
            cycle_start: StateSnapshot::new(&island, pose.time, &q, &v),
            time: pose.time,
            turns: island.bodies.iter().map(|&body| turns[body]).collect(),
            q,
            v,
            rates: island.pairs().map(WearingPair::wear_rate).collect(),
            steps: island.pairs().map(|pair| WearStep::new(pair.depths(), tolerance)).collect(),
            finer: island.pairs().map(|pair| pair.finer_copy(tolerance)).collect(),
            finest: vec![],
            depth: island.pairs().map(|pair| vec![0.0; pair.depths()]).collect(),
            island,
        }
    }

    /// Returns to the state of `snapshot`, which is one of this island.
    pub(crate) fn restore(&mut self, snapshot: StateSnapshot) {
        let StateSnapshot { time, q, v, damping, pad_damping } = snapshot;
        for (damping, joint) in damping.iter().zip(&mut self.island.joints) {
            joint.set_damping(*damping);
        }
        for (damping, guide) in pad_damping.iter().zip(&mut self.island.guides) {
            guide.flat.damping = *damping;
        }
        (self.time, self.q, self.v) = (time, q, v);
    }

    /// Returns to the start of the cycle measured last.
    pub(crate) fn restore_cycle_start(&mut self) {
        self.restore(self.cycle_start.clone());
    }

    /// The present state, to return to.
    pub(crate) fn snapshot(&self) -> StateSnapshot {
        StateSnapshot::new(&self.island, self.time, &self.q, &self.v)
    }

    /// Takes the present state for that at `time` [s] of another cycle of `period` [s]: each angle loses the turns in between, as
    /// those of the driven bodies do.
    pub(crate) fn begin(&mut self, time: f64, period: f64) {
        let cycles = ((self.time - time) / period).round();
        for (angle, turns) in self.q.iter_mut().skip(2).step_by(3).zip(&self.turns) {
            *angle -= TAU * cycles * turns;
        }
        self.time = time;
    }

    /// Wears copies of all pairs with four times the control points beside them, by wear steps like those of the pairs by this `rule`; none has
    /// worn yet.
    pub(crate) fn add_finest(&mut self, tolerance: StepTolerance) {
        let mut finer = self.island.clone();
        finer.pairs_mut().for_each(|pair| {
            pair.refine(1);
        });
        self.finest = finer.pairs().map(|pair| pair.finer_copy(tolerance)).collect();
    }

    /// Stepper and empty contact histories for another accuracy of the time steps; `period` is the length of a cycle [s].
    pub(crate) fn tools_for(&self, period: f64, accuracy: &Accuracy) -> CycleTools {
        let mut histories = self.recorder.histories.clone();
        histories.iter_mut().for_each(WearHistory::clear);
        (stepper(&self.island, period, accuracy), histories)
    }

    /// Exchanges stepper and contact histories with `tools`. The motion of the next cycle is recorded over that of the last one.
    pub(crate) fn exchange_tools(&mut self, tools: &mut CycleTools) {
        std::mem::swap(&mut self.stepper, &mut tools.0);
        std::mem::swap(&mut self.recorder.histories, &mut tools.1);
    }
}

fn stepper(island: &Island, period: f64, accuracy: &Accuracy) -> Stepper {
    let (q, v) = island.scales();
    let fastest = q.iter().zip(v).fold(0.0_f64, |a, (q, v)| a.max(v / q));
    let smallest = (SMALLEST_STEP * period).min(SMALLEST_PHASE / fastest);
    let largest = accuracy.largest_step * period;
    let control = StepControl::new(accuracy.step_tolerance, largest, smallest, accuracy.steps_bound);
    Stepper::new(island.linearised(), control)
}

#[cfg(test)]
mod tests {
    use crate::simulate::run::Run;
    use crate::simulate::side_by_side::run_alone;
    use common::accuracy::Accuracy;
    use common::scene::{ContactDamping, JointKind, RestitutionLaw, SceneSource};

    #[test]
    fn issue_a_cycle_begun_again_started_with_the_damping_of_another_instant() {
        // Whether a contact begins anew within the cycle measured is a matter of luck: this motion is chaotic.
        let begun_anew: usize =
            [0.92, 0.93, 0.945, 0.951, 0.96, 0.97].into_iter().map(cycles_begun_again).sum();
        assert!(begun_anew >= 2, "of six motions {begun_anew} had a contact that began anew");
    }

    /// Measures a cycle of a rattling pin with this coefficient of restitution, then twice more from its start. Returns one if a
    /// contact began within the cycle, else zero.
    fn cycles_begun_again(coefficient: f64) -> usize {
        let mut scene = SceneSource::builtin("slider-crank").expect("built in").nominal().clone();
        for joint in &mut scene.joints {
            if let JointKind::Clearance(clearance) = &mut joint.kind {
                clearance.contact_damping = ContactDamping::Restitution {
                    law: RestitutionLaw::Flores,
                    coefficient,
                    least_speed: 1e-4,
                };
            }
        }
        let accuracy = Accuracy::draft();
        run_alone(|queue| async {
            let mut run = Run::assemble(queue, &scene, &accuracy).expect("assembled");
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
            let begun_anew = damping(&run) != began;
            // The time steps of a cycle begun again start small, those of the first went on from the settling.
            let mut again = async || {
                run.restart_cycle(&accuracy);
                let resumed = damping(&run);
                run.measure().await.expect("measured");
                (resumed, state(&run), run.motion_outputs())
            };
            let (first, second) = (again().await, again().await);
            assert_eq!(first.0, began);
            assert_eq!(first, second);
            usize::from(begun_anew)
        })
    }
}
