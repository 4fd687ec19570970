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
    #[error("the linkage cannot be assembled: {}; check lengths and start positions", open_joint(joint, *gap, *angle))]
    CannotAssemble {
        /// Joint that the start positions leave open most.
        joint: String,
        /// Distance of its two points there, of a sliding joint across its line [m].
        gap: f64,
        /// Angle between its two bodies there beyond the one it prescribes; zero for a joint that prescribes none [rad].
        angle: f64,
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
    #[error("{}, the ideal joints became dependent (a dead point of the motion)", instant(*cycle, *time))]
    Singular {
        /// Cycle of the life, from 0.
        cycle: u32,
        /// Time within the cycle [s].
        time: f64,
    },
    /// The bushing is worn through, or a slider down to its middle.
    #[error(
        "at cycle {cycle} joint {joint} is worn through: depth {} um, wall {} um; shorten the life, or choose a thicker wall or a smaller wear_coefficient",
        rounded(1e6 * depth),
        rounded(1e6 * wall)
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
        "{}{}, the time step fell to {} s (error {} times its bound); {}",
        instant(*cycle, *time),
        at_joint(joint),
        rounded(*step),
        rounded(*error),
        softer(joint)
    )]
    StepTooSmall {
        /// Cycle of the life, from 0.
        cycle: u32,
        /// Time within the cycle [s].
        time: f64,
        /// Joint with the largest force on the body whose error was the largest, or one with friction; none if there is
        /// neither contact nor friction.
        joint: Option<String>,
        /// The step that would have been needed [s].
        step: f64,
        /// Error estimate over tolerance at that step.
        error: f64,
    },
    /// More steps than the bound of the accuracy setting.
    #[error(
        "{}{}, the bound of {bound} steps per cycle was reached; allow more (steps-N in the accuracy), or {}",
        instant(*cycle, *time),
        at_joint(joint),
        softer(joint)
    )]
    TooManySteps {
        /// Cycle of the life, from 0.
        cycle: u32,
        /// Time within the cycle [s].
        time: f64,
        /// Joint with the largest force on the body whose error limited the last step, or one with friction; none if there is
        /// neither contact nor friction.
        joint: Option<String>,
        /// Largest number of steps per cycle.
        bound: u64,
    },
    /// The wear step could not reach its tolerance.
    #[error(
        "at cycle {cycle} the wear of joint {joint} did not reach its tolerance (error {} times its bound); use shorter blocks (jump-N in the accuracy) or another number of control_points; a hinge worn deep by a load of one direction needs contact_law = \"foundation\"",
        rounded(*error)
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
        "{}, joint {joint}: a penetration of {} um is outside the contact law's range; lower the load, or choose a stiffer material or a wider joint",
        instant(*cycle, *time),
        rounded(1e6 * penetration)
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
    #[error("{}, {quantity} is not finite", instant(*cycle, *time))]
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
    #[error("{}, joint {joint} locks itself: no reaction balances its friction", instant(*cycle, *time))]
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
        "{}, joint {joint} depends on the other ideal joints in a position where the motion may branch: change lengths or the start so that the mechanism passes beside this position or through it with more speed, or give the joint a clearance",
        instant(*cycle, *time)
    )]
    Branching {
        /// Cycle of the life, from 0.
        cycle: u32,
        /// Time within the cycle [s].
        time: f64,
        /// Ideal joint that depends on the others there.
        joint: String,
    },
    /// A start velocity that the scene gives and that drives, joints and the start velocities before it do not admit.
    #[error("{key}: {}", unheld(key, *given, *needed))]
    StartVelocity {
        /// Path of the key, `bodies.NAME.start_speed`, `bodies.NAME.start_velocity.x` or `.y`.
        key: String,
        /// Value given [m/s, rad/s].
        given: f64,
        /// The only value that they admit [m/s, rad/s].
        needed: f64,
    },
    /// Ideal joints that become dependent where the drives hold the mechanism: its motion may go on in more than one way.
    #[error("{}", change_point(joint, body, *angle))]
    ChangePoint {
        /// Ideal joint that depends on the others there.
        joint: String,
        /// Name of the driven body.
        body: String,
        /// Angle of that body [rad].
        angle: f64,
    },
    /// The wear step of a joint on an elastic foundation could not reach its tolerance.
    #[error(
        "at cycle {cycle} the wear of joint {joint} did not reach its tolerance (error {} times its bound): the forces of a cycle are not carried by the worn surfaces; lower the load, the speed or the wear_coefficient, or use shorter blocks (jump-N in the accuracy) or another number of control_points",
        rounded(*error)
    )]
    WearOnFoundation {
        /// Cycle of the life, from 0.
        cycle: u32,
        /// Name of the joint.
        joint: String,
        /// Error estimate over tolerance.
        error: f64,
    },
    /// A surface is worn deeper than the model of the joint holds: half its radius, or half the length of a slider.
    #[error(
        "after cycle {cycle} joint {joint} is worn {} mm deep, beyond the {} mm (half the radius, or half the length of a slider) up to which its forces are modelled; shorten the life, or choose a smaller wear_coefficient or load",
        rounded(1e3 * depth),
        rounded(1e3 * bound)
    )]
    WornTooDeep {
        /// Cycle of the life at the beginning of the block, from 0.
        cycle: u32,
        /// Name of the joint.
        joint: String,
        /// Wear depth [m].
        depth: f64,
        /// Largest depth of the model [m].
        bound: f64,
    },
    /// More evaluations of the wear rate in a block than the wear step may take.
    #[error(
        "after cycle {cycle} the wear of joint {joint} took more than {bound} stages in one block of cycles; use shorter blocks (jump-N in the accuracy), or choose a softer material or a smaller wear_coefficient"
    )]
    TooManyWearStages {
        /// Cycle of the life at the beginning of the block, from 0.
        cycle: u32,
        /// Name of the joint.
        joint: String,
        /// Largest number of stages of a block.
        bound: u64,
    },
}

/// `: LINES`, or nothing without lines.
pub(crate) fn last_words(stderr: &str) -> String {
    if stderr.is_empty() { String::new() } else { format!(": {stderr}") }
}

/// `, joint NAME`, or nothing without a joint.
fn at_joint(joint: &Option<String>) -> String {
    joint.as_ref().map(|name| format!(", joint {name}")).unwrap_or_default()
}

/// What makes the motion easier to integrate: contact and friction, if a `joint` has them, else loads and drives.
fn softer(joint: &Option<String>) -> &'static str {
    match joint {
        Some(_) => "give the joint contact_damping or film_damping, or a larger friction_speed",
        None => {
            "there is neither contact nor friction: look for jumps in tables of drives and loads, for stiff springs, and for positions in which the joints lock"
        }
    }
}

/// Gap [m] and angle [rad] that are rounding.
const ROUNDING: f64 = 1e-12;

/// How far the start positions leave a joint open.
fn open_joint(joint: &str, gap: f64, angle: f64) -> String {
    let open = (gap > ROUNDING).then(|| format!("open by {} mm", rounded(1e3 * gap)));
    let turned = (angle.abs() > ROUNDING).then(|| format!("turned by {} deg", rounded(angle.to_degrees())));
    let apart: Vec<String> = open.into_iter().chain(turned).collect();
    format!("the start positions contradict joint {joint} most, where it is {}", apart.join(" and "))
}

/// What is wrong with a start velocity, and which value is right.
fn unheld(key: &str, given: f64, needed: f64) -> String {
    let unit = if key.ends_with("start_speed") { "rad/s" } else { "m/s" };
    format!(
        "{} {unit} cannot hold at the start: drives, joints and the start velocities given before it need {} {unit}; give that value, or leave the key out",
        with_digits(given, 9),
        with_digits(needed, 9)
    )
}

/// Where a mechanism reaches a change point, and what to do.
fn change_point(joint: &str, body: &str, angle: f64) -> String {
    format!(
        "the mechanism reaches a change point where {body} is at {} deg: joint {joint} depends on the other ideal joints there, and the motion may go on in more than one way; change a length, let the drive stay on one side of it, or give the joint a clearance",
        rounded(angle.to_degrees())
    )
}

/// A number with four digits.
fn rounded(number: f64) -> String {
    with_digits(number, 4)
}

/// A number with this many digits.
fn with_digits(number: f64, digits: usize) -> String {
    let rounded: f64 = format!("{number:.*e}", digits - 1).parse().unwrap_or(number);
    let is_short = rounded == 0.0 || (1e-4..1e7).contains(&rounded.abs());
    if is_short { rounded.to_string() } else { format!("{rounded:e}") }
}

/// A time [s] in words: in seconds up to a quarter of an hour.
fn span(time: f64) -> String {
    let (length, unit) = match time {
        time if time > 2.0 * 86_400.0 => (86_400.0, "days"),
        time if time > 2.0 * 3600.0 => (3600.0, "h"),
        time if time > 900.0 => (60.0, "min"),
        _ => (1.0, "s"),
    };
    format!("{} {unit}", rounded(time / length))
}

/// An instant `time` [s] after the start of a cycle; before it the mechanism settles, or warms up on new bores.
fn instant(cycle: u32, time: f64) -> String {
    let span = span(time.abs());
    match (time < 0.0, cycle) {
        (true, 0) => format!("settling, {span} before the first measured cycle"),
        (true, _) => format!("warming up, {span} before cycle {cycle}"),
        (false, _) => format!("at cycle {cycle}, t = {span}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_have_four_digits_and_say_what_comes_before_a_cycle() {
        let out = |cycle, time| {
            let joint = "3".to_owned();
            SimulationFailure::OutOfRange { cycle, time, joint, penetration: 1.23456789e-5 }.to_string()
        };
        assert!(
            out(7, 0.107910359750225)
                .starts_with("at cycle 7, t = 0.1079 s, joint 3: a penetration of 12.35 um is")
        );
        assert!(
            out(0, -0.014593).starts_with("settling, 0.01459 s before the first measured cycle, joint 3")
        );
        assert!(out(4, -1e-5).starts_with("warming up, 1e-5 s before cycle 4, joint 3"));
        assert!(out(0, -3.878e7).starts_with("settling, 448.8 days before the first measured cycle"));
        assert!(out(9, 8000.0).starts_with("at cycle 9, t = 2.222 h"));
        let numbers = [0.0, 1.0, 2.5e-13, -1234567.8, 8.0e9].map(rounded);
        assert_eq!(numbers, ["0", "1", "2.5e-13", "-1235000", "8e9"]);
    }

    #[test]
    fn issue_an_open_joint_was_said_to_be_turned_by_minus_zero() {
        assert!(open_joint("pin", 0.1, -0.0).ends_with("where it is open by 100 mm"));
        assert!(open_joint("weld", 3.469e-18, 0.5).ends_with("where it is turned by 28.65 deg"));
    }
}
