//! Values of the keys of bodies, joints, loads and outputs: prescribed motions, curves over time or over the angle of a body, points on bodies,
//! where drives are held, measures over a cycle, bodies with a sign, quantities of the wear.

use super::choice::choice;
use super::output_unit::OutputUnit;
use serde::{Deserialize, Serialize};

/// Angle of a driven body as a function of time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Drive {
    /// angle = start_angle + speed t.
    ConstantSpeed {
        /// Angle at time zero [rad].
        start_angle: f64,
        /// Angular velocity, counter-clockwise positive [rad/s].
        speed: f64,
    },
    /// The angle by a table over time: a twice continuously differentiable cubic spline. A repeated table continues
    /// from where it ended: its last angle may differ from its first, by whole turns for a crank.
    Angle(Table),
    /// The angular velocity by a table over time [rad/s]; the angle is its integral.
    Speed {
        /// Angle at time zero [rad].
        start_angle: f64,
        /// Angular velocity over time.
        table: Table,
    },
}

/// A function by its values at increasing arguments, cubic between them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Table {
    /// Arguments, increasing, at least two `(n,)` [s or rad].
    pub at: Vec<f64>,
    /// Values `(n,)`, in the unit of the quantity.
    pub value: Vec<f64>,
    /// True if the table repeats periodically; otherwise its end values hold outside it.
    pub repeat: bool,
}

impl Table {
    /// The smallest and the largest value `(2,)`.
    pub fn range(&self) -> [f64; 2] {
        let ends = [f64::INFINITY, f64::NEG_INFINITY];
        self.value.iter().fold(ends, |[least, most], value| [least.min(*value), most.max(*value)])
    }
}

/// The argument of a curve.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Over {
    /// Time from the start of the cycle [s].
    Time,
    /// Angle of this body, index into [`super::Scene::bodies`] [rad].
    Angle(usize),
}

/// A quantity that varies by a table; monotone between its points and continuously differentiable, so that a
/// step in the table does not overshoot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Curve {
    /// Argument of the curve.
    pub over: Over,
    /// Values over the argument.
    pub table: Table,
}

/// Position in which the drives of a mechanism are held.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct HeldInput {
    /// Index of a driven body.
    pub body: usize,
    /// Its angle, whole turns not counted [rad].
    pub angle: f64,
}

choice! {
    /// Measure of an error over a cycle.
    pub enum ErrorMeasure;
    /// Largest size of the error.
    "largest" => Largest "largest"
    /// Root of the mean over time of its square.
    "rms" => RootMeanSquare "r.m.s."
}

choice! {
    /// Measure of the energies of the impacts of a cycle.
    pub enum ImpactMeasure;
    /// Sum over all impacts.
    "total" => Total "impacts per cycle"
    /// Energy of the hardest impact.
    "largest" => Largest "hardest impact"
}

/// A body with the sense in which its angle is reported.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SignedBody {
    /// Index into [`super::Scene::bodies`].
    pub body: usize,
    /// +1 or -1.
    pub sign: f64,
    /// Name in texts, e.g. `right`.
    pub label: String,
}

choice! {
    /// A quantity of the wear of one or more joints.
    pub enum WearQuantity;
    /// Largest wear depth of either surface of any of the joints [m].
    "largest-wear" => LargestDepth "largest wear depth"
    /// Largest wear depth of a bushing, or of a guide on both faces [m].
    "bushing-wear" => BushingDepth "largest wear depth of the bushing or guide"
    /// Largest wear depth of a journal, or of a slider on both faces [m].
    "journal-wear" => JournalDepth "largest wear depth of the journal or slider"
    /// Growth of the radial clearance of the joint where it grows most: the sum of the largest depths of its bushing and its journal,
    /// which is the largest growth of the gap over all places and relative angles [m]. For a guide, growth of the clearance on the side where it
    /// grows most: the sum of the largest depths of guide and slider on that face, the largest growth of the gap if they pass each other.
    "clearance-growth" => ClearanceGrowth "growth of the clearance"
    /// Volume worn from both surfaces of all joints [m^3].
    "worn-volume" => Volume "worn volume"
}

impl WearQuantity {
    /// Unit of the values.
    pub fn unit(self) -> OutputUnit {
        match self {
            Self::Volume => OutputUnit::Volume,
            _ => OutputUnit::Length,
        }
    }

    /// The surface that must wear, in words.
    pub(super) fn surface(self) -> &'static str {
        match self {
            Self::BushingDepth => "a bushing or a guide",
            Self::JournalDepth => "a journal or a slider",
            _ => "a joint",
        }
    }
}

/// A point of a body, by position in the body's frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Attachment {
    /// Index into [`super::Scene::bodies`].
    pub body: usize,
    /// Position in that body's frame `(2,)` [m].
    pub position: [f64; 2],
}
