//! Motion without vibrations: the inertia is that of the mechanism with ideal joints, and the gaps of the joints follow from
//! the balance of forces.
//!
//! With q = q_ideal(t) + g and the accelerations a_ideal of the ideal mechanism, M qdd = f(t, q, qd) becomes an equation for the
//! gaps g [m, rad] alone,
//!
//!   f(t, q_ideal + g, v_ideal + dg/dt) = M a_ideal,
//!
//! whose only rates are those of film, contact damping and friction. The term M d2g/dt2 is neglected: no impacts, no contact
//! vibrations. This is valid where the joints stay in contact and the wear does not depend on vibrations, which
//! [`wear_rate_difference`] measures against the dynamics; [`Unsuitable`] lists where it is not.
//!
//! | file | contents |
//! |---|---|
//! | `ideal_motion.rs` | q_ideal, v_ideal, a_ideal as functions of time |
//! | `gap_solver.rs` | equilibrium of the gaps, and one time step of them |
//! | `stepper.rs` | steps with error control through a span of time |
//! | `unsuitable.rs` | difference of the wear rates of two models of the motion |
//! | `unsuitable.rs` | reasons to use the dynamics instead |
//!
//! # Source
//! Derived here from M qdd = f by splitting the coordinates into ideal motion and gaps.

#[cfg(test)]
mod convergence_tests;
mod gap_solver;
mod ideal_motion;
mod stepper;
mod unsuitable;

pub(crate) use ideal_motion::{IdealMotion, ideal_motions};
pub(crate) use stepper::QuasiStaticStepper;
pub use unsuitable::Unsuitable;
pub(crate) use unsuitable::wear_rate_difference;
