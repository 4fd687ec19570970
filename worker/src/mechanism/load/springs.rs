//! Springs and dampers between two frames.
//!
//! # Source
//! Nikravesh (1988), Computer-Aided Analysis of Mechanical Systems.

use super::force::{LoadForce, times};
use crate::lanes::{Real, lanewise};
use crate::mechanism::frame::{End, Frame};
use crate::plane::{cross, dot, left, length};

/// Spring along a fixed direction d: with y = d . (a - b), the force -stiffness (y - free_length) d on a and
/// its opposite on b.
#[derive(Debug, Clone)]
pub struct DirectionalSpring<R = f64> {
    /// Points a and b.
    pub(super) ends: [End<R>; 2],
    /// Unit vector d in global axes `(2,)` [1].
    pub(super) direction: [R; 2],
    /// Stiffness of the spring [N/m].
    pub(super) stiffness: R,
    /// y without force [m].
    pub(super) free_length: R,
}

lanewise!(DirectionalSpring { ends, direction, stiffness, free_length });

impl<R: Real> DirectionalSpring<R> {
    /// The force at time `t` [s].
    #[inline(always)]
    pub(super) fn force(&self, _t: R, frames: &[Frame<R>]) -> LoadForce<R> {
        let DirectionalSpring { ref ends, direction: d, stiffness, free_length } = *self;
        let (fa, fb) = (frames[ends[0].frame], frames[ends[1].frame]);
        let (a, b) = (fa.turn(ends[0].arm), fb.turn(ends[1].arm));
        let y = d[0] * (fa.x[0] + a[0] - fb.x[0] - b[0]) + d[1] * (fa.x[1] + a[1] - fb.x[1] - b[1]);
        // Gradient of y to the six coordinates: the force is -stiffness (y - y0) times it.
        let g = [d[0], d[1], cross(a, d), -d[0], -d[1], -cross(b, d)];
        let pull = -stiffness * (y - free_length);
        let mut load = LoadForce::none([ends[0].frame, ends[1].frame], stiffness);
        load.f = times(&g, pull);
        for r in 0..6 {
            for c in 0..6 {
                load.k[r][c] = -stiffness * g[r] * g[c];
            }
        }
        load.k[2][2] -= pull * dot(a, d);
        load.k[5][5] += pull * dot(b, d);
        load.stored = stiffness * (y - free_length) * (y - free_length) * 0.5;
        load
    }
}

/// Spring and damper along the line between two points: the pull stiffness (l - free_length) + damping dl/dt,
/// l the length of the line. No force where the points coincide, which leaves the line without direction.
#[derive(Debug, Clone)]
pub struct Spring<R = f64> {
    /// The two points.
    pub(super) ends: [End<R>; 2],
    /// Stiffness of the spring [N/m].
    pub(super) stiffness: R,
    /// Damping [N s/m].
    pub(super) damping: R,
    /// Length without force [m].
    pub(super) free_length: R,
}

lanewise!(Spring { ends, stiffness, damping, free_length });

impl<R: Real> Spring<R> {
    /// The force at time `t` [s].
    #[inline(always)]
    pub(super) fn force(&self, _t: R, frames: &[Frame<R>]) -> LoadForce<R> {
        let Spring { ref ends, stiffness, damping, free_length } = *self;
        on_line(ends, frames, |l, rate| {
            let extension = l - free_length;
            let (pull, stored) =
                (stiffness * extension + damping * rate, stiffness * extension * extension * 0.5);
            [pull, stiffness, damping, stored, damping * rate * rate]
        })
    }
}

/// Load of the pull that `law` states of the length of the line between two points [m] and its rate [m/s]: the pull [N], its derivatives to both
/// [N/m, N s/m], the stored energy [J] and the dissipated power [W]. No force where the points coincide,
/// which leaves the line without direction.
#[inline(always)]
pub(super) fn on_line<R: Real>(
    ends: &[End<R>; 2],
    frames: &[Frame<R>],
    law: impl Fn(R, R) -> [R; 5],
) -> LoadForce<R> {
    let (fa, fb) = (frames[ends[0].frame], frames[ends[1].frame]);
    let (a, b) = (fa.turn(ends[0].arm), fb.turn(ends[1].arm));
    let (va, vb) = (fa.velocity(ends[0].arm), fb.velocity(ends[1].arm));
    let e = [fa.x[0] + a[0] - fb.x[0] - b[0], fa.x[1] + a[1] - fb.x[1] - b[1]];
    let w = [va[0] - vb[0], va[1] - vb[1]];
    let l = length(e);
    let mut load = LoadForce::none([ends[0].frame, ends[1].frame], l);
    let (nothing, one) = (l.zero(), l.like(1.0));
    let has_line = nothing.below(l);
    let l = R::select(has_line, l, one);
    let u = [e[0] / l, e[1] / l];
    let rate = dot(u, w);
    let [pull, per_length, per_rate, stored, lost] = law(l, rate);
    let where_line = |x: R| R::select(has_line, x, nothing);
    let (pull, per_length, per_rate) = (where_line(pull), where_line(per_length), where_line(per_rate));
    (load.stored, load.lost) = (where_line(stored), where_line(lost));
    // Gradients of l, and of dl/dt, to the six coordinates; dl/dt has that of l to the six rates.
    let g = [u[0], u[1], cross(a, u), -u[0], -u[1], -cross(b, u)];
    // Derivative of u to e along w, and of the points and their velocities to the angles.
    let across = [(w[0] - rate * u[0]) / l, (w[1] - rate * u[1]) / l];
    let (sa, sb) = (left(a), left(b));
    let to_rate = [
        across[0],
        across[1],
        dot(across, sa) - fa.omega * dot(u, a),
        -across[0],
        -across[1],
        -dot(across, sb) + fb.omega * dot(u, b),
    ];
    load.f = times(&g, -pull);
    for r in 0..6 {
        for c in 0..6 {
            load.k[r][c] = -g[r] * (per_length * g[c] + per_rate * to_rate[c]);
            load.d[r][c] = -(g[r] * per_rate * g[c]);
        }
    }
    turn_line(&mut load.k, pull, u, l, [a, b]);
    load
}

/// Subtracts pull dg/dq from `k`: the gradient g of the length `l` of a line along `u` between points at the
/// ends of the arms `a`, `b` turns with the line and with the arms.
#[inline(always)]
fn turn_line<R: Real>(k: &mut [[R; 6]; 6], pull: R, u: [R; 2], l: R, [a, b]: [[R; 2]; 2]) {
    let (nothing, one) = (l.zero(), l.like(1.0));
    let (sa, sb) = (left(a), left(b));
    let columns = [[one, nothing], [nothing, one], sa, [-one, nothing], [nothing, -one], [-sb[0], -sb[1]]];
    for (c, de) in columns.into_iter().enumerate() {
        let along = dot(u, de);
        let du = [(de[0] - along * u[0]) / l, (de[1] - along * u[1]) / l];
        let mut dg = [du[0], du[1], cross(a, du), -du[0], -du[1], -cross(b, du)];
        if c == 2 {
            dg[2] += cross(sa, u);
        }
        if c == 5 {
            dg[5] -= cross(sb, u);
        }
        for r in 0..6 {
            k[r][c] -= pull * dg[r];
        }
    }
}

/// Torsion spring and damper: with phi = angle_a - angle_b, the torque -stiffness (phi - free_angle) -
/// damping dphi/dt on a and its opposite on b.
#[derive(Debug, Clone)]
pub struct TorsionSpring<R = f64> {
    /// Frames a and b.
    pub(super) frames: [usize; 2],
    /// Stiffness [N m/rad].
    pub(super) stiffness: R,
    /// Damping [N m s/rad].
    pub(super) damping: R,
    /// phi without torque [rad].
    pub(super) free_angle: R,
}

lanewise!(TorsionSpring { frames, stiffness, damping, free_angle });

impl<R: Real> TorsionSpring<R> {
    /// The force at time `t` [s].
    #[inline(always)]
    pub(super) fn force(&self, t: R, frames: &[Frame<R>]) -> LoadForce<R> {
        let TorsionSpring { frames: [a, b], stiffness, damping, free_angle } = *self;
        let mut load = LoadForce::none([a, b], t);
        let off = frames[a].angle - frames[b].angle - free_angle;
        let rate = frames[a].omega - frames[b].omega;
        load.f[2] = -stiffness * off - damping * rate;
        load.f[5] = -load.f[2];
        (load.k[2][2], load.k[2][5]) = (-stiffness, stiffness);
        (load.k[5][2], load.k[5][5]) = (stiffness, -stiffness);
        (load.d[2][2], load.d[2][5]) = (-damping, damping);
        (load.d[5][2], load.d[5][5]) = (damping, -damping);
        load.stored = stiffness * off * off * 0.5;
        load.lost = damping * rate * rate;
        load
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A spring between two moving bodies against central differences of its energy and force.
    #[test]
    fn a_spring_pulls_along_its_line_with_exact_derivatives() {
        let ends = [End { frame: 0, arm: [0.03, 0.02] }, End { frame: 1, arm: [-0.01, 0.05] }];
        let (q, v) = ([0.1, 0.2, 0.7, 0.02, -0.03, 2.0], [1.0, -2.0, 30.0, 0.5, 0.7, -12.0]);
        let load = |q: &[f64; 6], v: &[f64; 6], damping: f64| {
            let frames = [Frame::free(&q[..3], &v[..3]), Frame::free(&q[3..], &v[3..])];
            Spring { ends, stiffness: 300.0, damping, free_length: 0.05 }.force(0.0, &frames)
        };
        let exact = load(&q, &v, 2.0);
        for c in 0..6 {
            let h = 1e-6;
            let shifted = |x: &[f64; 6], h: f64| {
                let mut x = *x;
                x[c] += h;
                x
            };
            let (low, high) = (load(&shifted(&q, -h), &v, 2.0), load(&shifted(&q, h), &v, 2.0));
            let (slow, fast) = (load(&q, &shifted(&v, -h), 2.0), load(&q, &shifted(&v, h), 2.0));
            let elastic = load(&q, &v, 0.0).f[c];
            assert!((elastic + (high.stored - low.stored) / (2.0 * h)).abs() < 1e-6, "force {c}");
            for r in 0..6 {
                let (k, d) = ((high.f[r] - low.f[r]) / (2.0 * h), (fast.f[r] - slow.f[r]) / (2.0 * h));
                assert!((exact.k[r][c] - k).abs() < 1e-4, "k {r} {c}: {} against {k}", exact.k[r][c]);
                assert!((exact.d[r][c] - d).abs() < 1e-6, "d {r} {c}: {} against {d}", exact.d[r][c]);
            }
        }
        let power: f64 = exact.f.iter().zip(&v).map(|(f, v)| f * v).sum();
        let step = 1e-6;
        let moved = |t: f64| load(&std::array::from_fn(|k| q[k] + t * v[k]), &v, 2.0).stored;
        let stored = (moved(step) - moved(-step)) / (2.0 * step);
        assert!((power + stored + exact.lost).abs() < 1e-4, "{power} against {stored} and {}", exact.lost);
    }
}
