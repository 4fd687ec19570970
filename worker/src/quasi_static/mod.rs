//! The motion without its vibrations: inertia from the mechanism with ideal joints, and at every crank angle the
//! gaps at which the forces carry it.
//!
//! With q = q_ideal(t) + g and the accelerations of the ideal mechanism, M qdd = f becomes an equation for the
//! gaps alone, f(t, q_ideal + g, v_ideal + dg/dt) = M a_ideal, whose only rates are those of film, contact damping
//! and friction. What is left out is M d2g/dt2: impacts and contact vibrations. Wear seldom needs them; whether it
//! does is found by comparing wear rates with those of the dynamics.

mod compare;
#[cfg(test)]
mod convergence_tests;
mod follow;
mod gap;
mod ideal_motion;
mod unsuitable;

pub use compare::largest_difference;
pub use follow::{Follow, FollowStats, StepBounds};
pub use ideal_motion::{IdealMotion, ideal_motions};
pub use unsuitable::Unsuitable;
