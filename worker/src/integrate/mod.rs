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
    /// f `(n,)` at time `t` [s].
    fn force(&self, t: f64, q: &[f64], v: &[f64], f: &mut [f64]);
    /// f with its derivatives.
    fn linearise(&self, t: f64, q: &[f64], v: &[f64], at: &mut Linearised);
    /// Scales of q and qd against which errors are measured `(n,)` each.
    fn scales(&self) -> (&[f64], &[f64]);
    /// Whether the state lies in the range of the model; else which joint left it and its penetration.
    fn in_range(&self, at: &Linearised) -> Result<(), (usize, f64)> {
        let _ = at;
        Ok(())
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
        }
    }
}
