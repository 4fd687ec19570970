//! Stiffness K_n of the Hertz contact between journal and bushing: F = K_n delta^1.5.
//!
//! # Source
//! Goldsmith (1960), Impact, as used by Lankarani, Nikravesh (1990), J. Mech. Design 112, 369-376.

use crate::lanes::{Real, cube_root};
use common::scene::{Clearance, Material};
use std::f64::consts::PI;

/// K_n = 4 / (3 pi (h_1 + h_2)) sqrt(R1 R2 / (R2 - R1)) [N/m^1.5], h_l = (1 - nu_l^2) / (pi E_l).
///
/// Poisson's ratio nu_l [1] and Young's modulus E_l [Pa] of journal and bushing; radii R2 > R1 > 0 [m] of the
/// unworn joint, as checked when the scene is read.
/// Equal to (4/3) E* sqrt(R1 R2 / (R2 - R1)) with the effective modulus E* [Pa].
pub fn hertz_stiffness(joint: &Clearance) -> f64 {
    let compliance = |m: &Material| (1.0 - m.poisson_ratio * m.poisson_ratio) / (PI * m.elastic_modulus);
    let (r1, r2) = (joint.journal_radius, joint.bushing_radius);
    let h = compliance(&joint.journal_material) + compliance(&joint.bushing_material);
    4.0 / (3.0 * PI * h) * (r1 * r2 / (r2 - r1)).sqrt()
}

/// Penetration at which F = K_n delta^1.5 gives the force `force` [N] for the stiffness `stiffness` [N/m^1.5]
/// [m].
#[inline(always)]
pub(crate) fn equivalent_penetration<R: Real>(force: R, stiffness: R) -> R {
    let root = cube_root(force / stiffness);
    root * root
}
