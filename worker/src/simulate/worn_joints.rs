//! The wear of the joints of an evaluation so far.

use super::run::Run;
use crate::wear::WornAmounts;

impl Run<'_> {
    /// Depth at every control point of the bore and of the journal of every joint of the scene, empty where there is none and for
    /// journals that do not wear `(joints, 2, points)` [m].
    pub(crate) fn depths(&self) -> Vec<[Vec<f64>; 2]> {
        let mut all = vec![[Vec::new(), Vec::new()]; self.scene.joints.len()];
        for state in &self.islands {
            for (joint, depth) in state.island.joints.iter().zip(&state.depth) {
                let (bore, journal) = depth.split_at(joint.profile.points());
                all[joint.scene_joint] = [bore.to_vec(), journal.to_vec()];
            }
        }
        all
    }

    /// What the wear of every joint of the scene amounts to, nothing for ideal joints `(joints,)`.
    pub(crate) fn worn_amounts(&self) -> Vec<WornAmounts> {
        let mut all = vec![WornAmounts::default(); self.scene.joints.len()];
        for state in &self.islands {
            for (joint, (rate, depth)) in state.island.joints.iter().zip(state.rates.iter().zip(&state.depth))
            {
                all[joint.scene_joint] = rate.sizes().amounts(depth);
            }
        }
        all
    }
}
