//! Prescribed motion, and curves over time or over the angle of a body.

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
