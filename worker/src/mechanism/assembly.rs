//! Position and velocity analysis with every joint closed, as if it had no clearance: where the mechanism
//! starts, whether it can go round, and its motion in the limit of vanishing clearance.
//!
//! Closure phi(q, t) = r_journal - r_bushing = 0 for every joint; Newton's method with the least-norm step, so
//! that mechanisms with more freedom than closures keep what their start gives them. Velocities solve
//! (dphi/dq) qd = -dphi/dt, accelerations the same once more differentiated.

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
/// Smallest over largest pivot of the closures' derivative below which the ideal motion does not count as
/// determined: accelerations near a dead point are thousands of times those elsewhere.
const DETERMINED: f64 = 1e-4;
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

    /// Accelerations at (q, v): (dphi/dq) qdd = -(what the gaps' second rates are at qdd = 0); none if the
    /// closures leave a freedom, or nearly so.
    fn acceleration(&self, t: f64, q: &DVector<f64>, v: &DVector<f64>) -> Option<DVector<f64>> {
        let (_, mut jacobian, _) = self.evaluate(t, q);
        let mut second = DVector::zeros(jacobian.nrows());
        for (row, joint) in self.scene.joints.iter().enumerate() {
            for (sign, side) in [(1.0, &joint.journal), (-1.0, &joint.bushing)] {
                let frame = self.frame(side.body, t, q);
                let c = self.centre[side.body];
                let arm = frame.turn([side.position[0] - c[0], side.position[1] - c[1]]);
                // Of an arm that turns: towards the axis, and across from a given angular acceleration.
                let (omega, alpha) = match (self.first[side.body], &self.prescribed[side.body]) {
                    (Some(k), _) => (v[k + 2], 0.0),
                    (None, Some(p)) => {
                        let [_, omega, alpha, _] = p.jet(t);
                        (omega, alpha)
                    }
                    (None, None) => (0.0, 0.0),
                };
                second[2 * row] += sign * (-omega * omega * arm[0] - alpha * arm[1]);
                second[2 * row + 1] += sign * (-omega * omega * arm[1] + alpha * arm[0]);
            }
        }
        // Angles count by the mechanism's size, so that one bound fits all columns.
        for mut column in jacobian.column_iter_mut().skip(2).step_by(3) {
            column /= self.size;
        }
        if jacobian.ncols() == 0 || jacobian.nrows() < jacobian.ncols() {
            return None;
        }
        let qr = jacobian.qr();
        let r = qr.r();
        let (least, most) = r
            .diagonal()
            .iter()
            .fold((f64::INFINITY, 0.0_f64), |(least, most), d| (least.min(d.abs()), most.max(d.abs())));
        if least < DETERMINED * most {
            return None;
        }
        let mut a = -r.solve_upper_triangular(&(qr.q().transpose() * second))?;
        a.iter_mut().skip(2).step_by(3).for_each(|a| *a /= self.size);
        Some(a)
    }

    fn pose(&self, t: f64, q: &DVector<f64>) -> Pose {
        let v = self.velocity(t, q);
        let split = |x: &DVector<f64>| {
            self.first.iter().map(|first| first.map(|k| [x[k], x[k + 1], x[k + 2]])).collect()
        };
        Pose { time: t, q: split(q), v: split(&v) }
    }
}

/// Least-norm, least-squares solution of `a x = b`, refined once: the decomposition alone was seen to leave
/// 1e-6 of the solution in the residual.
fn least_norm(a: DMatrix<f64>, b: &DVector<f64>) -> DVector<f64> {
    let columns = a.ncols();
    let svd = a.clone().svd(true, true);
    let cut = 1e-10 * svd.singular_values.max();
    let solve = |b: &DVector<f64>| svd.solve(b, cut).unwrap_or_else(|_| DVector::zeros(columns));
    let x = solve(b);
    let missing = b - &a * &x;
    x + solve(&missing)
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

/// Accelerations of the ideal mechanism in these poses, per body of the scene as in [`Pose`] [m/s^2, rad/s^2];
/// none if the joints and drives leave the motion a freedom in one of them.
pub fn ideal_accelerations(scene: &Scene, poses: &[Pose]) -> Option<Vec<Vec<Option<[f64; 3]>>>> {
    let closure = Closure::new(scene);
    let flat =
        |x: &[Option<[f64; 3]>]| DVector::from_iterator(closure.n, x.iter().flatten().flatten().copied());
    poses
        .iter()
        .map(|pose| {
            let a = closure.acceleration(pose.time, &flat(&pose.q), &flat(&pose.v))?;
            Some(closure.first.iter().map(|first| first.map(|k| [a[k], a[k + 1], a[k + 2]])).collect())
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::scene::{Drive, SceneSource, Table};

    /// Largest difference between the accelerations and the central differences of the velocities, relative to
    /// the largest acceleration of the same kind, over a cycle.
    fn worst(scene: &Scene) -> f64 {
        const SAMPLES: usize = 4001;
        let poses = ideal_cycle(scene, SAMPLES, &mut 0).expect("the linkage closes");
        let a = ideal_accelerations(scene, &poses).expect("the motion is determined");
        let h = scene.life.period / (SAMPLES - 1) as f64;
        let (mut off, mut largest) = ([0.0_f64; 2], [0.0_f64; 2]);
        for k in 1..SAMPLES - 1 {
            for (body, a) in a[k].iter().enumerate() {
                let (Some(a), Some(low), Some(high)) = (a, poses[k - 1].v[body], poses[k + 1].v[body]) else {
                    continue;
                };
                for c in 0..3 {
                    let difference = (high[c] - low[c]) / (2.0 * h);
                    off[c / 2] = off[c / 2].max((a[c] - difference).abs());
                    largest[c / 2] = largest[c / 2].max(a[c].abs());
                }
            }
        }
        (off[0] / largest[0]).max(off[1] / largest[1])
    }

    #[test]
    fn accelerations_are_the_rates_of_the_velocities() {
        // Central differences at 4000 points a cycle miss (2 pi k / 4000)^2 / 6 of the k-th harmonic: 1e-5 of
        // the fifth.
        for name in ["four-bar", "flapping-wing"] {
            let mut scene = SceneSource::builtin(name).expect("built in").nominal().clone();
            let off = worst(&scene);
            assert!(off < 2e-5, "{name}: {off}");
            // An uneven drive: a full turn with a second harmonic in it, spline of 64 intervals.
            let tau = std::f64::consts::TAU;
            let at: Vec<f64> = (0..=64).map(|k| scene.life.period * f64::from(k) / 64.0).collect();
            let value = (0..=64)
                .map(|k| f64::from(k) / 64.0)
                .map(|s| tau * s + 0.1 * (2.0 * tau * s).sin())
                .collect();
            for body in &mut scene.bodies {
                if let Motion::Driven { drive, .. } = &mut body.motion {
                    *drive = Drive::Angle(Table { at: at.clone(), value, repeat: true });
                    break;
                }
            }
            let off = worst(&scene);
            assert!(off < 2e-4, "{name}, uneven: {off}");
        }
    }

    #[test]
    fn a_freedom_is_no_motion_to_follow() {
        let mut scene = SceneSource::builtin("four-bar").expect("built in").nominal().clone();
        let poses = ideal_cycle(&scene, 3, &mut 0).expect("the linkage closes");
        scene.joints.pop();
        assert_eq!(ideal_accelerations(&scene, &poses), None);
    }
}
