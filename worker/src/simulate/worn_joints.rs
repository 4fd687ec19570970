//! The wear of the joints of an evaluation so far.

use super::run::Run;
use crate::wear::WornAmounts;
use common::scene::{JointKind, Scene};

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

/// Largest depth and thickness of the wall of a joint of the scene [m], if the depth has reached the thickness.
pub(super) fn worn_through(scene: &Scene, joint: usize, depth: &[f64]) -> Option<(f64, f64)> {
    let JointKind::Clearance(clearance) = &scene.joints[joint].kind else { return None };
    let largest = depth.iter().fold(0.0_f64, |a, &b| a.max(b));
    clearance.wall.filter(|&wall| largest >= wall).map(|wall| (largest, wall))
}
