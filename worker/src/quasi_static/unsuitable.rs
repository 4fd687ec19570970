//! Why the quasi-static tier leaves an evaluation to the dynamics.

use common::failure::SimulationFailure;
use thiserror::Error;

/// Why the dynamics has to drive the wear.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum Unsuitable {
    /// The accuracy leaves no choice.
    #[error("the accuracy asks for the dynamics")]
    Unwanted,
    /// The scene asks for more than wear.
    #[error("output {output} needs the dynamics")]
    Output {
        /// Name of the output.
        output: String,
    },
    /// A joint without clearance: its force is no function of the gaps.
    #[error("joint {joint} has no clearance")]
    IdealJoint {
        /// Name of the joint.
        joint: String,
    },
    /// With ideal joints the drives do not determine the motion.
    #[error("the drives do not determine the motion of the ideal mechanism")]
    Undetermined,
    /// The ideal mechanism does not come back to where the cycle began.
    #[error("the ideal motion does not repeat itself: off by {share} of its range after a cycle")]
    NotPeriodic {
        /// Largest difference of position, velocity or acceleration, relative to its largest value [1].
        share: f64,
    },
    /// Nothing balances the load and the inertia with the mechanism at rest in its gaps.
    #[error("at t = {time} s the gaps find no equilibrium")]
    NoRest {
        /// Time [s].
        time: f64,
    },
    /// The step fell below its bound: contact is lost and nothing else holds the body.
    #[error("at t = {time} s nothing holds the gaps: the step fell to {step} s")]
    LostHold {
        /// Time [s].
        time: f64,
        /// Step [s].
        step: f64,
    },
    /// More steps than the bound.
    #[error("at t = {time} s the bound on steps was reached")]
    TooManySteps {
        /// Time [s].
        time: f64,
    },
    /// A joint left the range of its contact law.
    #[error("at t = {time} s joint number {joint} of its island is outside the contact law's range")]
    OutOfRange {
        /// Time [s].
        time: f64,
        /// Joint of the island.
        joint: usize,
    },
    /// The evaluation stopped on its way, in its wear or in the dynamics it was compared with.
    #[error(transparent)]
    Stopped(#[from] SimulationFailure),
    /// The wear rates differ too much from those of the dynamics.
    #[error("the wear rates differ from those of the dynamics by {share}")]
    Disagrees {
        /// Difference relative to the largest rate [1].
        share: f64,
    },
}
