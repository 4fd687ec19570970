//! Forces, torques and motors on one frame.
//!
//! # Source
//! Nikravesh (1988), Computer-Aided Analysis of Mechanical Systems.

use super::force::{LoadForce, NO_FRAME, Size, times};
use crate::lanes::{Real, lanewise};
use crate::mechanism::frame::{End, Frame};
use crate::plane::{cross, dot};

/// Force of a constant or varying size along a fixed direction, at a point of a frame.
#[derive(Debug, Clone)]
pub struct PointForce<R = f64> {
    /// Point on which the force acts.
    pub(super) end: End<R>,
    /// Unit vector in global axes `(2,)` [1].
    pub(super) direction: [R; 2],
    /// Size of the force [N].
    pub(super) size: Size<R>,
}

lanewise!(PointForce { end, direction, size });

impl<R: Real> PointForce<R> {
    /// The force at time `t` [s].
    #[inline(always)]
    pub(super) fn force(&self, t: R, frames: &[Frame<R>]) -> LoadForce<R> {
        let PointForce { end, direction, ref size } = *self;
        let mut load = LoadForce::none([end.frame, NO_FRAME], t);
        let (size, rate, slope) = size.evaluate(t, frames);
        let arm = frames[end.frame].turn(end.arm);
        let nothing = t.zero();
        let along = [direction[0], direction[1], cross(arm, direction), nothing, nothing, nothing];
        load.f = times(&along, size);
        load.ft = times(&along, rate);
        if let Some((frame, slope)) = slope {
            load.third = Some((frame, times(&along, slope)));
        }
        load.k[2][2] = -size * dot(arm, direction);
        load
    }
}

/// Torque of a constant or varying size on a frame.
#[derive(Debug, Clone)]
pub struct BodyTorque<R = f64> {
    /// Index of the frame on which the torque acts.
    pub(super) frame: usize,
    /// Size, counter-clockwise positive [N m].
    pub(super) size: Size<R>,
}

lanewise!(BodyTorque { frame, size });

impl<R: Real> BodyTorque<R> {
    /// The force at time `t` [s].
    #[inline(always)]
    pub(super) fn force(&self, t: R, frames: &[Frame<R>]) -> LoadForce<R> {
        let mut load = LoadForce::none([self.frame, NO_FRAME], t);
        let (size, rate, slope) = self.size.evaluate(t, frames);
        (load.f[2], load.ft[2]) = (size, rate);
        let nothing = t.zero();
        if let Some((frame, slope)) = slope {
            load.third = Some((frame, [nothing, nothing, slope, nothing, nothing, nothing]));
        }
        load
    }
}

/// Motor with a straight characteristic: the torque stall_torque (1 - omega / no_load_speed) on a frame.
#[derive(Debug, Clone)]
pub struct Motor<R = f64> {
    /// Index of the frame that the motor turns.
    pub(super) frame: usize,
    /// Torque at rest [N m].
    pub(super) stall_torque: R,
    /// Angular velocity without torque [rad/s].
    pub(super) no_load_speed: R,
}

lanewise!(Motor { frame, stall_torque, no_load_speed });

impl<R: Real> Motor<R> {
    /// The force at time `t` [s].
    #[inline(always)]
    pub(super) fn force(&self, t: R, frames: &[Frame<R>]) -> LoadForce<R> {
        let mut load = LoadForce::none([self.frame, NO_FRAME], t);
        let per_speed = self.stall_torque / self.no_load_speed;
        load.f[2] = self.stall_torque - per_speed * frames[self.frame].omega;
        load.d[2][2] = -per_speed;
        load
    }
}
