//! Loads of an island: generalised forces on two of its frames, with exact derivatives to coordinates, rates
//! and time.
//!
//! Each load has its equation at its type. Generalised forces `(6,)` are (F_x, F_y, M) [N, N, N m] on the
//! first frame, then on the second.
//!
//! # Source
//! Springs, dampers and actuators as force elements: Nikravesh (1988), Computer-Aided Analysis of Mechanical
//! Systems.

// In lanes, closures of iterators are not compiled for the instruction set of the loop around them.
#![allow(clippy::needless_range_loop)]

use super::frame::{End, Frame};
use super::joint::{Rows, cross, dot};
use super::table::PiecewiseCubic;
use crate::lanes::Real;
use common::scene::{Load, Over};

/// The other end of a load that acts on one body only.
pub const NOBODY: usize = usize::MAX;

/// A load with its places resolved.
#[derive(Debug, Clone)]
pub enum IslandLoad<R = f64> {
    /// See [`Load::DirectionalSpring`].
    DirectionalSpring { ends: [End<R>; 2], direction: [R; 2], stiffness: R, free_length: R },
    /// See [`Load::Spring`].
    Spring { ends: [End<R>; 2], stiffness: R, damping: R, free_length: R },
    /// See [`Load::TorsionSpring`].
    TorsionSpring { frames: [usize; 2], stiffness: R, damping: R, free_angle: R },
    /// A force of varying size along a fixed direction.
    Force { end: End<R>, direction: [R; 2], size: Size<R> },
    /// A varying torque.
    Torque { frame: usize, size: Size<R> },
    /// See [`Load::Motor`].
    Motor { frame: usize, stall_torque: R, no_load_speed: R },
}

/// Size of a load.
#[derive(Debug, Clone)]
pub enum Size<R = f64> {
    /// Always the same.
    Constant(R),
    /// By a table over time, one per lane.
    OverTime(Vec<PiecewiseCubic>),
    /// By a table over the angle of a frame, one per lane.
    OverAngle(Vec<PiecewiseCubic>, usize),
}

/// What a load does at one instant to the two frames of `ends`, each (x, y, angle).
#[derive(Debug, Clone, Copy)]
pub struct LoadForce<R = f64> {
    /// The frames; [`NOBODY`] if there is only one.
    pub frames: [usize; 2],
    /// Generalised force `(6,)`.
    pub f: [R; 6],
    /// Derivative to the coordinates `(6, 6)`.
    pub k: [[R; 6]; 6],
    /// Derivative to their rates `(6, 6)`.
    pub d: [[R; 6]; 6],
    /// Derivative to time `(6,)`.
    pub ft: [R; 6],
    /// Derivative to the angle of another frame, and which.
    pub third: Option<(usize, [R; 6])>,
    /// Energy stored in it [J].
    pub stored: R,
    /// Power it loses [W].
    pub lost: R,
}

impl<R: Real> LoadForce<R> {
    #[inline(always)]
    fn on(frames: [usize; 2], like: R) -> Self {
        let zero = like.zero();
        LoadForce {
            frames,
            f: [zero; 6],
            k: [[zero; 6]; 6],
            d: [[zero; 6]; 6],
            ft: [zero; 6],
            third: None,
            stored: zero,
            lost: zero,
        }
    }
}

impl<R: Real> Rows<R> for LoadForce<R> {
    #[inline(always)]
    fn row(&self, r: usize) -> ([R; 6], [R; 6]) {
        (self.k[r], self.d[r])
    }
}

impl Size {
    /// Of a table over time or over the angle of a body, whose frame `frame` finds.
    pub fn of(curve: &common::scene::Curve, mut frame: impl FnMut(usize) -> usize) -> Self {
        let table = PiecewiseCubic::monotone(&curve.table);
        match curve.over {
            Over::Time => Size::OverTime(vec![table]),
            Over::Angle(body) => Size::OverAngle(vec![table], frame(body)),
        }
    }
}

impl<R: Real> Size<R> {
    /// Size, its derivative to time, and that to the angle of a frame.
    #[inline(always)]
    fn at(&self, t: R, frames: &[Frame<R>]) -> (R, R, Option<(usize, R)>) {
        let read = |tables: &[PiecewiseCubic], x: R| {
            let (mut value, mut slope) = (x, x);
            for (lane, table) in tables.iter().enumerate() {
                let [y, d, ..] = table.jet(x.lane(lane));
                value.set_lane(lane, y);
                slope.set_lane(lane, d);
            }
            (value, slope)
        };
        match self {
            Size::Constant(size) => (*size, t.zero(), None),
            Size::OverTime(tables) => {
                let (size, rate) = read(tables, t);
                (size, rate, None)
            }
            Size::OverAngle(tables, frame) => {
                let (size, slope) = read(tables, frames[*frame].angle);
                (size, t.zero(), Some((*frame, slope)))
            }
        }
    }
}

/// Each number times the same.
#[inline(always)]
fn times<R: Real>(x: &[R; 6], factor: R) -> [R; 6] {
    let mut out = *x;
    for y in &mut out {
        *y = *y * factor;
    }
    out
}

impl<R: Real> IslandLoad<R> {
    /// The force at time `t` [s].
    #[inline(always)]
    pub fn force(&self, t: R, frames: &[Frame<R>]) -> LoadForce<R> {
        match self {
            IslandLoad::DirectionalSpring { ends, direction, stiffness, free_length } => {
                directional_spring(ends, frames, *direction, *stiffness, *free_length)
            }
            IslandLoad::Spring { ends, stiffness, damping, free_length } => {
                spring(ends, frames, *stiffness, *damping, *free_length)
            }
            IslandLoad::TorsionSpring { frames: [a, b], stiffness, damping, free_angle } => {
                let mut load = LoadForce::on([*a, *b], t);
                let (stiffness, damping) = (*stiffness, *damping);
                let off = frames[*a].angle - frames[*b].angle - *free_angle;
                let rate = frames[*a].omega - frames[*b].omega;
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
            IslandLoad::Force { end, direction, size } => {
                let mut load = LoadForce::on([end.frame, NOBODY], t);
                let (size, rate, slope) = size.at(t, frames);
                let arm = frames[end.frame].turn(end.arm);
                let nothing = t.zero();
                let along = [direction[0], direction[1], cross(arm, *direction), nothing, nothing, nothing];
                load.f = times(&along, size);
                load.ft = times(&along, rate);
                if let Some((frame, slope)) = slope {
                    load.third = Some((frame, times(&along, slope)));
                }
                load.k[2][2] = -size * dot(arm, *direction);
                load
            }
            IslandLoad::Torque { frame, size } => {
                let mut load = LoadForce::on([*frame, NOBODY], t);
                let (size, rate, slope) = size.at(t, frames);
                (load.f[2], load.ft[2]) = (size, rate);
                let nothing = t.zero();
                if let Some((frame, slope)) = slope {
                    load.third = Some((frame, [nothing, nothing, slope, nothing, nothing, nothing]));
                }
                load
            }
            IslandLoad::Motor { frame, stall_torque, no_load_speed } => {
                let mut load = LoadForce::on([*frame, NOBODY], t);
                let per_speed = *stall_torque / *no_load_speed;
                load.f[2] = *stall_torque - per_speed * frames[*frame].omega;
                load.d[2][2] = -per_speed;
                load
            }
        }
    }

    /// The frames it makes depend on each other.
    pub fn frames(&self) -> Vec<usize> {
        let over = |size: &Size<R>, frame: usize| match size {
            Size::OverAngle(_, other) => vec![frame, *other],
            _ => vec![frame],
        };
        match self {
            Self::DirectionalSpring { ends, .. } | Self::Spring { ends, .. } => {
                ends.map(|e| e.frame).to_vec()
            }
            Self::TorsionSpring { frames, .. } => frames.to_vec(),
            Self::Force { end, size, .. } => over(size, end.frame),
            Self::Torque { frame, size } => over(size, *frame),
            Self::Motor { frame, .. } => vec![*frame],
        }
    }

    /// Whether its work is counted as input: it has neither a potential nor a damper.
    pub fn drives(&self) -> bool {
        matches!(self, Self::Force { .. } | Self::Torque { .. } | Self::Motor { .. })
    }
}

/// With y = direction . (a - b): -stiffness (y - free_length) along the direction.
#[inline(always)]
fn directional_spring<R: Real>(
    ends: &[End<R>; 2],
    frames: &[Frame<R>],
    d: [R; 2],
    stiffness: R,
    free_length: R,
) -> LoadForce<R> {
    let (fa, fb) = (frames[ends[0].frame], frames[ends[1].frame]);
    let (a, b) = (fa.turn(ends[0].arm), fb.turn(ends[1].arm));
    let y = d[0] * (fa.x[0] + a[0] - fb.x[0] - b[0]) + d[1] * (fa.x[1] + a[1] - fb.x[1] - b[1]);
    // Gradient of y to the six coordinates: the force is -stiffness (y - y0) times it.
    let g = [d[0], d[1], cross(a, d), -d[0], -d[1], -cross(b, d)];
    let pull = -stiffness * (y - free_length);
    let mut load = LoadForce::on([ends[0].frame, ends[1].frame], stiffness);
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

/// Pull stiffness (l - free_length) + damping dl/dt along the line between two points; nothing where they
/// coincide, which leaves the line without direction.
#[inline(always)]
fn spring<R: Real>(
    ends: &[End<R>; 2],
    frames: &[Frame<R>],
    stiffness: R,
    damping: R,
    free_length: R,
) -> LoadForce<R> {
    let (fa, fb) = (frames[ends[0].frame], frames[ends[1].frame]);
    let (a, b) = (fa.turn(ends[0].arm), fb.turn(ends[1].arm));
    let (va, vb) = (fa.velocity(ends[0].arm), fb.velocity(ends[1].arm));
    let e = [fa.x[0] + a[0] - fb.x[0] - b[0], fa.x[1] + a[1] - fb.x[1] - b[1]];
    let w = [va[0] - vb[0], va[1] - vb[1]];
    let mut load = LoadForce::on([ends[0].frame, ends[1].frame], stiffness);
    let length = (e[0] * e[0] + e[1] * e[1]).sqrt();
    let (nothing, one) = (length.zero(), length.like(1.0));
    let has_line = nothing.below(length);
    let length = R::select(has_line, length, one);
    let (stiffness, damping) =
        (R::select(has_line, stiffness, nothing), R::select(has_line, damping, nothing));
    let u = [e[0] / length, e[1] / length];
    let rate = dot(u, w);
    let pull = stiffness * (length - free_length) + damping * rate;
    load.stored = stiffness * (length - free_length) * (length - free_length) * 0.5;
    load.lost = damping * rate * rate;
    // Gradients of l, and of dl/dt, to the six coordinates; dl/dt has that of l to the six rates.
    let g = [u[0], u[1], cross(a, u), -u[0], -u[1], -cross(b, u)];
    // Derivative of u to e along w, and of the points and their velocities to the angles.
    let across = [(w[0] - rate * u[0]) / length, (w[1] - rate * u[1]) / length];
    let (sa, sb) = ([-a[1], a[0]], [-b[1], b[0]]);
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
            load.k[r][c] = -g[r] * (stiffness * g[c] + damping * to_rate[c]);
            load.d[r][c] = -(g[r] * damping * g[c]);
        }
    }
    // The gradient g itself turns with e and with the arms.
    let columns = [[one, nothing], [nothing, one], sa, [-one, nothing], [nothing, -one], [-sb[0], -sb[1]]];
    for (c, de) in columns.into_iter().enumerate() {
        let along = dot(u, de);
        let du = [(de[0] - along * u[0]) / length, (de[1] - along * u[1]) / length];
        let mut dg = [du[0], du[1], cross(a, du), -du[0], -du[1], -cross(b, du)];
        if c == 2 {
            dg[2] += cross(sa, u);
        }
        if c == 5 {
            dg[5] -= cross(sb, u);
        }
        for r in 0..6 {
            load.k[r][c] -= pull * dg[r];
        }
    }
    load
}

/// Bodies that a load makes depend on each other.
pub fn coupled_bodies(load: &Load) -> Vec<usize> {
    let over = |size: &common::scene::Curve, body: usize| match size.over {
        Over::Angle(other) => vec![body, other],
        Over::Time => vec![body],
    };
    match load {
        Load::DirectionalSpring { at: a, anchor: b, .. } | Load::Spring { a, b, .. } => vec![a.body, b.body],
        Load::TorsionSpring { a, b, .. } => vec![*a, *b],
        Load::VariableForce { at, size, .. } => over(size, at.body),
        Load::VariableTorque { body, torque, .. } => over(torque, *body),
        Load::ConstantForce { at, .. } => vec![at.body],
        Load::ConstantTorque { body, .. } | Load::Motor { body, .. } => vec![*body],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A spring between two moving bodies against central differences of its own energy and force.
    #[test]
    fn a_spring_pulls_along_its_line_with_exact_derivatives() {
        let ends = [End { frame: 0, arm: [0.03, 0.02] }, End { frame: 1, arm: [-0.01, 0.05] }];
        let (q, v) = ([0.1, 0.2, 0.7, 0.02, -0.03, 2.0], [1.0, -2.0, 30.0, 0.5, 0.7, -12.0]);
        let load = |q: &[f64; 6], v: &[f64; 6], damping: f64| {
            let frames = [Frame::free(&q[..3], &v[..3]), Frame::free(&q[3..], &v[3..])];
            spring(&ends, &frames, 300.0, damping, 0.05)
        };
        let at = load(&q, &v, 2.0);
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
                assert!((at.k[r][c] - k).abs() < 1e-4, "k {r} {c}: {} against {k}", at.k[r][c]);
                assert!((at.d[r][c] - d).abs() < 1e-6, "d {r} {c}: {} against {d}", at.d[r][c]);
            }
        }
        let power: f64 = at.f.iter().zip(&v).map(|(f, v)| f * v).sum();
        let step = 1e-6;
        let moved = |t: f64| load(&std::array::from_fn(|k| q[k] + t * v[k]), &v, 2.0).stored;
        let stored = (moved(step) - moved(-step)) / (2.0 * step);
        assert!((power + stored + at.lost).abs() < 1e-4, "{power} against {stored} and {}", at.lost);
    }
}
