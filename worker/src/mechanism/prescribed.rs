//! Bodies with prescribed motion: fixed, or turned about their reference point by a drive.

use super::frame::Frame;
use super::piecewise_cubic::{Jet, PiecewiseCubic};
use crate::lanes::Real;
use common::scene::{Body, Drive, Motion};

/// A prescribed motion: the reference point stands still, the angle is a function of time.
#[derive(Debug, Clone, PartialEq)]
pub struct Prescribed {
    pub(crate) position: [f64; 2],
    angle: Angle,
}

#[derive(Debug, Clone, PartialEq)]
enum Angle {
    Still,
    Constant { start: f64, speed: f64 },
    Table(PiecewiseCubic),
    Integral { start: f64, speed: PiecewiseCubic },
}

impl Prescribed {
    /// The prescribed motion of `body`; `None` for a free body.
    pub fn from_body(body: &Body) -> Option<Self> {
        let (position, drive) = match &body.motion {
            Motion::Fixed => return Some(Prescribed { position: [0.0; 2], angle: Angle::Still }),
            Motion::Driven { position, drive, .. } => (*position, drive),
            Motion::Free { .. } => return None,
        };
        Some(Prescribed { position, ..Self::stroke(drive) })
    }

    /// A drive by itself: the distance of a linear drive [m] in the place of the angle.
    pub(super) fn stroke(drive: &Drive) -> Self {
        let angle = match drive {
            Drive::ConstantSpeed { start_angle, speed } => {
                Angle::Constant { start: *start_angle, speed: *speed }
            }
            Drive::Angle(table) => Angle::Table(PiecewiseCubic::spline(table)),
            Drive::Speed { start_angle, table } => {
                Angle::Integral { start: *start_angle, speed: PiecewiseCubic::monotone(table) }
            }
        };
        Prescribed { position: [0.0; 2], angle }
    }

    /// Angle and its first three derivatives at time `t` [s] [rad, rad/s, rad/s^2, rad/s^3].
    #[inline(always)]
    pub(crate) fn jet(&self, t: f64) -> Jet {
        match &self.angle {
            Angle::Still => [0.0; 4],
            Angle::Constant { start, speed } => [start.plus_product(*speed, t), *speed, 0.0, 0.0],
            Angle::Table(angle) => angle.jet(t),
            Angle::Integral { start, speed } => {
                let [omega, alpha, jerk, _] = speed.jet(t);
                [start + speed.integral(t) - speed.integral(0.0), omega, alpha, jerk]
            }
        }
    }

    /// Angle [rad] at time `t` [s].
    pub fn angle(&self, t: f64) -> f64 {
        self.jet(t)[0]
    }

    /// Frame of the body at time `t` [s].
    pub(crate) fn frame(&self, t: f64) -> Frame {
        Frame::turning(self.position, &self.jet(t))
    }

    /// Angle at time zero [rad] and angular velocity [rad/s] of a body that turns evenly or is fixed.
    pub(crate) fn even_rotation(&self) -> Option<[f64; 2]> {
        match self.angle {
            Angle::Still => Some([0.0; 2]),
            Angle::Constant { start, speed } => Some([start, speed]),
            Angle::Table(_) | Angle::Integral { .. } => None,
        }
    }

    /// Whether the body is fixed.
    pub(crate) fn is_still(&self) -> bool {
        self.angle == Angle::Still
    }
}
