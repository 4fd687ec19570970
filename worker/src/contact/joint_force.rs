//! Motion of one joint with clearance and the force it exerts; frame and signs as in the parent module.

use crate::lanes::{Real, lanewise};

/// Motion of one joint, in the bushing's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointMotion<R = f64> {
    /// Eccentricity `(2,)` [m].
    pub e: [R; 2],
    /// Relative velocity of the centres `(2,)` [m/s].
    pub w: [R; 2],
    /// Angular velocity of the journal's body [rad/s].
    pub omega_journal: R,
    /// Angular velocity of the bushing's body [rad/s].
    pub omega_bushing: R,
    /// Angle alpha of the journal's body minus that of the bushing's [rad].
    pub turn: R,
}

/// Force and torques of one joint at one instant.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointForce<R = f64> {
    /// Force on the journal, at its centre `(2,)` [N].
    pub force: [R; 2],
    /// Torque on the journal's body in addition to that of `force` [N m].
    pub torque_journal: R,
    /// Torque on the bushing's body in addition to that of the opposite force [N m].
    pub torque_bushing: R,
    /// Normal contact force F_N >= 0, without the film [N].
    pub normal: R,
    /// Direction in which the journal presses on the bushing, zero in free flight `(2,)` [1].
    pub direction: [R; 2],
    /// Penetration delta, negative in free flight [m].
    pub penetration: R,
    /// Sliding speed v_t of the journal's surface over the bushing's [m/s].
    pub sliding: R,
}

/// Derivatives of the force and torques of one joint to its motion, in the axes of its contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceSlopes<R = f64> {
    /// Unit vector u of the first axis in the bushing's frame; the second, t, is its left normal `(2,)` [1].
    pub u: [R; 2],
    /// Derivatives of (force along u, force along t, torque_journal, torque_bushing) to (e along u, e along t, w
    /// along u, w along t, omega_journal, omega_bushing) `(4, 6)`.
    pub rows: [[R; 6]; 4],
    /// Derivatives of the same to the angle alpha of the journal from the bushing at constant e and w `(4,)`; `None` if the
    /// journal is round, and its angle without effect.
    pub to_turn: Option<[R; 4]>,
}

lanewise!(numbers JointForce { force, torque_journal, torque_bushing, normal, direction, penetration, sliding });

impl<R: Real> ForceSlopes<R> {
    /// No dependence on the motion; `like` sets the number of lanes.
    #[inline(always)]
    pub(crate) fn none(like: R) -> Self {
        let zero = like.zero();
        ForceSlopes { u: [like.like(1.0), zero], rows: [[zero; 6]; 4], to_turn: None }
    }
}
