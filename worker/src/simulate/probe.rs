//! A measured cycle put to the test: the cycle after it on the same profile, at finer time steps. What comes out
//! differently was due to the time steps, or had not settled.

use super::moving::{Moving, Tools};
use super::run::Run;
use common::failure::SimulationFailure;

/// Time steps of the further cycle are finer by this factor: their error is a ninth of that of the measured
/// cycle. At 1.5 the four-bar at 6 r/min still passes over vibrations that the measured cycle passed over too, and
/// the difference shows a third of the error.
pub const FINER: f64 = 1.75;
/// A relative change above this is taken for motion that does not repeat itself: that of the flapping wing changes by
/// 0.01 % from cycle to cycle, with a friction of 0.5 by 1 %.
const RESTLESS: f64 = 0.005;
/// The same on the unworn bores, where nothing but friction keeps a motion from repeating itself: that of the flapping wing
/// changes by 0.001 %.
const RESTLESS_BY_NATURE: f64 = 2e-4;
/// The same of the wear, whose rates, point by point, are rough: 300 samples of the contact a cycle change them by
/// more than half a per cent.
const RESTLESS_WEAR: f64 = 0.02;
/// Cycles looked at of a motion that does not repeat itself.
const MOST_CYCLES: usize = 3;

/// Factors of the damping that joints with a coefficient of restitution remember, one further cycle after the other: eight
/// times as much, then an eighth. A contact that begins anew in the cycle learns better; one that lasts remembers an
/// impact of the settling, which nobody knows, and what depends on that is part of the error.
const FORGETTING: [f64; 2] = [8.0, 1.0 / 64.0];

/// Changes from the measured cycle.
#[derive(Debug, Clone, PartialEq)]
pub struct Probe {
    /// Cycles done.
    pub life: u32,
    /// Largest change of every output that comes from the motion `(outputs,)`, in its unit.
    pub motion: Vec<f64>,
    /// Largest relative change of every joint's wear, by the scene's numbering [1].
    pub wear: Vec<f64>,
    /// Whether the motion does not repeat itself.
    pub restless: bool,
}

impl Run<'_> {
    /// Simulates the cycle after the one just measured, which is at the profile of `life`, and compares the two.
    /// What was measured stays as it was.
    ///
    /// # Errors
    /// As of any cycle.
    pub async fn probe(&mut self, life: u32) -> Result<Probe, SimulationFailure> {
        let measured = self.motion_outputs();
        let worn = self.wear_rates(life)?;
        let finer = self.accuracy.refined(FINER);
        let mut tools: Vec<Tools> =
            self.islands.iter().map(|m| m.tools(self.scene.life.period, &finer)).collect();
        self.exchange(&mut tools);
        let found = self.further_cycles(life, &measured, &worn).await;
        self.exchange(&mut tools);
        found
    }

    fn exchange(&mut self, tools: &mut [Tools]) {
        self.islands.iter_mut().zip(tools).for_each(|(m, tools)| m.exchange(tools));
    }

    async fn further_cycles(
        &mut self,
        life: u32,
        measured: &[f64],
        worn: &[Vec<f64>],
    ) -> Result<Probe, SimulationFailure> {
        let mut probe =
            Probe { life, motion: vec![0.0; measured.len()], wear: vec![0.0; worn.len()], restless: false };
        let remembers = self.remembers();
        let bound = if life == 0 { RESTLESS_BY_NATURE } else { RESTLESS };
        for cycle in 0..MOST_CYCLES {
            if let Some(factor) = FORGETTING.get(cycle).filter(|_| remembers) {
                self.change_memory(*factor);
            }
            self.further_cycle().await?;
            let mut restless = false;
            for ((largest, now), was) in probe.motion.iter_mut().zip(self.motion_outputs()).zip(measured) {
                let change = (now - was).abs();
                *largest = largest.max(change);
                restless |= change > bound * was.abs();
            }
            for ((largest, now), was) in probe.wear.iter_mut().zip(self.wear_rates(life)?).zip(worn) {
                let change = relative_change(&now, was);
                *largest = largest.max(change);
                restless |= change > RESTLESS_WEAR;
            }
            probe.restless |= restless;
            let forgetting = remembers && cycle + 1 < FORGETTING.len();
            if !restless && !forgetting {
                break;
            }
        }
        Ok(probe)
    }

    /// Whether a joint's damping follows from how its present contact began.
    fn remembers(&self) -> bool {
        let of = |m: &Moving| m.island.joints.iter().any(|j| j.contact.surface().restitution.is_some());
        self.islands.iter().any(of)
    }

    /// Multiplies what such joints remember.
    fn change_memory(&mut self, factor: f64) {
        for joint in self.islands.iter_mut().flat_map(|m| &mut m.island.joints) {
            if joint.contact.surface().restitution.is_some() {
                let damping = joint.contact.surface().damping;
                joint.contact.restore_damping(factor * damping);
            }
        }
    }

    /// Wear per cycle at every control point of every joint of the scene under the contact of the cycle just
    /// recorded; none of a joint that does not wear [m].
    fn wear_rates(&mut self, cycle: u32) -> Result<Vec<Vec<f64>>, SimulationFailure> {
        let mut all = vec![Vec::new(); self.scene.joints.len()];
        for Moving { island, recorder, rates, depth, .. } in &mut self.islands {
            for (k, joint) in island.joints.iter().enumerate().filter(|(_, j)| j.wear_coefficient > 0.0) {
                let found = &mut all[joint.scene_joint];
                found.resize(depth[k].len(), 0.0);
                rates[k].freeze(&recorder.histories[k]);
                rates[k].rate(&depth[k], found).map_err(|unbalanced| SimulationFailure::WearStep {
                    cycle,
                    joint: joint.name.clone(),
                    error: crate::wear::WearStepFailed::from(unbalanced).0,
                })?;
            }
        }
        Ok(all)
    }
}

/// Change of the volume worn per cycle or of the largest rate, whichever is more, relative to what it was; one
/// if there was nothing.
fn relative_change(now: &[f64], was: &[f64]) -> f64 {
    let volume = |rates: &[f64]| rates.iter().sum::<f64>();
    let largest = |rates: &[f64]| rates.iter().fold(0.0_f64, |a, &b| a.max(b));
    let change = |now: f64, was: f64| match (now, was) {
        (now, was) if now == was => 0.0,
        (_, was) if was > 0.0 => (now / was - 1.0).abs(),
        _ => 1.0,
    };
    change(volume(now), volume(was)).max(change(largest(now), largest(was)))
}

/// Whether the cycle simulated at the end of a block of wear is probed: those at the first checkpoint, at one and two
/// thirds of the life and at its end are, or the first ones after.
pub fn due(from: u32, to: u32, checkpoint_every: u32, end: u32) -> bool {
    let wanted = [checkpoint_every, end / 3, end / 3 * 2, end].map(|life| life.clamp(1, end));
    wanted.iter().any(|&life| from < life && life <= to)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_lives_are_probed_or_fewer() {
        let probed = |lives: &[u32], every: u32| -> Vec<u32> {
            let end = lives[lives.len() - 1];
            lives.windows(2).filter(|w| due(w[0], w[1], every, end)).map(|w| w[1]).collect()
        };
        assert_eq!(
            probed(&[0, 125, 250, 1000, 2000, 4000, 6000, 8000, 9000], 1000),
            [1000, 4000, 6000, 9000]
        );
        assert_eq!(probed(&[0, 1], 1), [1]);
    }

    #[test]
    fn change_is_that_of_the_volume_or_of_the_peak() {
        assert!((relative_change(&[2.0, 2.0], &[1.0, 3.0]) - 1.0 / 3.0).abs() < 1e-15);
        assert_eq!(relative_change(&[2.0, 6.0], &[1.0, 3.0]), 1.0);
        assert_eq!(relative_change(&[0.0], &[0.0]), 0.0);
        assert_eq!(relative_change(&[1.0], &[0.0]), 1.0);
        assert_eq!(relative_change(&[], &[]), 0.0);
    }
}
