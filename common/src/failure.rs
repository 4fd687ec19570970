//! Failures of an evaluation: what a simulation reports instead of a result. A failure is an outcome that is recorded
//! with its sample, not an error of the infrastructure, and is not retried.

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
    /// The mechanism cannot move through the whole cycle: its constraints become dependent.
    #[error("the mechanism reaches a dead point at time {time} s, where {body} is at {} deg: joint {joint} cannot be closed beyond it", angle.to_degrees())]
    DeadPoint {
        /// Joint that opens first beyond it.
        joint: String,
        /// Time within the cycle [s].
        time: f64,
        /// Name of the driven body.
        body: String,
        /// Angle of that body [rad].
        angle: f64,
    },
    /// Ideal joints forbid the same motion twice.
    #[error("the mechanism is over-constrained: joint {joint} repeats a constraint of the joints before it")]
    OverConstrained {
        /// The first joint, in the order of the file, that depends on those before it.
        joint: String,
    },
    /// The constraints of the ideal joints became dependent during the motion.
    #[error("at cycle {cycle}, t = {time} s, the ideal joints became dependent (a dead point of the motion)")]
    Singular {
        /// Cycle of the life, from 0.
        cycle: u32,
        /// Time within the cycle [s].
        time: f64,
    },
    /// The bushing is worn through, or a slider down to its middle.
    #[error(
        "at cycle {cycle} joint {joint} is worn through: depth {depth} m, wall {wall} m; shorten the life, or choose a thicker wall or a smaller wear_coefficient"
    )]
    WornThrough {
        /// Cycle of the life, from 0.
        cycle: u32,
        /// Name of the joint.
        joint: String,
        /// Wear depth [m].
        depth: f64,
        /// Thickness of the wall, half the height of a slider [m].
        wall: f64,
    },
    /// The step size fell below its lower bound.
    #[error(
        "at cycle {cycle}, t = {time} s{}, the time step fell to {step} s (error {error} times its bound); give the joint contact_damping or film_damping, or a larger friction_speed",
        at_joint(joint)
    )]
    StepTooSmall {
        /// Cycle of the life, from 0.
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
    #[error(
        "at cycle {cycle}, t = {time} s{}, the bound of {bound} steps per cycle was reached; allow more (steps-N in the accuracy), or give the joint contact_damping or film_damping, or a larger friction_speed",
        at_joint(joint)
    )]
    TooManySteps {
        /// Cycle of the life, from 0.
        cycle: u32,
        /// Time within the cycle [s].
        time: f64,
        /// Joint with the largest force on the body whose error limited the last step; none if it has no joint
        /// with clearance.
        joint: Option<String>,
        /// Largest number of steps per cycle.
        bound: u64,
    },
    /// The wear step could not reach its tolerance.
    #[error(
        "at cycle {cycle} the wear of joint {joint} did not reach its tolerance (error {error} times its bound); use smaller wear steps (jump-N in the accuracy) or more control_points"
    )]
    WearStep {
        /// Cycle of the life, from 0.
        cycle: u32,
        /// Name of the joint.
        joint: String,
        /// Error estimate over tolerance.
        error: f64,
    },
    /// A contact left the range of its law: the journal is deeper in the wall than the law admits.
    #[error(
        "at cycle {cycle}, t = {time} s, joint {joint}: penetration {penetration} m is outside the contact law's range; lower the load, or choose a stiffer material or a wider joint"
    )]
    OutOfRange {
        /// Cycle of the life, from 0.
        cycle: u32,
        /// Time within the cycle [s].
        time: f64,
        /// Name of the joint.
        joint: String,
        /// Penetration of the journal into the wall [m].
        penetration: f64,
    },
    /// A number stopped being finite.
    #[error("at cycle {cycle}, t = {time} s, {quantity} is not finite")]
    NotFinite {
        /// Cycle of the life, from 0.
        cycle: u32,
        /// Time within the cycle [s].
        time: f64,
        /// The quantity, in words.
        quantity: String,
    },
    /// The scene contains something that the worker does not model.
    #[error("not modelled: {what}")]
    NotModelled {
        /// The feature that is not modelled, in words.
        what: String,
    },
    /// The simulation itself broke: a defect of the program, kept as the outcome of this one sample.
    #[error("the simulation panicked: {message}")]
    Panicked {
        /// Message of the panic.
        message: String,
    },
    /// An external simulator reports a failure.
    #[error("the simulator reports: {message}")]
    Reported {
        /// Message of the simulator.
        message: String,
    },
    /// An external simulator exceeded its time limit.
    #[error("the simulator gave no answer within {seconds} s")]
    TimedOut {
        /// The time limit [s].
        seconds: f64,
    },
    /// An external simulator ended instead of answering, and a fresh one did so too.
    #[error("the simulator ended with {status}{}", last_words(stderr))]
    Crashed {
        /// Exit status as the system reports it, e.g. `exit status: 3`.
        status: String,
        /// The last lines of its standard error.
        stderr: String,
    },
    /// An external simulator returned something that is no finite number.
    #[error("the simulator returned {value} for output {output} at cycle {cycles}")]
    NoNumber {
        /// Name of the output.
        output: String,
        /// Checkpoint of the value [cycles].
        cycles: u32,
        /// The value as returned.
        value: String,
    },
    /// A worker cannot use its external simulator. Nothing is known about the sample: it is never the result of an
    /// evaluation, which goes to another worker.
    #[error("the simulator cannot be used: {reason}")]
    SimulatorUnusable {
        /// What is wrong with the simulator or its reply.
        reason: String,
    },
    /// The friction of the ideal joints has no solution, or none that continues the one without friction.
    #[error("at cycle {cycle}, t = {time} s, joint {joint} locks itself: no reaction balances its friction")]
    SelfLocking {
        /// Cycle of the life, from 0.
        cycle: u32,
        /// Time within the cycle [s].
        time: f64,
        /// Name of the ideal joint.
        joint: String,
    },
    /// The motion cannot be continued through a position in which the constraints of the ideal joints are dependent.
    #[error(
        "at cycle {cycle}, t = {time} s, joint {joint} depends on the other ideal joints in a position where the motion may branch: change lengths or the start so that the mechanism passes beside this position or through it with more speed, or give the joint a clearance"
    )]
    Branching {
        /// Cycle of the life, from 0.
        cycle: u32,
        /// Time within the cycle [s].
        time: f64,
        /// Ideal joint that depends on the others there.
        joint: String,
    },
}

/// `: LINES`, or nothing without lines.
fn last_words(stderr: &str) -> String {
    if stderr.is_empty() { String::new() } else { format!(": {stderr}") }
}

/// `, joint NAME`, or nothing without a joint.
fn at_joint(joint: &Option<String>) -> String {
    joint.as_ref().map(|name| format!(", joint {name}")).unwrap_or_default()
}
