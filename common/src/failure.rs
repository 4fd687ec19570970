//! What the physics can report instead of a result. A failure is an outcome of an evaluation, not an error
//! of the infrastructure.

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Why an evaluation has no result.
#[derive(Debug, Clone, PartialEq, Error, Serialize, Deserialize)]
pub enum SimulationFailure {
    /// The sample does not give a valid scene (e.g. a bushing smaller than its journal).
    #[error("the sample gives an invalid scene: {faults}")]
    InvalidSample {
        /// All faults, one per line.
        faults: String,
    },
    /// The mechanism cannot be assembled with ideal joints where the cycle starts.
    #[error("joint {joint} cannot be closed at time {time} s: gap {gap} m")]
    CannotAssemble {
        /// Joint with the largest gap.
        joint: String,
        /// Time within the cycle [s].
        time: f64,
        /// Remaining gap [m].
        gap: f64,
    },
    /// The mechanism moves, but not through the whole cycle: its joints' directions become dependent.
    #[error("the mechanism reaches a dead point at time {time} s, where {body} stands at {} deg: joint {joint} can follow no further", angle.to_degrees())]
    DeadPoint {
        /// Joint that opens first beyond it.
        joint: String,
        /// Time within the cycle [s].
        time: f64,
        /// The driven body.
        body: String,
        /// Its angle [rad].
        angle: f64,
    },
    /// Ideal joints forbid the same motion twice.
    #[error(
        "the mechanism is over-constrained: joint {joint} forbids a motion that the joints before it forbid already"
    )]
    OverConstrained {
        /// The first joint, in the order of the file, that depends on those before it.
        joint: String,
    },
    /// The ideal joints' directions became dependent during the motion.
    #[error("at cycle {cycle}, t = {time} s, the ideal joints became dependent (a dead point of the motion)")]
    Singular {
        /// Cycles done.
        cycle: u32,
        /// Time within the cycle [s].
        time: f64,
    },
    /// The bushing is worn through.
    #[error("at cycle {cycle} joint {joint} is worn through: depth {depth} m, wall {wall} m")]
    WornThrough {
        /// Cycles done.
        cycle: u32,
        /// Joint.
        joint: String,
        /// Wear depth [m].
        depth: f64,
        /// Thickness of the wall [m].
        wall: f64,
    },
    /// The step size fell below its lower bound.
    #[error(
        "at cycle {cycle}, t = {time} s{}, the time step fell to {step} s (error {error} times its bound)",
        at(joint)
    )]
    StepTooSmall {
        /// Cycles done when it happened.
        cycle: u32,
        /// Time within the cycle [s].
        time: f64,
        /// Joint with the largest force on the body whose error was the largest; none if it has no joint with
        /// clearance.
        joint: Option<String>,
        /// The step that would have been needed [s].
        step: f64,
        /// Error estimate over tolerance at that step.
        error: f64,
    },
    /// More steps than the bound of the accuracy setting.
    #[error("at cycle {cycle}, t = {time} s{}, the bound of {bound} steps per cycle was reached", at(joint))]
    TooManySteps {
        /// Cycles done.
        cycle: u32,
        /// Time within the cycle [s].
        time: f64,
        /// Joint with the largest force on the body whose error limited the last step; none if it has no joint
        /// with clearance.
        joint: Option<String>,
        /// Bound on steps.
        bound: u64,
    },
    /// The wear step could not reach its tolerance.
    #[error(
        "at cycle {cycle} the wear of joint {joint} did not reach its tolerance (error {error} times its bound)"
    )]
    WearStep {
        /// Cycles done.
        cycle: u32,
        /// Joint.
        joint: String,
        /// Error estimate over tolerance.
        error: f64,
    },
    /// Contact left the range of the model: wear went through the wall or the journal left the bore.
    #[error(
        "at cycle {cycle}, t = {time} s, joint {joint}: penetration {penetration} m is outside the contact law's range"
    )]
    OutOfRange {
        /// Cycles done.
        cycle: u32,
        /// Time within the cycle [s].
        time: f64,
        /// Joint.
        joint: String,
        /// Penetration [m].
        penetration: f64,
    },
    /// A number stopped being finite.
    #[error("at cycle {cycle}, t = {time} s, {quantity} is not finite")]
    NotFinite {
        /// Cycles done.
        cycle: u32,
        /// Time within the cycle [s].
        time: f64,
        /// What it was.
        quantity: String,
    },
    /// The scene asks for something this worker does not model.
    #[error("not modelled: {what}")]
    NotModelled {
        /// What.
        what: String,
    },
    /// The simulation itself broke: a defect of the program, kept as the outcome of this one sample.
    #[error("the simulation panicked: {message}")]
    Panicked {
        /// What the panic said.
        message: String,
    },
    /// An external simulator says why it has no result.
    #[error("the simulator reports: {message}")]
    Reported {
        /// Its words.
        message: String,
    },
    /// An external simulator took longer than it may.
    #[error("the simulator gave no answer within {seconds} s")]
    TimedOut {
        /// What it was given [s].
        seconds: f64,
    },
    /// An external simulator ended instead of answering, and a fresh one did so too.
    #[error("the simulator ended with {status}{}", last_words(stderr))]
    Crashed {
        /// How, e.g. `exit status: 3`.
        status: String,
        /// The last lines of its standard error.
        stderr: String,
    },
    /// An external simulator returned something that is no finite number.
    #[error("the simulator returned {value} for output {output} at cycle {cycles}")]
    NoNumber {
        /// The output.
        output: String,
        /// Checkpoint [cycles].
        cycles: u32,
        /// What stood there.
        value: String,
    },
}

/// `: LINES`, if there are any.
fn last_words(stderr: &str) -> String {
    if stderr.is_empty() { String::new() } else { format!(": {stderr}") }
}

/// `, joint NAME`, if there is one to be named.
fn at(joint: &Option<String>) -> String {
    joint.as_ref().map(|name| format!(", joint {name}")).unwrap_or_default()
}
