//! The wear of the joints of an evaluation so far.
//!
//! # Grooves
//! Grooves of the worn bores that are narrower than their journals.
//!
//! Such a journal lies on both edges of the groove. Under `foundation` it has a patch of contact on each; `local-hertz`, whose penetration is
//! measured along the eccentricity alone, lets it into the groove. In both cases the geometry deserves a look: more control points may
//! smooth the groove, or the load wears it there in truth. A journal that wears counts as a circle, as thick as it is where it has worn least.

use super::island_state::IslandState;
use super::quasi_static_island::wear_histories;
use super::run::Run;
use crate::contact::{FreeRegion, Surfaces};
use crate::mechanism::WearingPair;
use crate::wear::{FinerBore, WearLaw, WornAmounts};
use common::outputs::NarrowGroove;

impl Run<'_> {
    /// Depth at every control point of the bore and of the journal of every joint of the scene, or of the guide and of the slider, empty where
    /// there is none and for journals and sliders that do not wear `(joints, 2, points)` [m].
    pub(crate) fn depths(&self) -> Vec<[Vec<f64>; 2]> {
        let mut all = vec![[Vec::new(), Vec::new()]; self.scene.joints.len()];
        for state in &self.islands {
            for (pair, depth) in state.island.pairs().zip(&state.depth) {
                let (first, second) = depth.split_at(pair.first_depths());
                all[pair.scene_joint()] = [first.to_vec(), second.to_vec()];
            }
        }
        all
    }

    /// What the wear of every joint of the scene amounts to, nothing for ideal joints `(joints,)`.
    pub(crate) fn worn_amounts(&self) -> Vec<WornAmounts> {
        let mut all = vec![WornAmounts::default(); self.scene.joints.len()];
        for state in &self.islands {
            for (pair, (rate, depth)) in state.island.pairs().zip(state.rates.iter().zip(&state.depth)) {
                all[pair.scene_joint()] = rate.sizes().amounts(depth);
            }
        }
        all
    }

    /// Compares the bores at the end of life with their finer copies, under the contact of the cycle just measured.
    pub(crate) fn compare_bores(&mut self) {
        for (index, state) in self.islands.iter_mut().enumerate() {
            let IslandState { island, recorder, finer, rates, depth, .. } = state;
            let histories = wear_histories(&self.mixed, &self.quasi_static, recorder, index);
            for (k, (pair, finer)) in island.pairs().zip(finer).enumerate() {
                if pair.wears() {
                    finer.freeze(&histories[k], 0.0, rates[k].sizes().amounts(&depth[k]));
                }
            }
            state.wear_copies();
        }
    }
}

impl IslandState {
    /// Wears the finer copies of all pairs under the contacts that their surfaces were worn by last.
    pub(crate) fn wear_copies(&mut self) {
        self.finer.iter_mut().chain(&mut self.finest).for_each(FinerBore::advance);
    }
}

/// Smallest distance of the journal from the ground of a groove that counts, as a share of the unworn radial clearance [1]: where a
/// bore bends, its spline ripples by some thousandths of the depth.
const LEAST_OPEN: f64 = 0.01;

impl Run<'_> {
    /// Looks for grooves in the bores as worn to `life` [cycles], for journals as thick as they are at least: a journal that wears has lost
    /// its least depth all round. Keeps the most open groove of each joint.
    pub(crate) fn note_grooves(&mut self, life: u32) {
        let joints = self.islands.iter().flat_map(|state| state.island.joints.iter().zip(&state.depth));
        for (joint, depth) in joints.filter(|(joint, _)| joint.wears()) {
            let surface = joint.contact.surface();
            let (_, of_journal) = depth.split_at(joint.first_depths());
            let lost = of_journal.iter().copied().reduce(f64::min).unwrap_or(0.0);
            let bore = Surfaces { bore: &joint.profile, journal: None };
            let found = FreeRegion::new(bore, surface.journal_radius - lost, 0.0)
                .narrow_grooves(LEAST_OPEN * surface.clearance)
                .into_iter()
                .max_by(|a, b| a[2].total_cmp(&b[2]));
            let Some([angle, width, open]) = found else { continue };
            let name = &self.scene.joints[joint.scene_joint].name;
            let now = |since| NarrowGroove { joint: name.clone(), since, angle, width, open };
            match self.grooves.iter_mut().find(|known| known.joint == *name) {
                Some(known) if open > known.open => *known = now(known.since),
                Some(_) => {}
                None => self.grooves.push(now(life)),
            }
        }
    }
}
