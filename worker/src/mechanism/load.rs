//! Loads of an island: generalised forces on two of its frames, with derivatives.

use super::frame::{End, Frame};
use super::table::PiecewiseCubic;
use common::scene::{Load, Over};

/// The other end of a load that acts on one body only.
pub const NOBODY: usize = usize::MAX;

/// A load with its places resolved.
#[derive(Debug, Clone)]
pub enum IslandLoad {
    /// See [`Load::DirectionalSpring`].
    DirectionalSpring { ends: [End; 2], direction: [f64; 2], stiffness: f64, free_length: f64 },
    /// See [`Load::Spring`].
    Spring { ends: [End; 2], stiffness: f64, damping: f64, free_length: f64 },
    /// See [`Load::TorsionSpring`].
    TorsionSpring { frames: [usize; 2], stiffness: f64, damping: f64, free_angle: f64 },
    /// A force of varying size along a fixed direction.
    Force { end: End, direction: [f64; 2], size: Size },
    /// A varying torque.
    Torque { frame: usize, size: Size },
    /// See [`Load::Motor`].
    Motor { frame: usize, stall_torque: f64, no_load_speed: f64 },
}

/// Size of a load.
#[derive(Debug, Clone)]
pub enum Size {
    /// Always the same.
    Constant(f64),
    /// By a table over time.
    OverTime(PiecewiseCubic),
    /// By a table over the angle of a frame.
    OverAngle(PiecewiseCubic, usize),
}

/// What a load does at one instant to the two frames of `ends`, each (x, y, angle).
#[derive(Debug, Clone, Copy)]
pub struct LoadForce {
    /// The frames; [`NOBODY`] if there is only one.
    pub frames: [usize; 2],
    /// Generalised force `(6,)`.
    pub f: [f64; 6],
    /// Derivative to the coordinates `(6, 6)`.
    pub k: [[f64; 6]; 6],
    /// Derivative to their rates `(6, 6)`.
    pub d: [[f64; 6]; 6],
    /// Derivative to time `(6,)`.
    pub ft: [f64; 6],
    /// Derivative to the angle of another frame, and which.
    pub third: Option<(usize, [f64; 6])>,
    /// Energy stored in it [J].
    pub stored: f64,
    /// Power it loses [W].
    pub lost: f64,
}

impl LoadForce {
    fn on(frames: [usize; 2]) -> Self {
        LoadForce {
            frames,
            f: [0.0; 6],
            k: [[0.0; 6]; 6],
            d: [[0.0; 6]; 6],
            ft: [0.0; 6],
            third: None,
            stored: 0.0,
            lost: 0.0,
        }
    }
}

impl Size {
    /// Of a table over time or over the angle of a body, whose frame `frame` finds.
    pub fn of(curve: &common::scene::Curve, mut frame: impl FnMut(usize) -> usize) -> Self {
        let table = PiecewiseCubic::monotone(&curve.table);
        match curve.over {
            Over::Time => Size::OverTime(table),
            Over::Angle(body) => Size::OverAngle(table, frame(body)),
        }
    }

    /// Size, its derivative to time, and that to the angle of a frame.
    fn at(&self, t: f64, frames: &[Frame]) -> (f64, f64, Option<(usize, f64)>) {
        match self {
            Size::Constant(size) => (*size, 0.0, None),
            Size::OverTime(table) => {
                let [size, rate, ..] = table.jet(t);
                (size, rate, None)
            }
            Size::OverAngle(table, frame) => {
                let [size, slope, ..] = table.jet(frames[*frame].angle);
                (size, 0.0, Some((*frame, slope)))
            }
        }
    }
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

impl IslandLoad {
    /// The force at time `t` [s].
    pub fn force(&self, t: f64, frames: &[Frame]) -> LoadForce {
        match self {
            IslandLoad::DirectionalSpring { ends, direction, stiffness, free_length } => {
                directional_spring(ends, frames, *direction, *stiffness, *free_length)
            }
            IslandLoad::Spring { ends, stiffness, damping, free_length } => {
                spring(ends, frames, *stiffness, *damping, *free_length)
            }
            IslandLoad::TorsionSpring { frames: [a, b], stiffness, damping, free_angle } => {
                let mut load = LoadForce::on([*a, *b]);
                let off = frames[*a].angle - frames[*b].angle - free_angle;
                let rate = frames[*a].omega - frames[*b].omega;
                load.f[2] = -stiffness * off - damping * rate;
                load.f[5] = -load.f[2];
                for (r, sign) in [(2, -1.0), (5, 1.0)] {
                    (load.k[r][2], load.k[r][5]) = (sign * stiffness, -sign * stiffness);
                    (load.d[r][2], load.d[r][5]) = (sign * damping, -sign * damping);
                }
                load.stored = 0.5 * stiffness * off * off;
                load.lost = damping * rate * rate;
                load
            }
            IslandLoad::Force { end, direction, size } => {
                let mut load = LoadForce::on([end.frame, NOBODY]);
                let (size, rate, slope) = size.at(t, frames);
                let arm = frames[end.frame].turn(end.arm);
                let along = [direction[0], direction[1], cross(arm, *direction), 0.0, 0.0, 0.0];
                load.f = along.map(|x| size * x);
                load.ft = along.map(|x| rate * x);
                load.third = slope.map(|(frame, slope)| (frame, along.map(|x| slope * x)));
                load.k[2][2] = -size * dot(arm, *direction);
                load
            }
            IslandLoad::Torque { frame, size } => {
                let mut load = LoadForce::on([*frame, NOBODY]);
                let (size, rate, slope) = size.at(t, frames);
                (load.f[2], load.ft[2]) = (size, rate);
                load.third = slope.map(|(frame, slope)| (frame, [0.0, 0.0, slope, 0.0, 0.0, 0.0]));
                load
            }
            IslandLoad::Motor { frame, stall_torque, no_load_speed } => {
                let mut load = LoadForce::on([*frame, NOBODY]);
                load.f[2] = stall_torque * (1.0 - frames[*frame].omega / no_load_speed);
                load.d[2][2] = -stall_torque / no_load_speed;
                load
            }
        }
    }

    /// Whether its work is counted as input: it has neither a potential nor a damper.
    pub fn drives(&self) -> bool {
        matches!(self, Self::Force { .. } | Self::Torque { .. } | Self::Motor { .. })
    }
}

/// With y = direction . (a - b): -stiffness (y - free_length) along the direction.
fn directional_spring(
    ends: &[End; 2],
    frames: &[Frame],
    d: [f64; 2],
    stiffness: f64,
    free_length: f64,
) -> LoadForce {
    let [fa, fb] = [0, 1].map(|k| frames[ends[k].frame]);
    let (a, b) = (fa.turn(ends[0].arm), fb.turn(ends[1].arm));
    let y = d[0] * (fa.x[0] + a[0] - fb.x[0] - b[0]) + d[1] * (fa.x[1] + a[1] - fb.x[1] - b[1]);
    // Gradient of y to the six coordinates: the force is -stiffness (y - y0) times it.
    let g = [d[0], d[1], cross(a, d), -d[0], -d[1], -cross(b, d)];
    let pull = -stiffness * (y - free_length);
    let mut load = LoadForce::on([ends[0].frame, ends[1].frame]);
    load.f = g.map(|g| pull * g);
    for r in 0..6 {
        for c in 0..6 {
            load.k[r][c] = -stiffness * g[r] * g[c];
        }
    }
    load.k[2][2] -= pull * dot(a, d);
    load.k[5][5] += pull * dot(b, d);
    load.stored = 0.5 * stiffness * (y - free_length) * (y - free_length);
    load
}

/// Pull stiffness (l - free_length) + damping dl/dt along the line between two points; nothing where they
/// coincide, which leaves the line without direction.
fn spring(ends: &[End; 2], frames: &[Frame], stiffness: f64, damping: f64, free_length: f64) -> LoadForce {
    let [fa, fb] = [0, 1].map(|k| frames[ends[k].frame]);
    let (a, b) = (fa.turn(ends[0].arm), fb.turn(ends[1].arm));
    let (va, vb) = (fa.velocity(ends[0].arm), fb.velocity(ends[1].arm));
    let e = [0, 1].map(|k| fa.x[k] + a[k] - fb.x[k] - b[k]);
    let w = [0, 1].map(|k| va[k] - vb[k]);
    let mut load = LoadForce::on([ends[0].frame, ends[1].frame]);
    let length = (e[0] * e[0] + e[1] * e[1]).sqrt();
    if length <= 0.0 {
        return load;
    }
    let u = e.map(|x| x / length);
    let rate = dot(u, w);
    let pull = stiffness * (length - free_length) + damping * rate;
    load.stored = 0.5 * stiffness * (length - free_length) * (length - free_length);
    load.lost = damping * rate * rate;
    // Gradients of l, and of dl/dt, to the six coordinates; dl/dt has that of l to the six rates.
    let g = [u[0], u[1], cross(a, u), -u[0], -u[1], -cross(b, u)];
    // Derivative of u to e along w, and of the points and their velocities to the angles.
    let across = [0, 1].map(|k| (w[k] - rate * u[k]) / length);
    let (sa, sb) = ([-a[1], a[0]], [-b[1], b[0]]);
    let to_rate = [
        across[0],
        across[1],
        dot(across, sa) - fa.omega * dot(u, a),
        -across[0],
        -across[1],
        -dot(across, sb) + fb.omega * dot(u, b),
    ];
    load.f = g.map(|g| -pull * g);
    for r in 0..6 {
        for c in 0..6 {
            load.k[r][c] = -g[r] * (stiffness * g[c] + damping * to_rate[c]);
            load.d[r][c] = -g[r] * damping * g[c];
        }
    }
    // The gradient g itself turns with e and with the arms.
    let columns = [[1.0, 0.0], [0.0, 1.0], sa, [-1.0, 0.0], [0.0, -1.0], [-sb[0], -sb[1]]];
    for (c, de) in columns.into_iter().enumerate() {
        let along = dot(u, de);
        let du = [0, 1].map(|k| (de[k] - along * u[k]) / length);
        let mut dg = [du[0], du[1], cross(a, du), -du[0], -du[1], -cross(b, du)];
        if c == 2 {
            dg[2] += cross(sa, u);
        }
        if c == 5 {
            dg[5] -= cross(sb, u);
        }
        load.k.iter_mut().zip(dg).for_each(|(row, dg)| row[c] -= pull * dg);
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
