//! Time integration of M qdd = f(q, qd, t), islands of a few stiff degrees of freedom at a time.

mod advance;
#[cfg(test)]
mod impact_tests;
mod linear;
mod rosenbrock;

pub use advance::{Advance, AdvanceError, AdvanceStats, Watch};
pub use linear::{factor, solve};
pub use rosenbrock::Rosenbrock;

use crate::contact::JointForce;

/// A system M qdd = f(q, qd, t) with a constant diagonal mass matrix.
pub trait Dynamics {
    /// Diagonal of M `(n,)` [kg, kg m^2].
    fn mass(&self) -> &[f64];
    /// f `(n,)` at time `t` [s]; not a number where it does not exist.
    fn force(&mut self, t: f64, q: &[f64], v: &[f64], f: &mut [f64]);
    /// f with its derivatives.
    fn linearise(&mut self, t: f64, q: &[f64], v: &[f64], at: &mut Linearised);
    /// Whether [`Dynamics::close`] has anything to do.
    fn is_constrained(&self) -> bool {
        false
    }
    /// Moves positions and velocities back onto the constraints of ideal joints; returns how far the joints had
    /// drifted open [m], or nothing if they could not be closed.
    fn close(&mut self, t: f64, q: &mut [f64], v: &mut [f64]) -> Option<f64> {
        let _ = (t, q, v);
        Some(0.0)
    }
    /// Scales of q and qd against which errors are measured `(n,)` each.
    fn scales(&self) -> (&[f64], &[f64]);
    /// Takes notice that the state last linearised was accepted: laws that remember how a contact began learn of it
    /// here.
    fn accepted(&mut self, q: &[f64], v: &[f64], at: &Linearised) {
        let _ = (q, v, at);
    }
    /// Whether the state lies in the range of the model; else which joint left it and its penetration.
    fn in_range(&self, at: &Linearised) -> Result<(), (usize, f64)> {
        let _ = at;
        Ok(())
    }
    /// The joint to be named when the error of this coordinate stops the integration.
    fn blamed(&self, coordinate: usize, at: &Linearised) -> Option<usize> {
        let _ = (coordinate, at);
        None
    }
}

/// f and its derivatives at one instant.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Linearised {
    /// f `(n,)`.
    pub f: Vec<f64>,
    /// df/dq `(n, n)`, by rows.
    pub k: Vec<f64>,
    /// df/dqd `(n, n)`, by rows.
    pub d: Vec<f64>,
    /// df/dt at constant q, qd `(n,)`.
    pub ft: Vec<f64>,
    /// What each joint of the island does.
    pub joints: Vec<JointForce>,
    /// Eccentricity of each joint in its bushing's frame [m].
    pub e: Vec<[f64; 2]>,
    /// Multipliers of the ideal joints' constraints `(m,)` [N, N m].
    pub lambda: Vec<f64>,
    /// Generalised force (x, y, angle) of joints and loads on each prescribed body [N, N m].
    pub prescribed: Vec<[f64; 3]>,
    /// Whether the ideal joints' directions are dependent here, so that f does not exist.
    pub singular: bool,
}

impl Linearised {
    /// Room for `n` degrees of freedom and `joints` joints.
    pub fn new(n: usize, joints: usize) -> Self {
        Linearised {
            f: vec![0.0; n],
            k: vec![0.0; n * n],
            d: vec![0.0; n * n],
            ft: vec![0.0; n],
            joints: vec![JointForce::default(); joints],
            e: vec![[0.0; 2]; joints],
            ..Linearised::default()
        }
    }
}
