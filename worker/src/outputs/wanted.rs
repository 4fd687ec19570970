//! What a function generator should do: a quantity as a function of time or of the angle of a body.
//!
//! Between the points of its table the function is the cubic spline; where the table does not repeat, its slope at either end is that
//! of the cubic through the four points nearest to the end. The error is of fourth order in the distance of the points.
//!
//! # Source
//! De Boor, A Practical Guide to Splines (1978), chapter IV: complete spline with slopes by interpolation at the ends.

use super::trace::interval_at;
use super::{BodyTrack, RecordedCycle};
use crate::mechanism::{PiecewiseCubic, Prescribed};
use common::scene::{Curve, Over};
use std::borrow::Cow;

/// A wanted function over a recorded cycle.
pub struct Wanted<'a> {
    function: PiecewiseCubic,
    argument: Argument<'a>,
}

/// Argument of a wanted function.
enum Argument<'a> {
    Time,
    /// Angle of a prescribed body.
    Prescribed(Prescribed),
    /// Angle of a free body, with the interval last read.
    Recorded(Cow<'a, BodyTrack>, usize),
}

impl<'a> Wanted<'a> {
    /// The function of a scene over the recorded cycle.
    pub(crate) fn new(curve: &Curve, cycle: &RecordedCycle<'a>) -> Self {
        let argument = match curve.over {
            Over::Time => Argument::Time,
            Over::Angle(body) => match Prescribed::from_body(&cycle.scene.bodies[body]) {
                Some(motion) => Argument::Prescribed(motion),
                None => Argument::Recorded(cycle.body(body), 0),
            },
        };
        Wanted { function: PiecewiseCubic::interpolating(&curve.table), argument }
    }

    /// Value at time `t` [s], in the unit of the function; times must not decrease from call to call.
    pub(crate) fn at(&mut self, t: f64) -> f64 {
        let x = match &mut self.argument {
            Argument::Time => t,
            Argument::Prescribed(motion) => motion.angle(t),
            Argument::Recorded(track, k) => {
                let k = interval_at(&track.time, k, t);
                track.angle_in(k).at(t).0
            }
        };
        self.function.jet(x)[0]
    }
}

/// The body whose angle is the argument of a curve, if that angle has to be recorded or is prescribed.
pub(crate) fn argument_body(curve: &Curve) -> Option<usize> {
    match curve.over {
        Over::Time => None,
        Over::Angle(body) => Some(body),
    }
}
