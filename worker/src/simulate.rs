//! One evaluation: the whole life of one sample.
//!
//! assemble -> settle -> measure the first cycle -> [ wear a block -> warm up -> measure a cycle ] ... -> outputs
//!
//! A measured cycle serves twice: its contact history drives the wear of the block that follows, and its motion
//! gives the outputs of the profile it ran on. The value of a checkpoint belongs to the profile worn to it.

use crate::integrate::{Advance, AdvanceError, AdvanceStats};
use crate::life::{at_checkpoints, boundaries};
use crate::mechanism::{Island, Pose, ideal_motion, islands};
use crate::outputs::{Recorder, largest_difference};
use crate::wear::{WearRate, WearStep, WearStepStats};
use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::outputs::{BodyTrace, Diagnostics, Evaluation, FirstCycle, JointSummary};
use common::scene::{OutputKind, Scene, SignedBody};

/// Points per cycle of the histories shown of the first cycle.
const SHOWN: usize = 1000;
/// Smallest time step, as a fraction of the cycle: far below the duration of any contact.
const SMALLEST_STEP: f64 = 1e-9;

/// Simulates the whole life of a checked scene.
///
/// Returns every output at every checkpoint; the settled first cycle too if `with_first_cycle`.
///
/// # Errors
/// [`SimulationFailure`]: what the physics or the numerics refused, with time, cycle and joint.
pub fn simulate(
    scene: &Scene,
    accuracy: &Accuracy,
    with_first_cycle: bool,
) -> Result<Evaluation, SimulationFailure> {
    let mut run = Run::assemble(scene, accuracy)?;
    run.settle()?;
    run.show_forces(true);
    run.measure()?;
    let first_cycle = with_first_cycle.then(|| run.first_cycle());
    let (peaks, free_flight) = run.force_summary();
    run.show_forces(false);

    let every = scene.life.checkpoint_every;
    let mut lives = vec![0];
    let mut measured = vec![run.motion_outputs()];
    let mut wear = vec![vec![]; scene.outputs.len()];
    for block in boundaries(scene.life.cycles, accuracy.cycle_jump, every).windows(2) {
        let checkpoints: Vec<u32> = (block[0] / every + 1..=block[1] / every).map(|k| k * every).collect();
        run.wear(block[0], block[1], &checkpoints, &mut wear)?;
        run.warm_up()?;
        run.measure()?;
        lives.push(block[1]);
        measured.push(run.motion_outputs());
    }

    let cycles = scene.life.checkpoints();
    let histories = scene
        .outputs
        .iter()
        .enumerate()
        .map(|(k, output)| match output.kind {
            OutputKind::LargestWear { .. } => std::mem::take(&mut wear[k]),
            OutputKind::AngularVelocityDifference { .. } => {
                let values: Vec<f64> = measured.iter().map(|m| m[k]).collect();
                at_checkpoints(&lives, &values, &cycles)
            }
        })
        .collect();
    run.finish(cycles, histories, peaks, free_flight, first_cycle)
}

/// A value per joint with clearance, by the joint's name, in the scene's order.
type PerJoint<T> = Vec<(String, T)>;

/// An island with its state and tools.
struct Moving {
    island: Island,
    advance: Advance,
    recorder: Recorder,
    q: Vec<f64>,
    v: Vec<f64>,
    /// State from which the next warm-up starts.
    saved: (Vec<f64>, Vec<f64>),
    rates: Vec<WearRate>,
    steps: Vec<WearStep>,
    depth: Vec<Vec<f64>>,
}

struct Run<'a> {
    scene: &'a Scene,
    accuracy: &'a Accuracy,
    islands: Vec<Moving>,
    /// Cycles done.
    cycle: u32,
    stats: AdvanceStats,
    wear_stats: WearStepStats,
    newton: u64,
    simulated: u64,
}

impl<'a> Run<'a> {
    /// Islands, contact laws, round bores; bodies where the ideal mechanism has them.
    fn assemble(scene: &'a Scene, accuracy: &'a Accuracy) -> Result<Self, SimulationFailure> {
        let mut newton = 0;
        let pose = ideal_motion(scene, &mut newton)?;
        let tracked: Vec<usize> = scene
            .outputs
            .iter()
            .filter_map(|o| match &o.kind {
                OutputKind::AngularVelocityDifference { a, b } => Some([a.body, b.body]),
                OutputKind::LargestWear { .. } => None,
            })
            .flatten()
            .collect();
        let islands = islands(scene)?
            .into_iter()
            .map(|island| Moving::new(island, &pose, &tracked, scene.life.period, accuracy))
            .collect();
        Ok(Run {
            scene,
            accuracy,
            islands,
            cycle: 0,
            stats: AdvanceStats::default(),
            wear_stats: WearStepStats::default(),
            newton,
            simulated: 0,
        })
    }

    /// One whole cycle from the ideal mechanism's state: the journals find their bores.
    fn settle(&mut self) -> Result<(), SimulationFailure> {
        let period = self.scene.life.period;
        self.span(-period, 0.0, false)?;
        self.simulated += 1;
        Ok(())
    }

    /// From the state kept of the cycle before, on the profile as it is now, to the start of a cycle.
    fn warm_up(&mut self) -> Result<(), SimulationFailure> {
        for m in &mut self.islands {
            m.q.copy_from_slice(&m.saved.0);
            m.v.copy_from_slice(&m.saved.1);
            m.advance.after_jump();
        }
        let period = self.scene.life.period;
        self.span(-self.accuracy.warm_up * period, 0.0, false)
    }

    /// One recorded cycle; keeps the state from which the next warm-up starts.
    fn measure(&mut self) -> Result<(), SimulationFailure> {
        let period = self.scene.life.period;
        let kept = (1.0 - self.accuracy.warm_up).max(0.0) * period;
        for m in &mut self.islands {
            m.recorder.clear();
        }
        if kept > 0.0 {
            self.span(0.0, kept, true)?;
        }
        for m in &mut self.islands {
            m.saved.0.copy_from_slice(&m.q);
            m.saved.1.copy_from_slice(&m.v);
        }
        self.span(kept, period, true)?;
        for m in &mut self.islands {
            m.recorder.finish();
            if kept == 0.0 {
                m.saved.0.copy_from_slice(&m.q);
                m.saved.1.copy_from_slice(&m.v);
            }
        }
        self.simulated += 1;
        Ok(())
    }

    fn span(&mut self, from: f64, to: f64, record: bool) -> Result<(), SimulationFailure> {
        for m in &mut self.islands {
            let Moving { island, advance, recorder, q, v, .. } = m;
            let done = if record {
                advance.run(island, from..to, q, v, recorder, &mut self.stats)
            } else {
                advance.run(island, from..to, q, v, &mut (), &mut self.stats)
            };
            done.map_err(|error| failure(error, self.cycle, island, self.accuracy.steps_bound))?;
        }
        Ok(())
    }

    fn show_forces(&mut self, show: bool) {
        for m in &mut self.islands {
            m.recorder.forces = show.then(|| vec![Default::default(); m.island.joints.len()]);
        }
    }

    /// Wears every bore from one life to another under the contact of the cycle just measured; `wear` takes the
    /// wear outputs at the checkpoints between.
    fn wear(
        &mut self,
        from: u32,
        to: u32,
        checkpoints: &[u32],
        wear: &mut [Vec<f64>],
    ) -> Result<(), SimulationFailure> {
        let marks: Vec<f64> = checkpoints.iter().map(|&c| f64::from(c - from)).collect();
        // Largest depth of each joint at each checkpoint, by the scene's numbering of the joints.
        let mut largest = vec![vec![0.0_f64; self.scene.joints.len()]; marks.len()];
        for m in &mut self.islands {
            for (k, joint) in m.island.joints.iter_mut().enumerate() {
                if joint.wear_coefficient == 0.0 {
                    continue;
                }
                m.rates[k].freeze(&m.recorder.histories[k]);
                let note = |at: usize, depth: &[f64]| {
                    largest[at][joint.scene_joint] = depth.iter().fold(0.0, |a: f64, &b| a.max(b));
                };
                m.steps[k]
                    .advance(
                        &mut m.rates[k],
                        &mut m.depth[k],
                        f64::from(to - from),
                        &marks,
                        note,
                        &mut self.wear_stats,
                    )
                    .map_err(|failed| SimulationFailure::WearStep {
                        cycle: from,
                        joint: joint.name.clone(),
                        error: failed.0,
                    })?;
                joint.set_depth(&m.depth[k]);
            }
        }
        for (output, history) in self.scene.outputs.iter().zip(wear) {
            if let OutputKind::LargestWear { joints } = &output.kind {
                history.extend(largest.iter().map(|at| joints.iter().fold(0.0_f64, |a, &j| a.max(at[j]))));
            }
        }
        self.cycle = to;
        Ok(())
    }

    /// Outputs that come from the motion of the cycle just measured; zero in the place of the others.
    fn motion_outputs(&self) -> Vec<f64> {
        let value = |kind: &OutputKind| match kind {
            OutputKind::LargestWear { .. } => 0.0,
            OutputKind::AngularVelocityDifference { a, b } => match (self.track(a), self.track(b)) {
                (Some(x), Some(y)) => largest_difference(x, a.sign, y, b.sign),
                _ => 0.0,
            },
        };
        self.scene.outputs.iter().map(|o| value(&o.kind)).collect()
    }

    fn track(&self, body: &SignedBody) -> Option<&crate::outputs::BodyTrack> {
        self.islands.iter().find_map(|m| m.track(body.body))
    }

    fn first_cycle(&self) -> FirstCycle {
        let period = self.scene.life.period;
        let time: Vec<f64> = (0..=SHOWN).map(|k| period * k as f64 / SHOWN as f64).collect();
        let mut bodies: Vec<BodyTrace> = Vec::new();
        for output in &self.scene.outputs {
            if let OutputKind::AngularVelocityDifference { a, b } = &output.kind {
                for body in [a, b] {
                    if bodies.iter().any(|t| t.label == body.label) {
                        continue;
                    }
                    if let Some(track) = self.track(body) {
                        let (angle, speed) = track.resample(&time);
                        bodies.push(BodyTrace {
                            label: body.label.clone(),
                            angle: angle.into_iter().map(|x| x * body.sign).collect(),
                            speed: speed.into_iter().map(|x| x * body.sign).collect(),
                        });
                    }
                }
            }
        }
        let joint_force =
            self.joints(|m, k| m.recorder.forces.as_ref().map(|f| f[k].resample(&time)).unwrap_or_default());
        FirstCycle { time, bodies, joint_force }
    }

    /// Peak force and share of free flight of the cycle just measured, per joint in the scene's order.
    fn force_summary(&self) -> (PerJoint<f64>, PerJoint<f64>) {
        let period = self.scene.life.period;
        let of = |value: &dyn Fn(&crate::outputs::ForceTrack) -> f64| {
            self.joints(|m, k| m.recorder.forces.as_ref().map_or(0.0, |f| value(&f[k])))
        };
        (of(&|f| f.peak()), of(&|f| f.free / period))
    }

    /// A value per joint with clearance, in the scene's order.
    fn joints<T>(&self, value: impl Fn(&Moving, usize) -> T) -> PerJoint<T> {
        let mut all: Vec<(usize, String, T)> = Vec::new();
        for m in &self.islands {
            for (k, joint) in m.island.joints.iter().enumerate() {
                all.push((joint.scene_joint, joint.name.clone(), value(m, k)));
            }
        }
        all.sort_by_key(|(index, ..)| *index);
        all.into_iter().map(|(_, name, value)| (name, value)).collect()
    }

    fn finish(
        self,
        cycles: Vec<u32>,
        histories: Vec<Vec<f64>>,
        peaks: PerJoint<f64>,
        free_flight: PerJoint<f64>,
        first_cycle: Option<FirstCycle>,
    ) -> Result<Evaluation, SimulationFailure> {
        for (output, history) in self.scene.outputs.iter().zip(&histories) {
            if let Some(k) = history.iter().position(|x| !x.is_finite()) {
                return Err(SimulationFailure::NotFinite {
                    cycle: cycles[k],
                    time: 0.0,
                    quantity: output.name.clone(),
                });
            }
        }
        let depth = self.joints(|m, k| m.depth[k].clone());
        let joints = depth
            .into_iter()
            .zip(peaks)
            .map(|((name, wear_depth), (_, peak_force))| JointSummary { name, peak_force, wear_depth })
            .collect();
        Ok(Evaluation {
            cycles,
            histories,
            joints,
            first_cycle,
            diagnostics: Diagnostics {
                steps: self.stats.steps,
                rejected_steps: self.stats.rejected,
                newton_iterations: self.newton,
                force_evaluations: self.stats.forces,
                simulated_cycles: self.simulated,
                wear_stages: self.wear_stats.stages,
                rejected_wear_steps: self.wear_stats.rejected,
                free_flight_fraction: free_flight,
            },
        })
    }
}

impl Moving {
    fn new(island: Island, pose: &Pose, tracked: &[usize], period: f64, accuracy: &Accuracy) -> Self {
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

    fn track(&self, body: usize) -> Option<&crate::outputs::BodyTrack> {
        self.recorder.track_of(&self.island, body)
    }
}

fn failure(error: AdvanceError, cycle: u32, island: &Island, bound: u64) -> SimulationFailure {
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
