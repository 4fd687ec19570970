//! Time integration of M qdd = f(q, qd, t) for islands of a few stiff degrees of freedom.
//!
//! | file | contents |
//! |---|---|
//! | `rosenbrock.rs` | one step of the fourth-order scheme with its error estimate |
//! | `progress.rs` | accepts or refuses a step; length of the next one; counts; reasons to stop |
//! | `stepper.rs` | integrates one system over a span of time |
//! | `lane_stepper.rs` | integrates one system per SIMD lane over spans of their own |
//! | `projected.rs` | one explicit step of fifth order on the constraints of ideal joints |
//! | `layout.rs`, `linear.rs` | banded and dense matrices and their factorisations |

#[cfg(test)]
pub(crate) mod impact_tests;
mod lane_stepper;
#[cfg(test)]
mod lane_stepper_tests;
mod layout;
mod linear;
mod progress;
mod projected;
mod rosenbrock;
mod stepper;

pub(crate) use lane_stepper::{LaneStepper, SteppedLanes};
pub use layout::Band;
pub(crate) use layout::Layout;
pub(crate) use linear::{Pivoted, add_product, factor, solve};
pub use progress::{IntegrationError, StepControl, StepCounts};
pub(crate) use progress::{
    SpanProgress, nan_as_infinite, projected_step_ratio, step_ratio, worst_coordinate,
};
pub(crate) use projected::ProjectedStep;
pub(crate) use rosenbrock::Rosenbrock;
pub use stepper::{StateObserver, Stepper};

use crate::contact::{GuideReaction, JointForce};
use crate::lanes::{Lanewise, Real};

/// Systems M qdd = f(q, qd, t) with a constant diagonal mass matrix, one per lane.
pub trait Dynamics<R: Real = f64> {
    /// Diagonal of M `(n,)` [kg, kg m^2].
    fn mass(&self) -> &[R];
    /// f `(n,)` at time `t` [s]; not a number where it does not exist.
    fn force(&mut self, t: R, q: &[R], v: &[R], f: &mut [R]);
    /// f with its derivatives K = df/dq, D = df/dqd and df/dt at time `t` [s].
    fn linearise(&mut self, t: R, q: &[R], v: &[R], at: &mut Linearised<R>);
}

/// One such system with what error control needs: scales, constraints, range and memory.
pub trait Stepped: Dynamics {
    /// True if the system has ideal joints, so that [`Stepped::close`] changes its state.
    fn is_constrained(&self) -> bool;
    /// Moves positions and velocities back onto the constraints of ideal joints. Returns the largest distance by which a joint had
    /// drifted open [m], or `None` if the joints cannot be closed.
    fn close(&mut self, t: f64, q: &mut [f64], v: &mut [f64]) -> Option<f64>;
    /// True if the system has contacts whose beginning within a step counts as an error, see [`Stepped::begun`].
    fn begins_contacts(&self) -> bool;
    /// Error of the step of length `h` [s] that led from the state linearised as `before` to (`t`, `q`, `v`), in the scales of the system [1], because
    /// of contacts that began within it: the scheme may not have met their force.
    fn begun(&mut self, before: &Linearised, h: f64, t: f64, q: &[f64], v: &[f64]) -> f64;
    /// Whether the next step has to be explicit, with the constraints of ideal joints closed at each of its stages: near positions in
    /// which they are dependent, where their forces depend on the least displacement, and for many ideal joints.
    fn is_projected(&self) -> bool;
    /// A length for an explicit step that suits the positions in which the constraints are dependent: at most `h` [s], but for the first
    /// step tried from a state near such a position.
    fn step_length(&self, h: f64, is_first: bool) -> f64;
    /// Largest error by rounding in an explicit step of length `h` [s], over the scales [1].
    fn rounding(&self, h: f64) -> f64;
    /// How a step of length `h` [s], after which the ideal joints are closed, passes positions in which their constraints are
    /// dependent.
    fn passing(&mut self, h: f64, from: State, to: State) -> Passing;
    /// The joint to name if the constraints of the ideal joints are nearly dependent in the state last linearised: an index into the
    /// scene's joints.
    fn dependent_joint(&self) -> Option<usize>;
    /// Scales of q and qd against which errors are measured `(n,)` each.
    fn scales(&self) -> (&[f64], &[f64]);
    /// Called after each accepted step with the state last linearised: contact laws whose damping depends on the speed at
    /// impact update it here.
    fn on_accepted(&mut self, q: &[f64], v: &[f64], at: &Linearised);
    /// Checks that the state lies in the range of the contact laws.
    ///
    /// # Errors
    /// The joint that left the range, and its penetration [m].
    fn in_range(&self, at: &Linearised) -> Result<(), (usize, f64)>;
    /// The ideal joint that locks itself, if the force did not exist for that reason at a state tried since the last linearisation.
    fn locked_joint(&self) -> Option<usize>;
    /// The joint to name when the error of this coordinate stops the integration.
    fn responsible_joint(&self, coordinate: usize, at: &Linearised) -> Option<usize>;
}

/// State at one end of a step.
#[derive(Debug, Clone, Copy)]
pub struct State<'a> {
    /// Time of the state [s].
    pub time: f64,
    /// Positions `(n,)` [m, rad].
    pub q: &'a [f64],
    /// Velocities `(n,)` [m/s, rad/s].
    pub v: &'a [f64],
    /// Force with reactions `(n,)` [N, N m]; `None` if it is not known.
    pub f: Option<&'a [f64]>,
}

/// How a step passes such positions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Passing {
    /// There is none.
    Clear,
    /// Through one, on the one branch of the motion.
    Through,
    /// The step is too long, or ends too near, to tell.
    Unclear,
    /// The motion branches there.
    Branching,
}

/// f and its derivatives at one instant.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Linearised<R = f64> {
    /// Generalised force f `(n,)` [N, N m].
    pub f: Vec<R>,
    /// Layout of the matrices.
    pub band: Band,
    /// df/dq `(n, n)`.
    pub k: Vec<R>,
    /// df/dqd `(n, n)`.
    pub d: Vec<R>,
    /// df/dt at constant q, qd `(n,)`.
    pub ft: Vec<R>,
    /// Force of each joint with clearance `(joints,)`.
    pub joints: Vec<JointForce<R>>,
    /// What each guide with clearance does `(guides,)`.
    pub guides: Vec<GuideReaction<R>>,
    /// Eccentricity of each joint in its bushing's frame `(joints, 2)` [m].
    pub e: Vec<[R; 2]>,
    /// Angle of each journal's body minus that of its bushing's `(joints,)` [rad].
    pub turns: Vec<R>,
    /// Multipliers of the ideal joints' constraints `(m,)` [N, N m].
    pub lambda: Vec<R>,
    /// Friction force of each ideal joint with friction, and its sliding speed `(joints, 2)` [N, m/s].
    pub friction: Vec<[R; 2]>,
    /// Generalised force (x, y, angle) of joints and loads on each prescribed body `(bodies, 3)` [N, N m].
    pub prescribed: Vec<[R; 3]>,
    /// One where the constraints of the ideal joints are linearly independent, zero where they are not, so that f does not exist;
    /// `None` without ideal joints.
    pub independent: Option<R>,
    /// One where the reactions of the ideal joints balance their friction, zero where f does not exist because they do not; `None`
    /// without ideal joints.
    pub balanced: Option<R>,
}

impl Linearised {
    /// Checks that every slider is within its guide.
    ///
    /// # Errors
    /// The guide that a slider has left, and how far it stands out [m].
    pub(crate) fn in_guides(&self) -> Result<(), (usize, f64)> {
        let left = self.guides.iter().position(|guide| guide.beyond > 0.0);
        left.map_or(Ok(()), |guide| Err((guide, self.guides[guide].beyond)))
    }
}

impl<R: Real> Linearised<R> {
    /// Zeros for the degrees of freedom of `band` and for `joints` joints, in as many lanes as `like`.
    pub(crate) fn new(like: R, band: Band, joints: usize) -> Self {
        let zero = like.zero();
        Linearised {
            f: vec![zero; band.n()],
            k: vec![zero; band.len()],
            d: vec![zero; band.len()],
            ft: vec![zero; band.n()],
            band,
            joints: vec![JointForce::default().in_lanes(zero); joints],
            e: vec![[zero; 2]; joints],
            turns: vec![zero; joints],
            guides: vec![],
            lambda: vec![],
            friction: vec![],
            prescribed: vec![],
            independent: None,
            balanced: None,
        }
    }

    /// Penetration of the joints with clearance, then of the guides [m].
    pub(crate) fn penetrations(&self) -> impl Iterator<Item = R> + '_ {
        let joints = self.joints.iter().map(|joint| joint.penetration);
        joints.chain(self.guides.iter().map(GuideReaction::deepest))
    }
}
