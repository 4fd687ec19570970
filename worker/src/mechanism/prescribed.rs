//! Bodies whose motion is given: part of the frame, or turning about their reference point as a drive says.

use super::frame::Frame;
use super::table::{Jet, PiecewiseCubic};
use crate::lanes::{Real, sincos};
use common::scene::{Body, Drive, Motion};

/// A prescribed motion: the reference point stands still, the angle is a function of time.
#[derive(Debug, Clone, PartialEq)]
pub struct Prescribed {
    position: [f64; 2],
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
    /// The prescribed motion of `body`, if it has one.
    pub fn of(body: &Body) -> Option<Self> {
        let (position, drive) = match &body.motion {
            Motion::Fixed => return Some(Prescribed { position: [0.0; 2], angle: Angle::Still }),
            Motion::Driven { position, drive, .. } => (*position, drive),
            Motion::Free { .. } => return None,
        };
        let angle = match drive {
            Drive::ConstantSpeed { start_angle, speed } => {
                Angle::Constant { start: *start_angle, speed: *speed }
            }
            Drive::Angle(table) => Angle::Table(PiecewiseCubic::spline(table)),
            Drive::Speed { start_angle, table } => {
                Angle::Integral { start: *start_angle, speed: PiecewiseCubic::monotone(table) }
            }
        };
        Some(Prescribed { position, angle })
    }

    /// Angle and its first three derivatives at time `t` [rad, rad/s, rad/s^2, rad/s^3].
    #[inline]
    pub fn jet(&self, t: f64) -> Jet {
        match &self.angle {
            Angle::Still => [0.0; 4],
            Angle::Constant { start, speed } => [start + speed * t, *speed, 0.0, 0.0],
            Angle::Table(angle) => angle.jet(t),
            Angle::Integral { start, speed } => {
                let [omega, alpha, jerk, _] = speed.jet(t);
                [start + speed.integral(t) - speed.integral(0.0), omega, alpha, jerk]
            }
        }
    }

    /// Angle at time `t` [rad].
    pub fn angle(&self, t: f64) -> f64 {
        self.jet(t)[0]
    }

    /// Its frame at time `t` [s].
    pub fn at(&self, t: f64) -> Frame {
        self.at_angle(&self.jet(t))
    }

    /// Its frame at an angle with its derivatives.
    #[inline]
    pub fn at_angle(&self, jet: &Jet) -> Frame {
        turned(self.position, jet)
    }

    /// Where its reference point stands [m].
    pub fn position(&self) -> [f64; 2] {
        self.position
    }

    /// Whether it is part of the frame.
    pub fn is_still(&self) -> bool {
        self.angle == Angle::Still
    }
}

/// Frame of a body that turns about `position`, at an angle with its derivatives.
#[inline(always)]
pub fn turned<R: Real>(position: [R; 2], jet: &Jet<R>) -> Frame<R> {
    let [angle, omega, ..] = *jet;
    let (sin, cos) = sincos(angle);
    Frame { x: position, angle, cs: [cos, sin], v: [angle.zero(); 2], omega }
}
