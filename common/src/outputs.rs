//! What one evaluation returns, in SI.

use serde::{Deserialize, Serialize};

/// Result of one evaluation: the whole life of one sample.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Evaluation {
    /// Checkpoints `(m,)` [cycles]; each value below belongs to the profile worn to that many cycles.
    pub cycles: Vec<u32>,
    /// One history per output of the scene `(outputs, m)`, in the output's SI unit.
    pub histories: Vec<Vec<f64>>,
    /// Estimate of the numerical error of every value in `histories`, of the same shape and unit.
    pub errors: Vec<Vec<f64>>,
    /// Per joint: state at the end of life and force peak of the first cycle.
    pub joints: Vec<JointSummary>,
    /// The settled first cycle of the unworn mechanism, when asked for.
    pub first_cycle: Option<CycleHistory>,
    /// What wear made of the mechanism, when the first cycle was asked for and anything wears.
    #[serde(default)]
    pub worn: Option<WornLife>,
    /// What the numerics had to do.
    pub diagnostics: Diagnostics,
}

/// One joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JointSummary {
    /// Name of the joint.
    pub name: String,
    /// Largest contact force magnitude of the settled first cycle [N].
    pub peak_force: f64,
    /// Wear depth at each control point at the end of life `(control_points,)`; none of an ideal joint [m].
    pub wear_depth: Vec<f64>,
}

/// The bores through life, and the motion on them at its end.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct WornLife {
    /// Lives at which a cycle was simulated, from zero to the end `(k,)` [cycles].
    pub cycles: Vec<u32>,
    /// Wear depth at those lives, per joint at each control point `(k, joints, control_points)`; none of an ideal
    /// joint [m].
    pub wear_depth: Vec<Vec<Vec<f64>>>,
    /// The last cycle, on the bores as worn by then.
    pub last_cycle: Option<CycleHistory>,
}

/// Time histories of one cycle on a common time grid.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CycleHistory {
    /// Time from the start of the cycle `(n,)` [s].
    pub time: Vec<f64>,
    /// Bodies reported, by label, e.g. `right`, `left`.
    pub bodies: Vec<BodyTrace>,
    /// Motion of every free and driven body, by name.
    pub motion: Vec<BodyMotion>,
    /// Force magnitude per joint, `(n,)` each [N].
    pub joint_force: Vec<(String, Vec<f64>)>,
}

/// Motion of one body over a cycle.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BodyTrace {
    /// Label, e.g. `right`.
    pub label: String,
    /// Signed angle `(n,)` [rad].
    pub angle: Vec<f64>,
    /// Signed angular velocity `(n,)` [rad/s].
    pub speed: Vec<f64>,
}

/// Motion of one body in the plane over a cycle.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BodyMotion {
    /// Name of the body.
    pub body: String,
    /// Position of its reference point `(n, 2)` [m].
    pub position: Vec<[f64; 2]>,
    /// Angle `(n,)` [rad].
    pub angle: Vec<f64>,
    /// Angular velocity `(n,)` [rad/s].
    pub speed: Vec<f64>,
}

/// Energy over one cycle: what came in, where it went. In exact arithmetic
/// input + unphysical = stored + dissipated.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct EnergyBalance {
    /// Work of the drives and of loads that have no potential [J].
    pub input: f64,
    /// Gain of kinetic energy and of that in springs, gravity and contacts [J].
    pub stored: f64,
    /// Work lost in friction, contact damping, films and dampers [J].
    pub dissipated: f64,
    /// Work of elastic contact forces that no potential accounts for: `local-hertz` on a worn bore [J].
    pub unphysical: f64,
    /// Sum of the sizes of all power that flowed, against which the residual is to be seen [J].
    pub turnover: f64,
}

impl EnergyBalance {
    /// input + unphysical - stored - dissipated: the numerical error of the cycle [J].
    pub fn residual(&self) -> f64 {
        self.input + self.unphysical - self.stored - self.dissipated
    }
}

/// Work and repairs of one evaluation.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Diagnostics {
    /// Accepted time steps.
    pub steps: u64,
    /// Steps refused and repeated with a smaller one.
    pub rejected_steps: u64,
    /// Newton iterations (position analysis and contact equilibrium; the linearly implicit step needs none).
    pub newton_iterations: u64,
    /// Evaluations of the force vector.
    pub force_evaluations: u64,
    /// Cycles simulated.
    pub simulated_cycles: u64,
    /// Stages of the wear step.
    pub wear_stages: u64,
    /// Wear steps refused and repeated over a smaller block.
    pub rejected_wear_steps: u64,
    /// Share of the first cycle in free flight, per joint with clearance.
    pub free_flight_fraction: Vec<(String, f64)>,
    /// Largest distance by which an ideal joint drifted open in one step before it was closed again [m].
    pub constraint_drift: f64,
    /// Control points at which a wear step undershot, within its tolerance, and was held at its start.
    pub held_wear_points: u64,
    /// Whether the quasi-static tier drove the wear.
    pub quasi_static: bool,
    /// Energy of the first cycle, when that cycle was asked for.
    pub energy: Option<EnergyBalance>,
    /// Energy of the last cycle, on the bores as worn by then, likewise.
    pub worn_energy: Option<EnergyBalance>,
}
