//! The stages of an evaluation: settle, measure a cycle, wear a block, warm up.

use super::guided::Guided;
use super::moving::{Moving, failure};
use crate::integrate::AdvanceStats;
use crate::mechanism::{ideal_cycle, islands};
use crate::wear::WearStepStats;
use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::scene::{OutputKind, Scene};

/// One evaluation under way.
#[derive(Clone)]
pub struct Run<'a> {
    pub scene: &'a Scene,
    pub accuracy: &'a Accuracy,
    pub islands: Vec<Moving>,
    /// One per island while the quasi-static tier drives the wear.
    pub guided: Vec<Guided>,
    /// Cycles done.
    cycle: u32,
    pub stats: AdvanceStats,
    pub wear_stats: WearStepStats,
    pub newton: u64,
    pub simulated: u64,
    /// Largest difference of the wear rates between the tiers, relative, for each output; zero unless compared.
    pub tier_difference: Vec<f64>,
}

impl<'a> Run<'a> {
    /// Islands, contact laws, round bores; bodies where the ideal mechanism has them.
    pub fn assemble(scene: &'a Scene, accuracy: &'a Accuracy) -> Result<Self, SimulationFailure> {
        let mut newton = 0;
        // A linkage that locks on its way is named as such, before a contact is blamed for it.
        let pose = ideal_cycle(scene, 2, &mut newton)?.swap_remove(0);
        let tracked: Vec<usize> = scene
            .outputs
            .iter()
            .filter_map(|o| match &o.kind {
                OutputKind::AngularVelocityDifference { a, b } => Some([a.body, b.body]),
                _ => None,
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
            guided: vec![],
            cycle: 0,
            stats: AdvanceStats::default(),
            wear_stats: WearStepStats::default(),
            newton,
            simulated: 0,
            tier_difference: vec![0.0; scene.outputs.len()],
        })
    }

    /// One whole cycle from the ideal mechanism's state: the journals find their bores.
    pub fn settle(&mut self) -> Result<(), SimulationFailure> {
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
    pub fn measure(&mut self) -> Result<(), SimulationFailure> {
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

    /// Warm-up and measured cycle on the profile as it is now.
    pub fn next_cycle(&mut self) -> Result<(), SimulationFailure> {
        self.warm_up()?;
        self.measure()
    }

    /// Carries every island from one time of the cycle to another.
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

    /// Whether the joints' forces are recorded, for people to see.
    pub fn show_forces(&mut self, show: bool) {
        for m in &mut self.islands {
            m.recorder.forces = show.then(|| vec![Default::default(); m.island.joints.len()]);
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
