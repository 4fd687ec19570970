//! Loads on one frame: forces, torques and motors, and the drag of a medium on a point or on a turning body.
//!
//! # Source
//! Nikravesh (1988), Computer-Aided Analysis of Mechanical Systems.
//!
//! # Drag
//! Linear and quadratic in the speed.
//!
//! With the speed u of the point along a fixed direction d, less the speed w of the medium along it, u = d . v - w [m/s], and the factor
//! k(t or angle) [1], the force is
//!
//!   F = -k (b + c |u|) u d,
//!
//! b [N s/m], c [N s^2/m^2]; of a turning body likewise M = -k (b + c |omega|) omega. The force has a continuous first derivative,
//! k (b + 2 c |u|), also where u changes its sign. It dissipates -F . d u >= 0; the rest of its power, F . d w, is done by the medium.
//! Valid for a quasi-steady flow, without added mass; c = rho C_D A / 2 of an area A [m^2] in a medium of density rho [kg/m^3].
//!
//! Source:
//! Batchelor (1967), An Introduction to Fluid Dynamics, section 5.11.

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
        let n = t.zero();
        if let Some((frame, slope)) = slope {
            load.third = Some((frame, [n, n, slope, n, n, n]));
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

/// Drag on a point of a frame along a fixed direction.
#[derive(Debug, Clone)]
pub struct Drag<R = f64> {
    /// Point on which the force acts.
    pub(super) end: End<R>,
    /// Unit vector d in global axes `(2,)` [1].
    pub(super) direction: [R; 2],
    /// Force per speed b [N s/m].
    pub(super) linear: R,
    /// Force per square of the speed c [N s^2/m^2].
    pub(super) quadratic: R,
    /// Speed of the medium along d, w [m/s].
    pub(super) flow: R,
    /// Factor k [1].
    pub(super) factor: Size<R>,
}

lanewise!(Drag { end, direction, linear, quadratic, flow, factor });

/// -(b + c |u|) u and its derivative to u.
#[inline(always)]
fn resistance<R: Real>(linear: R, quadratic: R, u: R) -> (R, R) {
    let rising = quadratic * u.abs();
    (-(linear + rising) * u, -(linear + rising + rising))
}

impl<R: Real> Drag<R> {
    /// The force at time `t` [s].
    #[inline(always)]
    pub(super) fn force(&self, t: R, frames: &[Frame<R>]) -> LoadForce<R> {
        let Drag { end, direction: d, linear, quadratic, flow, ref factor } = *self;
        let mut load = LoadForce::none([end.frame, NO_FRAME], t);
        let (factor, rate, slope) = factor.evaluate(t, frames);
        let frame = &frames[end.frame];
        let arm = frame.turn(end.arm);
        let u = dot(d, frame.velocity(end.arm)) - flow;
        let (force, per_speed) = resistance(linear, quadratic, u);
        let nothing = t.zero();
        // Gradient of u to the rates; the moment turns with the arm, and u with it.
        let along = [d[0], d[1], cross(arm, d), nothing, nothing, nothing];
        let turning = -dot(arm, d);
        load.f = times(&along, factor * force);
        load.ft = times(&along, rate * force);
        if let Some((frame, slope)) = slope {
            load.third = Some((frame, times(&along, slope * force)));
        }
        for r in 0..3 {
            for c in 0..3 {
                load.d[r][c] = factor * per_speed * along[r] * along[c];
            }
            load.k[r][2] = factor * per_speed * frame.omega * turning * along[r];
        }
        load.k[2][2] += factor * force * turning;
        load.lost = -(factor * force * u);
        load
    }
}

/// Drag of a turning frame.
#[derive(Debug, Clone)]
pub struct RotationalDrag<R = f64> {
    /// Index of the frame on which the torque acts.
    pub(super) frame: usize,
    /// Torque per angular velocity b [N m s/rad].
    pub(super) linear: R,
    /// Torque per square of the angular velocity c [N m s^2/rad^2].
    pub(super) quadratic: R,
    /// Factor k [1].
    pub(super) factor: Size<R>,
}

lanewise!(RotationalDrag { frame, linear, quadratic, factor });

impl<R: Real> RotationalDrag<R> {
    /// The force at time `t` [s].
    #[inline(always)]
    pub(super) fn force(&self, t: R, frames: &[Frame<R>]) -> LoadForce<R> {
        let RotationalDrag { frame, linear, quadratic, ref factor } = *self;
        let mut load = LoadForce::none([frame, NO_FRAME], t);
        let (factor, rate, slope) = factor.evaluate(t, frames);
        let omega = frames[frame].omega;
        let (torque, per_speed) = resistance(linear, quadratic, omega);
        (load.f[2], load.ft[2], load.d[2][2]) = (factor * torque, rate * torque, factor * per_speed);
        let n = t.zero();
        if let Some((frame, slope)) = slope {
            load.third = Some((frame, [n, n, slope * torque, n, n, n]));
        }
        load.lost = -(factor * torque * omega);
        load
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const Q: [f64; 3] = [0.1, 0.2, 0.7];

    fn drag(v: &[f64; 3], q: &[f64; 3], flow: f64) -> LoadForce {
        let end = End { frame: 0, arm: [0.03, 0.02] };
        let (direction, factor) = ([0.6, 0.8], Size::Constant(1.5));
        Drag { end, direction, linear: 3.0, quadratic: 20.0, flow, factor }.force(0.0, &[Frame::free(q, v)])
    }

    #[test]
    fn derivatives_agree_with_differences_forward_and_backward() {
        for v in [[1.0, -2.0, 30.0], [-1.0, 0.3, -12.0]] {
            let exact = drag(&v, &Q, 0.4);
            for c in 0..3 {
                let h = 1e-6;
                let shifted =
                    |x: &[f64; 3], h: f64| std::array::from_fn(|k| x[k] + if k == c { h } else { 0.0 });
                let (low, high) = (drag(&v, &shifted(&Q, -h), 0.4), drag(&v, &shifted(&Q, h), 0.4));
                let (slow, fast) = (drag(&shifted(&v, -h), &Q, 0.4), drag(&shifted(&v, h), &Q, 0.4));
                for r in 0..3 {
                    let (k, d) = ((high.f[r] - low.f[r]) / (2.0 * h), (fast.f[r] - slow.f[r]) / (2.0 * h));
                    assert!((exact.k[r][c] - k).abs() < 1e-5, "k {r} {c}: {} against {k}", exact.k[r][c]);
                    assert!((exact.d[r][c] - d).abs() < 1e-6, "d {r} {c}: {} against {d}", exact.d[r][c]);
                }
            }
        }
    }

    #[test]
    fn drag_dissipates_its_power_and_a_flow_drives() {
        let v = [1.0, -2.0, 30.0];
        let power = |load: &LoadForce| -> f64 { load.f.iter().zip(&v).map(|(f, v)| f * v).sum() };
        let still = drag(&v, &Q, 0.0);
        assert!((power(&still) + still.lost).abs() < 1e-12 && still.lost > 0.0);
        // In a flow as fast as the point there is no force, in a faster one the medium does work.
        let speed = 0.6 * (v[0] - v[2] * Frame::free(&Q, &v).turn([0.03, 0.02])[1])
            + 0.8 * (v[1] + v[2] * Frame::free(&Q, &v).turn([0.03, 0.02])[0]);
        assert!(drag(&v, &Q, speed).f.iter().all(|f| f.abs() < 1e-12));
        let driven = drag(&v, &Q, 3.0 * speed);
        let force = driven.f[0] / 0.6;
        assert!((power(&driven) + driven.lost - force * 3.0 * speed).abs() < 1e-12 && driven.lost > 0.0);
    }
}
