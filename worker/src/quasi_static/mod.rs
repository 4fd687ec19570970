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
//!
//! # Source
//! Derived here from M qdd = f by splitting the coordinates into ideal motion and gaps.

#[cfg(test)]
mod convergence_tests;
mod gap_solver;
mod ideal_motion;
mod stepper;

pub(crate) use ideal_motion::{IdealMotion, ideal_motions};
pub(crate) use stepper::QuasiStaticStepper;

use common::failure::SimulationFailure;
use thiserror::Error;

/// Reason why the dynamics has to drive the wear.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum Unsuitable {
    /// The accuracy setting asks for the dynamics.
    #[error("the accuracy asks for the dynamics")]
    Unwanted,
    /// The scene has an output other than wear, and a contact law under which vibrations may grow as the bores wear. Holds the name of the output.
    #[error("output {0} needs the dynamics")]
    Output(String),
    /// The scene has an output other than wear, and the motion does not repeat itself.
    #[error("the motion does not repeat itself")]
    Aperiodic,
    /// An output other than wear is too far from straight lines between the lives at which it is measured.
    #[error("output {output} is off by {share} from a straight line over life")]
    Curved {
        /// Name of the output.
        output: String,
        /// Difference relative to its value [1].
        share: f64,
    },
    /// A joint has no clearance: its force is not a function of the gaps. Holds the name of the joint.
    #[error("joint {0} has no clearance")]
    IdealJoint(String),
    /// A joint is a guide with clearance: its contacts are not those of a journal. Holds the name of the joint.
    #[error("joint {0} is a guide with clearance")]
    Guide(String),
    /// The drives do not determine the motion of the ideal mechanism.
    #[error("the drives do not determine the motion of the ideal mechanism")]
    Undetermined,
    /// The ideal mechanism does not return to its state at the start of the cycle. Holds the largest difference of position, velocity or acceleration, relative to its largest value [1].
    #[error("the ideal motion does not repeat itself: off by {0} of its range after a cycle")]
    NotPeriodic(f64),
    /// The search for the equilibrium of the gaps failed: the contact forces do not balance load and inertia. Holds the time reached [s].
    #[error("at t = {0} s the gaps find no equilibrium")]
    NoRest(f64),
    /// The step fell below its bound: a joint lost contact and no other force holds the body.
    #[error("at t = {time} s nothing holds the gaps: the step fell to {step} s")]
    LostHold {
        /// Time reached [s].
        time: f64,
        /// Length of the step to try next [s].
        step: f64,
    },
    /// The number of steps reached its bound. Holds the time reached [s].
    #[error("at t = {0} s the bound on steps was reached")]
    TooManySteps(f64),
    /// A joint left the range of its contact law.
    #[error("at t = {time} s joint number {joint} of its island is outside the contact law's range")]
    OutOfRange {
        /// Time reached [s].
        time: f64,
        /// Index of the joint in its island.
        joint: usize,
    },
    /// The wear or the dynamics used for comparison failed.
    #[error(transparent)]
    Stopped(#[from] SimulationFailure),
    /// The wear rates differ too much from those of the dynamics. Holds the difference relative to the largest rate [1].
    #[error("the wear rates differ from those of the dynamics by {0}")]
    Disagrees(f64),
}

/// Largest difference between models `a` and `b` of the largest wear rate of a surface, relative to the largest rate of all `surfaces`
/// under `b`, so that surfaces that hardly wear do not decide [1].
///
/// Rates are given for every surface of the joints of the scene and every control point `(surfaces, points)` [m per cycle]. The result
/// is zero if nothing wears under either model, infinite if a surface wears under `a` alone.
pub(crate) fn wear_rate_difference(a: &[Vec<f64>], b: &[Vec<f64>], surfaces: &[usize]) -> f64 {
    let largest = |rates: &[Vec<f64>], j: usize| rates[j].iter().fold(0.0, |m: f64, x| m.max(*x));
    let largest_of_all = surfaces.iter().map(|&j| largest(b, j)).fold(0.0, f64::max);
    let off = surfaces.iter().map(|&j| (largest(a, j) - largest(b, j)).abs()).fold(0.0, f64::max);
    if off == 0.0 { 0.0 } else { off / largest_of_all }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_surface_that_hardly_wears_does_not_decide() {
        let a = [vec![1.0, 5.1, 0.0], vec![0.02, 0.0], vec![9.0]];
        let b = [vec![5.0, 1.0, 0.0], vec![0.01, 0.0], vec![7.0]];
        assert!((wear_rate_difference(&a, &b, &[0, 1]) - 0.02).abs() < 1e-12);
        assert!((wear_rate_difference(&a, &b, &[1]) - 1.0).abs() < 1e-12);
        assert_eq!(wear_rate_difference(&b, &b, &[0, 1, 2]), 0.0);
    }

    #[test]
    fn wear_where_there_is_none_is_no_agreement() {
        assert_eq!(wear_rate_difference(&[vec![1.0]], &[vec![0.0]], &[0]), f64::INFINITY);
        assert_eq!(wear_rate_difference(&[vec![0.0]], &[vec![0.0]], &[0]), 0.0);
    }
}
