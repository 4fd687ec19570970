//! Time integration of M qdd = f(q, qd, t), islands of a few stiff degrees of freedom at a time.

mod abreast;
mod advance;
mod band;
mod control;
#[cfg(test)]
mod impact_tests;
mod linear;
mod pivoted;
mod rosenbrock;

pub use abreast::{Abreast, Scaled, Seat};
pub use advance::{Advance, AdvanceError, AdvanceStats, Watch, worst_coordinate};
pub use band::Band;
pub use control::StepControl;
pub use linear::add_product;
pub use pivoted::Pivoted;
pub use rosenbrock::Rosenbrock;

use crate::contact::JointForce;
use crate::lanes::Real;

/// Systems M qdd = f(q, qd, t) with a constant diagonal mass matrix, one per lane.
pub trait Dynamics<R: Real = f64> {
    /// Diagonal of M `(n,)` [kg, kg m^2].
    fn mass(&self) -> &[R];
    /// f `(n,)` at time `t` [s]; not a number where it does not exist.
    fn force(&mut self, t: R, q: &[R], v: &[R], f: &mut [R]);
    /// f with its derivatives.
    fn linearise(&mut self, t: R, q: &[R], v: &[R], at: &mut Linearised<R>);
}

/// What the control of the steps asks of one such system.
pub trait Stepped: Dynamics {
    /// Whether [`Stepped::close`] has anything to do.
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
    fn responsible_joint(&self, coordinate: usize, at: &Linearised) -> Option<usize> {
        let _ = (coordinate, at);
        None
    }
}

/// f and its derivatives at one instant.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Linearised<R = f64> {
    /// f `(n,)`.
    pub f: Vec<R>,
    /// Where the entries of the matrices are.
    pub band: Band,
    /// df/dq `(n, n)`.
    pub k: Vec<R>,
    /// df/dqd `(n, n)`.
    pub d: Vec<R>,
    /// df/dt at constant q, qd `(n,)`.
    pub ft: Vec<R>,
    /// What each joint of the island does.
    pub joints: Vec<JointForce<R>>,
    /// Eccentricity of each joint in its bushing's frame [m].
    pub e: Vec<[R; 2]>,
    /// Multipliers of the ideal joints' constraints `(m,)` [N, N m].
    pub lambda: Vec<R>,
    /// Generalised force (x, y, angle) of joints and loads on each prescribed body [N, N m].
    pub prescribed: Vec<[R; 3]>,
    /// Whether the ideal joints' directions are dependent here, so that f does not exist.
    pub singular: bool,
}

impl<R: Real> Linearised<R> {
    /// Room for the degrees of freedom of `band` and `joints` joints, in as many lanes as `like`.
    pub fn new(like: R, band: Band, joints: usize) -> Self {
        let zero = like.zero();
        Linearised {
            f: vec![zero; band.n()],
            k: vec![zero; band.len()],
            d: vec![zero; band.len()],
            ft: vec![zero; band.n()],
            band,
            joints: vec![JointForce::none(zero); joints],
            e: vec![[zero; 2]; joints],
            ..Self::nothing()
        }
    }

    /// Room for nothing.
    pub fn nothing() -> Self {
        Linearised {
            f: vec![],
            band: Band::default(),
            k: vec![],
            d: vec![],
            ft: vec![],
            joints: vec![],
            e: vec![],
            lambda: vec![],
            prescribed: vec![],
            singular: false,
        }
    }
}
