//! What an evaluation shows of the cycle just measured, and its result.

use super::moving::Moving;
use super::run::Run;
use crate::mechanism::Prescribed;
use crate::outputs::{BodyTrack, ForceTrack, largest_difference};
use common::failure::SimulationFailure;
use common::outputs::{BodyTrace, Diagnostics, Evaluation, FirstCycle, JointSummary};
use common::scene::{OutputKind, SignedBody};
use std::borrow::Cow;

/// Points per cycle of the histories shown of the first cycle.
const SHOWN: usize = 1000;

/// A value per joint with clearance, by the joint's name, in the scene's order.
type PerJoint<T> = Vec<(String, T)>;

impl Run<'_> {
    /// Outputs that come from the motion of the cycle just measured; zero in the place of the others.
    pub fn motion_outputs(&self) -> Vec<f64> {
        let value = |kind: &OutputKind| match kind {
            OutputKind::LargestWear { .. } => 0.0,
            OutputKind::AngularVelocityDifference { a, b } => {
                largest_difference(&self.track(a), a.sign, &self.track(b), b.sign)
            }
            _ => 0.0,
        };
        self.scene.outputs.iter().map(|o| value(&o.kind)).collect()
    }

    /// Motion of a body over the cycle: as recorded, or as prescribed.
    fn track(&self, body: &SignedBody) -> Cow<'_, BodyTrack> {
        if let Some(recorded) = self.islands.iter().find_map(|m| m.track(body.body)) {
            return Cow::Borrowed(recorded);
        }
        let mut track = BodyTrack::default();
        if let Some(motion) = Prescribed::of(&self.scene.bodies[body.body]) {
            for k in 0..=SHOWN {
                let t = self.scene.life.period * k as f64 / SHOWN as f64;
                let [angle, omega, alpha, _] = motion.jet(t);
                track.push(t, angle, omega, alpha);
            }
        }
        Cow::Owned(track)
    }

    /// Angles, speeds and joint forces of the cycle just measured.
    pub fn first_cycle(&self) -> FirstCycle {
        let period = self.scene.life.period;
        let time: Vec<f64> = (0..=SHOWN).map(|k| period * k as f64 / SHOWN as f64).collect();
        let mut bodies: Vec<BodyTrace> = Vec::new();
        for output in &self.scene.outputs {
            if let OutputKind::AngularVelocityDifference { a, b } = &output.kind {
                for body in [a, b] {
                    if bodies.iter().any(|t| t.label == body.label) {
                        continue;
                    }
                    let (angle, speed) = self.track(body).resample(&time);
                    bodies.push(BodyTrace {
                        label: body.label.clone(),
                        angle: angle.into_iter().map(|x| x * body.sign).collect(),
                        speed: speed.into_iter().map(|x| x * body.sign).collect(),
                    });
                }
            }
        }
        let joint_force =
            self.joints(|m, k| m.recorder.forces.as_ref().map(|f| f[k].resample(&time)).unwrap_or_default());
        FirstCycle { time, bodies, motion: vec![], joint_force }
    }

    /// Peak force and share of free flight of the cycle just measured, per joint in the scene's order.
    pub fn force_summary(&self) -> (PerJoint<f64>, PerJoint<f64>) {
        let period = self.scene.life.period;
        let of = |value: &dyn Fn(&ForceTrack) -> f64| {
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

    pub fn finish(
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
            errors: histories
                .iter()
                .zip(&self.tier_difference)
                .map(|(h, share)| h.iter().map(|x| share * x.abs()).collect())
                .collect(),
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
                quasi_static: !self.guided.is_empty(),
                ..Diagnostics::default()
            },
        })
    }
}
