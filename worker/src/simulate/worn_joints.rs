//! The wear of the joints of an evaluation so far.

use super::island_state::IslandState;
use super::quasi_static_island::wear_histories;
use super::run::Run;
use crate::wear::{WearLaw, WornAmounts};

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
            for (k, _) in island.pairs().enumerate().filter(|(_, pair)| pair.wears()) {
                finer[k].advance(&histories[k], 0.0, rates[k].sizes().amounts(&depth[k]));
            }
        }
    }
}
