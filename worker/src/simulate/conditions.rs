//! Operating conditions of one life: each is simulated on the same bores, and all together wear them.
//!
//! Condition c has the share a_c of the cycles, sum a_c = 1. With the wear rate dh_i/dN of `archard.rs` under the contact history of
//! condition c, a block of the life wears control point i by
//!
//!   dh_i/dN = sum over c of a_c (dh_i/dN)_c        [m per cycle],
//!
//! which is the rate under one history that holds the contacts of all conditions, their work F S multiplied by a_c K_c / K_0, with the
//! wear coefficients K [1/Pa] of condition c and of the first one, whose ratio is the same for both surfaces of a joint. This is what many changes of the condition within a block come to:
//! valid while a condition does not last so long that the bore adapts to it alone.
//!
//! # Source
//! Archard (1953), J. Appl. Phys. 24, 981-988: wear is linear in the work.

use super::failures::Simulated;
use super::probe::SURFACES;
use super::run::Run;
use super::side_by_side::LaneQueue;
use crate::mechanism::WearingPair;
use crate::wear::WearHistory;
use common::accuracy::Accuracy;
use common::scene::Scene;

/// The scene under each of its conditions, with their shares of the cycles [1]; the scene itself if it has none.
pub(crate) fn condition_scenes(scene: &Scene) -> Vec<(&Scene, f64)> {
    if scene.conditions.is_empty() {
        return vec![(scene, 1.0)];
    }
    scene.conditions.iter().map(|condition| (&condition.scene, condition.share)).collect()
}

/// Assembles the mechanism for each of its conditions, at least one.
///
/// # Errors
/// [`SimulationFailure`] as for one condition.
pub(crate) fn assemble<'a>(
    queue: &LaneQueue,
    scene: &'a Scene,
    accuracy: &'a Accuracy,
) -> Simulated<Vec<Run<'a>>> {
    let conditions = condition_scenes(scene).into_iter();
    let assembled = conditions.map(|(scene, share)| {
        let mut run = Run::assemble(queue.clone(), scene, accuracy)?;
        run.share = share;
        Ok(run)
    });
    assembled.collect()
}

/// Gives the first of several conditions the contacts of all, by which it wears its bores; of a single condition those recorded stay.
pub(crate) fn mix_contacts(runs: &mut [Run]) {
    let [first, others @ ..] = runs else { return };
    if others.is_empty() {
        return;
    }
    let base = wear_coefficients(first);
    let mut mixed = weighted_contacts(first, &base);
    for other in others.iter() {
        let further = weighted_contacts(other, &base);
        let pairs = mixed.iter_mut().flatten().zip(further.iter().flatten());
        pairs.for_each(|(all, further)| all.append(further));
    }
    first.mixed = mixed;
}

/// The wear coefficients of all joints of a run, of a surface that wears `(islands, pairs)` [1/Pa].
fn wear_coefficients(run: &Run) -> Vec<Vec<f64>> {
    let of = |pair: &dyn WearingPair| {
        let [first, second] = pair.wear_coefficients();
        first.max(second)
    };
    run.islands.iter().map(|state| state.island.pairs().map(of).collect()).collect()
}

/// The contacts of the last cycle of a run, each with its share of the work, relative to the wear coefficients `base`
/// `(islands, pairs)`.
fn weighted_contacts(run: &Run, base: &[Vec<f64>]) -> Vec<Vec<WearHistory>> {
    let own = wear_coefficients(run);
    let islands = run.contact_histories().zip(base.iter().zip(&own));
    let weighted = |(history, (base, own)): (&WearHistory, (&f64, &f64))| {
        let mut history = history.clone();
        history.scale_work(if *base > 0.0 { run.share * (own / base) } else { 0.0 });
        history
    };
    islands
        .map(|(joints, (base, own))| joints.iter().zip(base.iter().zip(own)).map(weighted).collect())
        .collect()
}

/// Wears the bores of all conditions as those of the first one are worn.
pub(crate) fn share_bores(runs: &mut [Run]) {
    if let [first, others @ ..] = runs {
        others.iter_mut().for_each(|other| other.take_bores(first));
    }
}

impl Run<'_> {
    /// Volume K_H F S that one cycle of this condition wears from every surface of every joint of the scene, zero for those that do not wear
    /// `(SURFACES joints,)` [m^3].
    pub(crate) fn volume_per_cycle(&self) -> Vec<f64> {
        let mut volumes = vec![0.0; SURFACES * self.scene.joints.len()];
        for (state, histories) in self.islands.iter().zip(self.contact_histories()) {
            for (pair, history) in state.island.pairs().zip(histories) {
                for (k, coefficient) in pair.wear_coefficients().iter().enumerate() {
                    volumes[SURFACES * pair.scene_joint() + k] = coefficient * history.work();
                }
            }
        }
        volumes
    }
}
