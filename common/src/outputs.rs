//! Results of one evaluation, in SI units.

use crate::scene::Output;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Result of one evaluation: the life of the mechanism for one sample of its random variables.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Evaluation {
    /// Checkpoints `(m,)` [cycles]; each value below belongs to the profile worn to that many cycles.
    pub cycles: Vec<u32>,
    /// One history per output of the scene `(outputs, m)`, in the output's SI unit.
    pub histories: Vec<Vec<f64>>,
    /// Estimate of the numerical error of every value in `histories`, of the same shape and unit.
    pub errors: Vec<Vec<f64>>,
    /// Value of each output in the first cycle, before any wear `(outputs,)`, in the output's SI unit; `None` for an output
    /// whose value is not known, empty if none is.
    #[serde(default)]
    pub start: Vec<Option<f64>>,
    /// Per joint: state at the end of life and force peak of the first cycle.
    pub joints: Vec<JointSummary>,
    /// The settled first cycle of the unworn mechanism, if it was requested.
    pub first_cycle: Option<CycleHistory>,
    /// Bores over life and the last cycle, if the first cycle was requested and a joint wears.
    pub worn: Option<WornLife>,
    /// Work counters and repairs of the integration.
    pub diagnostics: Diagnostics,
}

impl Evaluation {
    /// An evaluation by a formula or another program: histories `(outputs, m)` at the checkpoints `(m,)` [cycles],
    /// without stated errors, motion or joints.
    pub fn from_histories(cycles: Vec<u32>, histories: Vec<Vec<f64>>) -> Self {
        Self { cycles, histories, ..Self::default() }
    }

    /// Moves the bodies of all cycle histories by `by` `(2,)` [m]; nothing else depends on the origin of the coordinates.
    pub fn move_histories(&mut self, by: [f64; 2]) {
        let last = self.worn.iter_mut().filter_map(|worn| worn.last_cycle.as_mut());
        let motions = self.first_cycle.iter_mut().chain(last).flat_map(|cycle| &mut cycle.motion);
        for position in motions.flat_map(|motion| &mut motion.position) {
            (0..2).for_each(|k| position[k] += by[k]);
        }
    }

    /// The known values at the start of life by output and unit, e.g. `max_wear_depth_m`, in the unit of the key.
    pub fn start_by_key(&self, outputs: &[Output]) -> BTreeMap<String, f64> {
        let known = |(output, value): (&Output, &Option<f64>)| {
            let unit = output.kind.unit();
            value.map(|value| (unit.key(&output.name), unit.to_file(value)))
        };
        outputs.iter().zip(&self.start).filter_map(known).collect()
    }
}

/// Result for one joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JointSummary {
    /// Name of the joint, as in the scene.
    pub name: String,
    /// Largest contact force magnitude of the settled first cycle [N].
    pub peak_force: f64,
    /// Wear depth at each control point of the bushing at the end of life `(control_points,)` [m], of a guide on its left face along the axis, then on its
    /// right face; empty for an ideal joint and for a guide that does not wear.
    pub wear_depth: Vec<f64>,
    /// Wear depth at the control points of the journal, or of the slider on its left face, then on its right face; empty if it does not wear.
    #[serde(default)]
    pub journal_wear_depth: Vec<f64>,
}

/// Wear of all bores over life, and the motion at its end.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct WornLife {
    /// Cycle numbers at which a cycle was simulated, from 0 to the end of life `(k,)` [cycles].
    pub cycles: Vec<u32>,
    /// Wear depth there, per joint at each control point `(k, joints, control_points)` [m]; empty for an ideal joint.
    pub wear_depth: Vec<Vec<Vec<f64>>>,
    /// The last cycle, on the bores worn to that time.
    pub last_cycle: Option<CycleHistory>,
}

/// Time histories of one cycle on a common time grid.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct CycleHistory {
    /// Time from the start of the cycle `(n,)` [s].
    pub time: Vec<f64>,
    /// Bodies reported, by label, e.g. `right`, `left`.
    pub bodies: Vec<BodyTrace>,
    /// Motion of every free and driven body.
    pub motion: Vec<BodyMotion>,
    /// Name of each joint with its force magnitude, of a cam, teeth or a belt negative where their contact cannot transmit it `(n,)` [N].
    pub joint_force: Vec<(String, Vec<f64>)>,
    /// Name of each driven body with the torque that moves it, positive counter-clockwise `(n,)` [N m].
    #[serde(default)]
    pub driving_torque: Vec<(String, Vec<f64>)>,
    /// Journals of a cycle that another program gives; empty for the built-in mechanics.
    #[serde(default)]
    pub journals: Vec<JournalPath>,
    /// Name of each guide of a cycle that another program gives, with the position of its slider's middle along it `(n,)` [m].
    #[serde(default)]
    pub slider_position: Vec<(String, Vec<f64>)>,
}

impl CycleHistory {
    /// The journal of the joint of this name, if another program gives it.
    pub fn journal(&self, joint: &str) -> Option<&JournalPath> {
        self.journals.iter().find(|path| path.joint == joint)
    }
}

/// A journal over a cycle that another program gives, in the frame of the bushing's body.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct JournalPath {
    /// Name of the joint, as in the scene.
    pub joint: String,
    /// Normal force of the journal on the bushing `(n, 2)` [N].
    pub force: Vec<[f64; 2]>,
    /// Centre of the journal from that of the bushing `(n, 2)` [m]; empty if the program does not give it.
    pub eccentricity: Vec<[f64; 2]>,
}

/// Rotation of one body over a cycle, as an output reports it, or in a cycle of another program that of a journal's body relative to the
/// bushing's.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BodyTrace {
    /// Label of the body in reports, e.g. `right`, or name of the joint.
    pub label: String,
    /// Signed angle `(n,)` [rad].
    pub angle: Vec<f64>,
    /// Signed angular velocity `(n,)` [rad/s].
    pub speed: Vec<f64>,
}

/// Motion of one body in the plane over a cycle.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct BodyMotion {
    /// Name of the body, as in the scene.
    pub body: String,
    /// Position of its reference point `(n, 2)` [m].
    pub position: Vec<[f64; 2]>,
    /// Angle `(n,)` [rad].
    pub angle: Vec<f64>,
    /// Angular velocity `(n,)` [rad/s].
    pub speed: Vec<f64>,
}

/// Energy balance of one cycle. In exact arithmetic input + unphysical = stored + dissipated.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct EnergyBalance {
    /// Work of the drives and of loads that have no potential [J].
    pub input: f64,
    /// Gain of kinetic energy and of that in springs, gravity and contacts [J].
    pub stored: f64,
    /// Work lost in friction, contact damping, films and dampers [J].
    pub dissipated: f64,
    /// Work of elastic contact forces without a potential: `local-hertz` on a worn bore [J].
    pub unphysical: f64,
    /// Integral of the magnitudes of all powers, the scale of the residual [J].
    pub turnover: f64,
}

impl EnergyBalance {
    /// input + unphysical - stored - dissipated: the numerical error of the cycle [J].
    pub fn residual(&self) -> f64 {
        self.input + self.unphysical - self.stored - self.dissipated
    }
}

/// A groove of a worn bore that is narrower than its journal, which lies on both edges and leaves the ground between open.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct NarrowGroove {
    /// Name of the joint, as in the scene.
    pub joint: String,
    /// Simulated life at which it was there first [cycles].
    pub since: u32,
    /// Angle of its middle in the bushing's frame, from 0 to one turn, where it was most open [rad].
    pub angle: f64,
    /// Angle between both edges there [rad].
    pub width: f64,
    /// Largest distance of the journal from the ground [m].
    pub open: f64,
}

/// An output of the motion on worn surfaces with more control points, at the life where they change it most.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct PointsError {
    /// Name of the output, as in the scene.
    pub output: String,
    /// Simulated life [cycles].
    pub cycles: u32,
    /// Values with the scene's points, with twice and with four times as many, in the output's SI unit `(3,)`.
    pub values: [f64; 3],
    /// Estimated error due to the number of points, in the same unit.
    pub error: f64,
    /// False if the second change is not smaller than the first, so that the output does not converge with the points.
    pub converges: bool,
    /// True if the stated errors contain this one; false if the scene declares its points a part of its model.
    pub stated: bool,
}

/// A motion that does not repeat itself from cycle to cycle, or has not come to.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct UnsettledMotion {
    /// Name of the output that changes most from one cycle to the next.
    pub output: String,
    /// That change over the value of the output [1].
    pub change: f64,
    /// Settling cycles simulated in addition to those of the scene.
    pub further_cycles: u32,
    /// Name of a body that turns in every cycle, but by no whole number of turns, and the angle by which it does [rad].
    pub turning: Option<(String, f64)>,
}

/// Work counters and repairs of one evaluation.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Diagnostics {
    /// Number of accepted time steps.
    pub steps: u64,
    /// Steps refused and repeated with a smaller one.
    pub rejected_steps: u64,
    /// Newton iterations (position analysis and contact equilibrium; the linearly implicit step needs none).
    pub newton_iterations: u64,
    /// Number of evaluations of the force vector.
    pub force_evaluations: u64,
    /// Number of cycles simulated.
    pub simulated_cycles: u64,
    /// Number of stages of the wear steps.
    pub wear_stages: u64,
    /// Wear steps refused and repeated over a smaller block.
    pub rejected_wear_steps: u64,
    /// Fraction of the first cycle in free flight [1], for each joint with clearance by name.
    pub free_flight_fraction: Vec<(String, f64)>,
    /// Largest distance by which an ideal joint drifted open in one step before it was closed again [m].
    pub constraint_drift: f64,
    /// Number of control points at which a wear step would have lowered the depth, within its tolerance, and was held.
    pub held_wear_points: u64,
    /// For each joint in whose bore a groove is narrower than the journal the one that is most open over the life.
    #[serde(default)]
    pub narrow_grooves: Vec<NarrowGroove>,
    /// What more control points change in each output of the motion; empty where that was not compared.
    #[serde(default)]
    pub control_points: Vec<PointsError>,
    /// How far the motion is from repeating itself in the first measured cycle, if it has not settled.
    pub unsettled: Option<UnsettledMotion>,
    /// True if the wear was computed from quasi-static motion.
    pub quasi_static: bool,
    /// Energy balance of the first cycle, if that cycle was requested.
    pub energy: Option<EnergyBalance>,
    /// Energy balance of the last cycle, on the worn bores, if the first cycle was requested.
    pub worn_energy: Option<EnergyBalance>,
}

/// A work counter of an evaluation: its key in files, its name, and its value.
pub type Counter = (&'static str, &'static str, fn(&Diagnostics) -> u64);

/// The work counters of an evaluation.
pub const COUNTERS: [Counter; 7] = [
    ("steps", "time steps", |work| work.steps),
    ("rejected_steps", "rejected time steps", |work| work.rejected_steps),
    ("newton_iterations", "Newton iterations", |work| work.newton_iterations),
    ("force_evaluations", "force evaluations", |work| work.force_evaluations),
    ("simulated_cycles", "cycles simulated", |work| work.simulated_cycles),
    ("wear_stages", "stages of the wear step", |work| work.wear_stages),
    ("rejected_wear_steps", "rejected wear steps", |work| work.rejected_wear_steps),
];
