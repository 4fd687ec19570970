//! The stages of an evaluation: settle, measure a cycle, wear a block, warm up.

use super::desk::{Carried, Desk, Stretch};
use super::guided::Guided;
use super::moving::{Moving, failure};
use crate::integrate::AdvanceStats;
use crate::mechanism::{Frame, Pose, ideal_cycle, islands};
use crate::outputs::{PointTrack, Shown, Wanted};
use crate::wear::WearStepStats;
use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::outputs::{EnergyBalance, WornLife};
use common::scene::{Attachment, JointKind, OutputKind, Scene};

/// One evaluation under way.
#[derive(Clone)]
pub struct Run<'a> {
    /// Carries the islands.
    desk: Desk,
    pub scene: &'a Scene,
    pub accuracy: &'a Accuracy,
    pub islands: Vec<Moving>,
    /// Cycles done.
    cycle: u32,
    pub stats: AdvanceStats,
    pub wear_stats: WearStepStats,
    pub newton: u64,
    pub simulated: u64,
    /// Paths on the ideal mechanism of the points asked for.
    pub ideal_paths: Vec<(Attachment, PointTrack)>,
    /// Islands on their ideal motion, where the quasi-static tier drives the wear.
    pub guided: Vec<Guided>,
    /// Largest difference of the wear rates between the tiers, relative, for each output; zero unless compared.
    pub tier_difference: Vec<f64>,
    /// Whether people want to see the first and the last cycle.
    pub watched: bool,
    /// Energy of the last cycle, if they do.
    pub worn_energy: Option<EnergyBalance>,
    /// The bores through life and the last cycle, if they do.
    pub worn: Option<WornLife>,
}

/// Points of a path on the ideal mechanism per cycle: a cubic between two of them is off by some 1e-11 of its size.
const PATH: usize = 721;

impl<'a> Run<'a> {
    /// Islands, contact laws, round bores; bodies where the ideal mechanism has them.
    pub fn assemble(desk: Desk, scene: &'a Scene, accuracy: &'a Accuracy) -> Result<Self, SimulationFailure> {
        let mut newton = 0;
        let wanted = Wanted::by(scene);
        let islands = islands(scene)?;
        // A linkage that locks on its way is named as such, before a contact is blamed for it.
        let samples = if wanted.points.is_empty() { 2 } else { PATH };
        let poses = ideal_cycle(scene, samples, &mut newton)?;
        if poses.len() < samples && !wanted.points.is_empty() {
            return Err(SimulationFailure::NotModelled {
                what: "a position error where the drives leave the ideal motion open".into(),
            });
        }
        let islands = islands
            .into_iter()
            .map(|island| Moving::new(island, &poses[0], scene, &wanted, accuracy))
            .collect();
        Ok(Run {
            desk,
            scene,
            accuracy,
            islands,
            cycle: 0,
            stats: AdvanceStats::default(),
            wear_stats: WearStepStats::default(),
            newton,
            simulated: 0,
            ideal_paths: wanted.points.iter().map(|at| (*at, ideal_path(scene, &poses, at))).collect(),
            guided: vec![],
            tier_difference: vec![0.0; scene.outputs.len()],
            watched: false,
            worn_energy: None,
            worn: None,
        })
    }

    /// Whole cycles from the ideal mechanism's state, as many as the scene asks for: the journals find their bores.
    pub async fn settle(&mut self) -> Result<(), SimulationFailure> {
        let period = self.scene.life.period;
        for cycle in (1..=self.scene.life.settle_cycles).rev() {
            let start = -f64::from(cycle) * period;
            self.span(start, start + period, false).await?;
            self.simulated += 1;
        }
        Ok(())
    }

    /// Whether any joint wears, so that life changes anything.
    pub fn wears(&self) -> bool {
        self.islands.iter().any(|m| m.island.joints.iter().any(|j| j.wear_coefficient > 0.0))
    }

    /// From the state kept of the cycle before, on the profile as it is now, to the start of a cycle.
    async fn warm_up(&mut self) -> Result<(), SimulationFailure> {
        for m in &mut self.islands {
            m.saved.restore(&mut m.island, &mut m.q, &mut m.v);
            m.advance.control.after_jump();
        }
        let period = self.scene.life.period;
        self.span(-self.accuracy.warm_up * period, 0.0, false).await
    }

    /// Back to where the cycle just measured began, with time steps of another accuracy.
    pub fn begin_again(&mut self, accuracy: &Accuracy) {
        for m in &mut self.islands {
            m.begun.restore(&mut m.island, &mut m.q, &mut m.v);
            m.exchange(&mut m.tools(self.scene.life.period, accuracy));
        }
    }

    /// One recorded cycle; keeps the state from which the next warm-up starts.
    pub async fn measure(&mut self) -> Result<(), SimulationFailure> {
        let period = self.scene.life.period;
        let kept = (1.0 - self.accuracy.warm_up).max(0.0) * period;
        for m in &mut self.islands {
            m.recorder.clear();
            m.begun.keep(&m.island, &m.q, &m.v);
        }
        if kept > 0.0 {
            self.span(0.0, kept, true).await?;
        }
        for m in &mut self.islands {
            m.saved.keep(&m.island, &m.q, &m.v);
        }
        self.span(kept, period, true).await?;
        for m in &mut self.islands {
            m.recorder.finish();
            if kept == 0.0 {
                m.saved.keep(&m.island, &m.q, &m.v);
            }
        }
        self.simulated += 1;
        Ok(())
    }

    /// Warm-up and measured cycle on the profile as it is now.
    pub async fn next_cycle(&mut self) -> Result<(), SimulationFailure> {
        self.warm_up().await?;
        self.measure().await
    }

    /// The last measured cycle, dynamic, on the bores as worn by then; with its energy and as a whole if people want to
    /// see it.
    pub async fn last_cycle(&mut self) -> Result<(), SimulationFailure> {
        self.show(self.watched);
        self.next_cycle().await?;
        if self.watched {
            self.worn_energy = Some(self.energy());
            let cycle = self.shown_cycle();
            self.worn.get_or_insert_default().last_cycle = Some(cycle);
        }
        self.show(false);
        Ok(())
    }

    /// The cycle after the one just measured, on the same profile.
    pub async fn further_cycle(&mut self) -> Result<(), SimulationFailure> {
        let period = self.scene.life.period;
        self.islands.iter_mut().for_each(|m| m.recorder.clear());
        self.span(0.0, period, true).await?;
        self.islands.iter_mut().for_each(|m| m.recorder.finish());
        self.simulated += 1;
        Ok(())
    }

    /// Closes the account of the last block's wear step with the contact of the cycle just measured.
    pub fn close_wear(&mut self) -> Result<(), SimulationFailure> {
        for (index, m) in self.islands.iter_mut().enumerate() {
            let Moving { island, recorder, rates, steps, depth, .. } = m;
            let histories = self.guided.get(index).map_or(&*recorder, |g| &g.recorder).histories.as_slice();
            for (k, joint) in island.joints.iter().enumerate().filter(|(_, j)| j.wear_coefficient > 0.0) {
                rates[k].freeze(&histories[k]);
                steps[k].renew(&mut rates[k], &depth[k], &mut self.wear_stats).map_err(|failed| {
                    SimulationFailure::WearStep {
                        cycle: self.cycle,
                        joint: joint.name.clone(),
                        error: failed.0,
                    }
                })?;
            }
        }
        Ok(())
    }

    /// Depth at every control point of every joint of the scene; none of an ideal joint [m].
    pub fn depths(&self) -> Vec<Vec<f64>> {
        let mut all = vec![Vec::new(); self.scene.joints.len()];
        for m in &self.islands {
            for (joint, depth) in m.island.joints.iter().zip(&m.depth) {
                all[joint.scene_joint].clone_from(depth);
            }
        }
        all
    }

    /// Keeps the bores as they are at a life, if people want to see them.
    pub fn keep_bores(&mut self, life: u32) {
        if self.watched {
            let depths = self.depths();
            let worn = self.worn.get_or_insert_default();
            worn.cycles.push(life);
            worn.wear_depth.push(depths);
        }
    }

    /// Carries every island from one time of the cycle to another.
    async fn span(&mut self, from: f64, to: f64, record: bool) -> Result<(), SimulationFailure> {
        let islands = std::mem::take(&mut self.islands);
        let stretches = islands.into_iter().map(|moving| Stretch { moving, from, to, record }).collect();
        let mut first = Ok(());
        for Carried { moving, stats, arrived } in self.desk.carry(stretches).await {
            self.stats.add(&stats);
            first = first.and(arrived.map_err(|error| failure(error, self.cycle, &moving.island)));
            self.islands.push(moving);
        }
        first
    }

    /// Whether everything is recorded, for people to see.
    pub fn show(&mut self, show: bool) {
        for m in &mut self.islands {
            m.recorder.shown = show.then(|| Shown::new(&m.island));
        }
    }

    /// Wears every bore from one life to another under the contact of the cycle just measured; `wear` takes the
    /// wear outputs at the checkpoints between.
    pub fn wear(
        &mut self,
        from: u32,
        to: u32,
        checkpoints: &[u32],
        wear: &mut [Vec<f64>],
    ) -> Result<(), SimulationFailure> {
        let marks: Vec<f64> = checkpoints.iter().map(|&c| f64::from(c - from)).collect();
        // Largest depth of each joint at each checkpoint, by the scene's numbering of the joints.
        let mut largest = vec![vec![0.0_f64; self.scene.joints.len()]; marks.len()];
        for (index, m) in self.islands.iter_mut().enumerate() {
            let histories = self.guided.get(index).map_or(&m.recorder, |g| &g.recorder).histories.as_slice();
            for (k, joint) in m.island.joints.iter_mut().enumerate() {
                if joint.wear_coefficient == 0.0 {
                    continue;
                }
                m.rates[k].freeze(&histories[k]);
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
                if let Some((depth, wall)) = worn_through(self.scene, joint.scene_joint, &m.depth[k]) {
                    let joint = joint.name.clone();
                    return Err(SimulationFailure::WornThrough { cycle: to, joint, depth, wall });
                }
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
}

/// Path of a point over the cycle of the ideal mechanism.
fn ideal_path(scene: &Scene, poses: &[Pose], at: &Attachment) -> PointTrack {
    let mut path = PointTrack::default();
    let arm = scene.arm(at);
    for pose in poses {
        if let (Some(q), Some(v)) = (pose.q[at.body], pose.v[at.body]) {
            let frame = Frame::free(&q, &v);
            path.push(pose.time, frame.point(arm), frame.velocity(arm));
        }
    }
    path
}

/// Largest depth and thickness of the wall, where the former has reached the latter [m].
fn worn_through(scene: &Scene, joint: usize, depth: &[f64]) -> Option<(f64, f64)> {
    let JointKind::Clearance(clearance) = &scene.joints[joint].kind else { return None };
    let largest = depth.iter().fold(0.0_f64, |a, &b| a.max(b));
    clearance.wall.filter(|&wall| largest >= wall).map(|wall| (largest, wall))
}
