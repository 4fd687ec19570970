//! Values and derivatives of the constraints against differences.

use crate::mechanism::constraint::*;
use crate::mechanism::coupling::JointInput;
use crate::mechanism::frame::{End, Frame};
use common::scene::{Drive, JointKind, Mesh, MeshForm, Table};

const Q: [f64; 6] = [0.11, -0.02, 0.7, 0.03, 0.05, -0.4];
const V: [f64; 6] = [1.3, -0.6, 9.0, 0.4, 2.1, -7.0];
const A: [f64; 6] = [30.0, -70.0, 400.0, 10.0, 55.0, -250.0];
const LAMBDA: [f64; 3] = [3.0, -2.0, 0.7];

/// Time of the state [s].
const T: f64 = 0.013;

/// A joint with what it is given.
struct Given(Constraint, Option<JointInput>);

impl Given {
    /// The joint at time `t` [s] with its second body in this frame.
    fn at(&self, t: f64, second: &Frame) -> Constraint {
        let mut c = self.0;
        if let Some(input) = &self.1 {
            c.input = input.jet(t, second.angle);
        }
        c
    }
}

fn kinds() -> Vec<Given> {
    let ends = [End { frame: 0, arm: [0.02, -0.013] }, End { frame: 1, arm: [-0.03, 0.008] }];
    let joint = |kind: JointKind| Given(Constraint::new(0, ends, &kind), JointInput::new(&kind));
    let table = |at: [f64; 4]| Table { at: at.into(), value: vec![0.1, 0.13, 0.11, 0.1], repeat: true };
    let mesh = Mesh {
        form: MeshForm::Gear,
        radii: [0.03, 0.05],
        pressure_angle: 0.35,
        direction: [0.6, 0.8],
        arms: [0.028, 0.047],
        value: 0.02,
        gap: 0.0,
    };
    vec![
        joint(JointKind::Revolute),
        joint(JointKind::Prismatic { axis: 0.3, angle: 0.9 }),
        joint(JointKind::Fixed { angle: -0.2 }),
        joint(JointKind::Slot { axis: 0.3 }),
        joint(JointKind::LinearDrive(Drive::Angle(table([0.0, 0.02, 0.05, 0.08])))),
        joint(JointKind::Mesh(mesh)),
        joint(JointKind::Cam { direction: [0.6, -0.8], lift: table([-3.0, -1.0, 1.0, 3.0]) }),
    ]
}

fn frames(q: &[f64; 6], v: &[f64; 6]) -> (Frame, Frame) {
    (Frame::free(&q[..3], &v[..3]), Frame::free(&q[3..], &v[3..]))
}

fn moved(x: &[f64; 6], k: usize, by: f64) -> [f64; 6] {
    let mut x = *x;
    x[k] += by;
    x
}

/// Central difference of a vector function along coordinate `k` of `x`.
fn difference<const N: usize>(x: &[f64; 6], k: usize, h: f64, f: impl Fn(&[f64; 6]) -> [f64; N]) -> [f64; N] {
    let (low, high) = (f(&moved(x, k, -h)), f(&moved(x, k, h)));
    std::array::from_fn(|r| (high[r] - low[r]) / (2.0 * h))
}

fn close(exact: f64, found: f64, scale: f64) {
    assert!((exact - found).abs() < 1e-6 * scale.max(1.0), "{exact} against {found}");
}

#[test]
fn jacobian_agrees_with_differences() {
    for c in kinds() {
        let (i, j) = frames(&Q, &V);
        let given = c;
        let c = given.at(T, &j);
        let (_, g) = c.position(&i, &j);
        for k in 0..6 {
            let found = difference(&Q, k, 1e-6, |q| {
                let (i, j) = frames(q, &V);
                given.at(T, &j).position(&i, &j).0
            });
            for (row, found) in g.iter().zip(&found[..c.rows()]) {
                close(row[k], *found, 1.0);
            }
        }
    }
}

/// G a + h is the second derivative of phi along the motion q + t v + t^2 a / 2.
#[test]
fn acceleration_form_is_the_second_derivative() {
    for c in kinds() {
        let (i, j) = frames(&Q, &V);
        let given = c;
        let c = given.at(T, &j);
        let (_, g) = c.position(&i, &j);
        let h = c.centripetal(&i, &j);
        let phi = |t: f64| {
            let q: [f64; 6] = std::array::from_fn(|k| Q[k] + t * V[k] + 0.5 * t * t * A[k]);
            let (i, j) = frames(&q, &V);
            given.at(T + t, &j).position(&i, &j).0
        };
        let step = 2e-5;
        let (low, mid, high) = (phi(-step), phi(0.0), phi(step));
        for r in 0..c.rows() {
            let exact = h[r] + (0..6).map(|k| g[r][k] * A[k]).sum::<f64>();
            let found = (high[r] - 2.0 * mid[r] + low[r]) / (step * step);
            assert!((exact - found).abs() < 1e-4 * exact.abs().max(10.0), "{exact} against {found}");
        }
    }
}

#[test]
fn derivatives_of_the_acceleration_form_and_of_the_reaction_agree_with_differences() {
    for c in kinds() {
        let (i, j) = frames(&Q, &V);
        let given = c;
        let c = given.at(T, &j);
        let (to_q, to_v) = c.acceleration_derivatives(&i, &j, &A);
        let reaction = c.reaction_derivative(&i, &j, &LAMBDA);
        let acceleration_at = |t: f64, q: &[f64; 6], v: &[f64; 6]| {
            let (i, j) = frames(q, v);
            let c = given.at(t, &j);
            let (_, g) = c.position(&i, &j);
            let h = c.centripetal(&i, &j);
            let row = |r: usize| h[r] + (0..6).map(|k| g[r][k] * A[k]).sum::<f64>();
            [row(0), row(1), row(2)]
        };
        let acceleration = |q: &[f64; 6], v: &[f64; 6]| acceleration_at(T, q, v);
        if let Some([rate, of_acceleration]) = c.over_time() {
            let h = 1e-7;
            let phi = |t: f64| given.at(t, &j).position(&i, &j).0[0];
            close(rate, (phi(T + h) - phi(T - h)) / (2.0 * h), 1.0);
            let [low, high] = [T - h, T + h].map(|t| acceleration_at(t, &Q, &V)[0]);
            close(of_acceleration, (high - low) / (2.0 * h), 1e3);
        }
        let force = |q: &[f64; 6]| {
            let (i, j) = frames(q, &V);
            let c = given.at(T, &j);
            let (_, g) = c.position(&i, &j);
            let column = |k: usize| (0..c.rows()).map(|r| g[r][k] * LAMBDA[r]).sum::<f64>();
            std::array::from_fn::<f64, 6, _>(column)
        };
        for k in 0..6 {
            let along_q = difference(&Q, k, 1e-6, |q| acceleration(q, &V));
            let along_v = difference(&V, k, 1e-6, |v| acceleration(&Q, v));
            for r in 0..c.rows() {
                close(to_q[r][k], along_q[r], 1e3);
                close(to_v[r][k], along_v[r], 10.0);
            }
            let along = difference(&Q, k, 1e-6, force);
            for r in 0..6 {
                close(reaction[r][k], along[r], 1.0);
            }
        }
    }
}
