//! Position and velocity analysis with every joint closed, as if it had no clearance: where the mechanism
//! starts, whether it can go round, and its motion in the limit of vanishing clearance.
//!
//! Closure phi(q, t) = r_journal - r_bushing = 0 for every joint; Newton's method with the least-norm step, so
//! that mechanisms with more freedom than closures keep what their start gives them. Velocities solve
//! (dphi/dq) qd = -dphi/dt.

use super::frame::Frame;
use super::prescribed::Prescribed;
use common::failure::SimulationFailure;
use common::scene::{Motion, Scene};
use nalgebra::{DMatrix, DVector};

/// Positions and velocities of all bodies at one time: coordinates of the centre of mass and angle for free
/// bodies; nothing for the others.
#[derive(Debug, Clone, PartialEq)]
pub struct Pose {
    /// Time [s].
    pub time: f64,
    /// Per body of the scene: (x, y, angle) of a free body.
    pub q: Vec<Option<[f64; 3]>>,
    /// Their rates.
    pub v: Vec<Option<[f64; 3]>>,
}

/// Gap below which a joint counts as closed, relative to the mechanism's size.
const CLOSED: f64 = 1e-12;
const MOST_ITERATIONS: usize = 50;
/// Angles of a cycle at which closure is checked.
const CHECKED: usize = 180;

struct Closure<'a> {
    scene: &'a Scene,
    prescribed: Vec<Option<Prescribed>>,
    /// First coordinate of each free body.
    first: Vec<Option<usize>>,
    centre: Vec<[f64; 2]>,
    n: usize,
    size: f64,
}

impl<'a> Closure<'a> {
    fn new(scene: &'a Scene) -> Self {
        let mut n = 0;
        let mut first = Vec::new();
        let mut centre = Vec::new();
        for body in &scene.bodies {
            if let Motion::Free { centre_of_mass, .. } = body.motion {
                first.push(Some(n));
                centre.push(centre_of_mass);
                n += 3;
            } else {
                first.push(None);
                centre.push([0.0; 2]);
            }
        }
        let points = scene.joints.iter().flat_map(|j| [j.journal.position, j.bushing.position]);
        let size = points.flatten().fold(1e-6_f64, |a, b| a.max(b.abs()));
        Closure {
            scene,
            prescribed: scene.bodies.iter().map(Prescribed::of).collect(),
            first,
            centre,
            n,
            size,
        }
    }

    fn start(&self) -> DVector<f64> {
        let mut q = DVector::zeros(self.n);
        for (body, first) in self.scene.bodies.iter().zip(&self.first) {
            if let (Motion::Free { centre_of_mass, start_position, start_angle, .. }, Some(k)) =
                (&body.motion, *first)
            {
                let frame = Frame::free(&[start_position[0], start_position[1], *start_angle], &[0.0; 3]);
                let x = frame.point(*centre_of_mass);
                q[k] = x[0];
                q[k + 1] = x[1];
                q[k + 2] = *start_angle;
            }
        }
        q
    }

    fn frame(&self, body: usize, t: f64, q: &DVector<f64>) -> Frame {
        match (self.first[body], &self.prescribed[body]) {
            (Some(k), _) => Frame::free(&[q[k], q[k + 1], q[k + 2]], &[0.0; 3]),
            (None, Some(p)) => p.at(t),
            (None, None) => Frame::default(),
        }
    }

    /// Gaps, their derivative to q and to t.
    fn evaluate(&self, t: f64, q: &DVector<f64>) -> (DVector<f64>, DMatrix<f64>, DVector<f64>) {
        let m = 2 * self.scene.joints.len();
        let mut phi = DVector::zeros(m);
        let mut jacobian = DMatrix::zeros(m, self.n);
        let mut rate = DVector::zeros(m);
        for (row, joint) in self.scene.joints.iter().enumerate() {
            for (sign, side) in [(1.0, &joint.journal), (-1.0, &joint.bushing)] {
                let frame = self.frame(side.body, t, q);
                let c = self.centre[side.body];
                let arm = frame.turn([side.position[0] - c[0], side.position[1] - c[1]]);
                let turned = [-arm[1], arm[0]];
                for k in 0..2 {
                    phi[2 * row + k] += sign * (frame.x[k] + arm[k]);
                    if let Some(first) = self.first[side.body] {
                        jacobian[(2 * row + k, first + k)] += sign;
                        jacobian[(2 * row + k, first + 2)] += sign * turned[k];
                    } else {
                        rate[2 * row + k] += sign * frame.omega * turned[k];
                    }
                }
            }
        }
        (phi, jacobian, rate)
    }

    fn close(&self, t: f64, q: &mut DVector<f64>, iterations: &mut u64) -> Result<(), SimulationFailure> {
        let mut worst = (f64::INFINITY, 0);
        for _ in 0..MOST_ITERATIONS {
            let (phi, jacobian, _) = self.evaluate(t, q);
            worst = (0..self.scene.joints.len())
                .map(|j| (libm::hypot(phi[2 * j], phi[2 * j + 1]), j))
                .fold((0.0, 0), |a, b| if b.0 > a.0 { b } else { a });
            if worst.0 <= CLOSED * self.size {
                return Ok(());
            }
            *iterations += 1;
            let step = least_norm(jacobian, &phi);
            // No body moves by more than half the mechanism in one iteration.
            let longest = step
                .iter()
                .enumerate()
                .fold(0.0_f64, |a, (k, s)| a.max(if k % 3 == 2 { s.abs() * self.size } else { s.abs() }));
            *q -= step * (0.5 * self.size / longest).min(1.0);
        }
        Err(SimulationFailure::CannotAssemble {
            joint: self.scene.joints[worst.1].name.clone(),
            time: t,
            gap: worst.0,
        })
    }

    fn velocity(&self, t: f64, q: &DVector<f64>) -> DVector<f64> {
        let (_, jacobian, rate) = self.evaluate(t, q);
        -least_norm(jacobian, &rate)
    }

    fn pose(&self, t: f64, q: &DVector<f64>) -> Pose {
        let v = self.velocity(t, q);
        let split = |x: &DVector<f64>| {
            self.first.iter().map(|first| first.map(|k| [x[k], x[k + 1], x[k + 2]])).collect()
        };
        Pose { time: t, q: split(q), v: split(&v) }
    }
}

/// Least-norm, least-squares solution of `a x = b`.
fn least_norm(a: DMatrix<f64>, b: &DVector<f64>) -> DVector<f64> {
    let columns = a.ncols();
    let svd = a.svd(true, true);
    let cut = 1e-10 * svd.singular_values.max();
    svd.solve(b, cut).unwrap_or_else(|_| DVector::zeros(columns))
}

/// The mechanism with ideal joints at `samples` equal times of one cycle, ends included: its motion in the
/// limit of vanishing clearance, followed by continuation from the approximate start of the scene. Adds the
/// Newton iterations to `iterations`.
///
/// # Errors
/// [`SimulationFailure::CannotAssemble`] with joint and time where the linkage locks.
pub fn ideal_cycle(
    scene: &Scene,
    samples: usize,
    iterations: &mut u64,
) -> Result<Vec<Pose>, SimulationFailure> {
    let closure = Closure::new(scene);
    let mut q = closure.start();
    let intervals = samples.max(2) - 1;
    let refine = CHECKED.div_ceil(intervals);
    let mut poses = Vec::with_capacity(samples);
    for k in 0..=intervals * refine {
        let t = scene.life.period * k as f64 / (intervals * refine) as f64;
        closure.close(t, &mut q, iterations)?;
        if k % refine == 0 {
            poses.push(closure.pose(t, &q));
        }
    }
    Ok(poses)
}
