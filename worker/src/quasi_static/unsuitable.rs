//! Reasons why the dynamics, not the quasi-static model, has to drive the wear of an evaluation.

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
