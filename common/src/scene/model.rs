//! The resolved scene: a scene file after its expressions, units, names and ranges were checked.
//!
//! Planar, SI units, angles counter-clockwise from +x. Bodies are referred to by index into [`Scene::bodies`].

use super::choice::choice;
use super::joint::Joint;
use super::key_table::Value;
use super::load::Load;
use super::output::{LimitState, Output, OutputKind};
use super::output_unit::OutputUnit;
use super::units::Units;
use super::values::{Attachment, Drive};
use super::wear_model::WearModel;
use crate::accuracy::NamedAccuracy;
use crate::random::{Correlation, RandomVariable};
use serde::Serialize;
use std::collections::BTreeMap;

/// A whole study case: mechanism, uncertainty, limit states, life.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Scene {
    /// Short name, as used on the command line.
    pub name: String,
    /// One line for people.
    pub title: String,
    /// All bodies, the fixed frame included.
    pub bodies: Vec<Body>,
    /// All joints, in the order of the file.
    pub joints: Vec<Joint>,
    /// All loads, in the order of the file.
    pub loads: Vec<Load>,
    /// Acceleration of gravity `(2,)` [m/s^2].
    pub gravity: [f64; 2],
    /// Quantities an evaluation returns at every checkpoint.
    pub outputs: Vec<Output>,
    /// Random variables, in the order of the sample vector.
    pub variables: Vec<RandomVariable>,
    /// Correlations of the standard normals behind the random variables, each pair once; the others are independent.
    pub correlations: Vec<Correlation>,
    /// Limit states over the outputs.
    pub limit_states: Vec<LimitState>,
    /// Units in which its quantities are shown.
    #[serde(skip_serializing_if = "Units::are_usual")]
    pub units: Units,
    /// True if the numbers of control points are a part of the model, as published: what more of them change is then no error.
    pub control_points_of_model: bool,
    /// Choices of the wear model.
    pub wear: WearModel,
    /// Duration and number of the cycles.
    pub life: Life,
    /// Operating conditions of the life; empty if all cycles are alike.
    pub conditions: Vec<Condition>,
    /// Default settings of a study of this scene.
    pub study: StudySettings,
    /// Default accuracy of an evaluation.
    pub accuracy: NamedAccuracy,
    /// Levels of accuracy of a study of this scene, the working accuracy first; empty where the scene names none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub levels: Vec<NamedAccuracy>,
    /// External simulator that evaluates a sample instead of this program. Such a scene has no bodies, joints or loads, and its random variables
    /// are the simulator's inputs. If it gives cycles, the scene has the joints that wear, on a body that stands for the mechanism.
    pub simulator: Option<ExternalSimulator>,
}

/// An external simulator.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ExternalSimulator {
    /// Program or server, with its address.
    pub kind: SimulatorKind,
    /// Longest time of one evaluation [s].
    pub timeout: f64,
    /// Version of the simulator in its author's words; empty if the scene states none.
    pub version: String,
    /// The cycles by which it replies; `None`: it gives the outputs over a whole life.
    pub cycles: Option<CycleProgram>,
    /// Names of its levels of accuracy, from the coarsest to the finest; empty if it has none.
    pub levels: Vec<String>,
    /// Cost of an evaluation over that of one at the next coarser level [1].
    pub level_cost: f64,
    /// True if the finest level is the model itself, which leaves no error.
    pub finest_is_exact: bool,
}

/// A program that gives the contacts of one cycle on the surfaces as worn so far.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct CycleProgram {
    /// What its cycles depend on.
    pub tier: CycleTier,
    /// Folder in which the replies of lives under way are kept; `None`: they are not.
    pub journal: Option<String>,
}

choice! {
    /// What the cycles of a program depend on.
    pub enum CycleTier;
    /// Joints with clearance, on the surfaces of the request.
    "contact" => Contact "gives cycles on the worn surfaces of its joints"
    /// Ideal joints, whose reactions depend on no surface: one cycle serves a whole life.
    "reaction" => Reaction "gives one cycle for a life, with ideal joints"
}

/// Ways to call an external simulator.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub enum SimulatorKind {
    /// A program on this machine.
    Program(Program),
    /// A server, by the UM-Bridge protocol.
    UmBridge(UmBridgeModel),
}

/// A program that reads samples and writes results.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Program {
    /// Program and arguments, at least one entry.
    pub command: Vec<String>,
    /// Folder in which the program runs; with files, the folder that has them.
    pub folder: String,
    /// Files by which it gets samples and returns results; `None`: lines of JSON over standard input and output.
    pub exchange: Option<FileExchange>,
    /// The FMU that it runs, in the folder.
    pub fmu: Option<String>,
}

/// The files of a working folder. All names are relative, without `..`.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct FileExchange {
    /// The file that the program writes.
    pub results: String,
    /// Files that are copied with values in the place of `{NAME}`.
    pub templates: Vec<String>,
    /// Files that are copied unchanged.
    pub files: Vec<String>,
}

/// A model of a UM-Bridge server.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct UmBridgeModel {
    /// Address without a `/` at its end, e.g. `http://127.0.0.1:4242`.
    pub url: String,
    /// Name by which the server knows the model.
    pub model: String,
    /// Configuration that is sent with every request.
    pub config: toml::Table,
}

impl Scene {
    /// Unit in which an output is shown.
    pub fn unit_of(&self, output: &Output) -> OutputUnit {
        self.units.of_output(output)
    }

    /// Lever arm of a place: its vector from the base point of its body, in the body's frame `(2,)` [m].
    pub fn arm(&self, place: &Attachment) -> [f64; 2] {
        let origin = self.bodies[place.body].motion.base_point();
        [place.position[0] - origin[0], place.position[1] - origin[1]]
    }

    /// The scene with its mechanism moved by `by` `(2,)` [m] as a whole: fixed points, axes of drives, start positions and wanted
    /// coordinates. The operating conditions are moved with it.
    pub fn moved(&self, by: [f64; 2]) -> Scene {
        let mut scene = self.clone();
        let shift = |position: &mut [f64; 2]| (0..2).for_each(|k| position[k] += by[k]);
        let mut fixed = Vec::with_capacity(scene.bodies.len());
        for body in &mut scene.bodies {
            fixed.push(body.motion == Motion::Fixed);
            match &mut body.motion {
                Motion::Fixed => body.points.iter_mut().for_each(|point| shift(&mut point.position)),
                Motion::Driven { position, .. } | Motion::Free { start_position: position, .. } => {
                    shift(position)
                }
            }
        }
        let place = |at: &mut Attachment| {
            if fixed[at.body] {
                shift(&mut at.position);
            }
        };
        for joint in &mut scene.joints {
            place(&mut joint.journal);
            place(&mut joint.bushing);
        }
        for load in &mut scene.loads {
            load.change(|value| {
                if let Value::Place(at) = value {
                    place(at);
                }
            });
        }
        for output in &mut scene.outputs {
            if let OutputKind::PositionError { wanted, .. } = &mut output.kind {
                for (curve, by) in wanted.iter_mut().zip(by) {
                    curve.iter_mut().flat_map(|curve| &mut curve.table.value).for_each(|value| *value += by);
                }
            }
        }
        for condition in &mut scene.conditions {
            condition.scene = condition.scene.moved(by);
        }
        scene
    }
}

/// An operating condition: a share of the cycles of a life, in which some quantities of the scene have other values.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Condition {
    /// Name, unique in its scene.
    pub name: String,
    /// Share of the cycles, > 0; those of all conditions of a scene add up to 1 [1].
    pub share: f64,
    /// The scene under this condition, on the same bores; without random variables and conditions of its own.
    pub scene: Scene,
    /// Under this condition the parameters, by name, that a condition of the scene changes [SI].
    pub parameters: BTreeMap<String, f64>,
}

/// A rigid body.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Body {
    /// Name, unique in its scene.
    pub name: String,
    /// Fixed, driven or free, with what that needs.
    pub motion: Motion,
    /// Named points, in the body's own frame, whose origin is the body's reference point.
    pub points: Vec<Point>,
}

/// A named point of a body.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Point {
    /// Name, unique in its body.
    pub name: String,
    /// Position in the body's frame `(2,)` [m].
    pub position: [f64; 2],
}

/// The kinds of motion of a body.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub enum Motion {
    /// Part of the frame: its frame coincides with the global one.
    Fixed,
    /// Rotates about its reference point as prescribed; adds no unknowns.
    Driven {
        /// Position of the reference point `(2,)` [m].
        position: [f64; 2],
        /// Angle of the body as a function of time.
        drive: Drive,
        /// Mass properties, required for the torque that drives it and for its energy; without them it is massless.
        inertia: Option<MassProperties>,
    },
    /// Moves under its joints and loads; adds three unknowns.
    Free {
        /// Mass of the body [kg].
        mass: f64,
        /// Moment of inertia about the centre of mass [kg m^2].
        inertia: f64,
        /// Centre of mass in the body's frame `(2,)` [m].
        centre_of_mass: [f64; 2],
        /// Approximate position of the reference point at time zero `(2,)` [m].
        start_position: [f64; 2],
        /// Approximate angle at time zero [rad].
        start_angle: f64,
        /// Velocity of the reference point at time zero `(2,)` [m/s]; `None` leaves it to drives, joints and the velocities given.
        start_velocity: Option<[f64; 2]>,
        /// Angular velocity at time zero [rad/s]; `None` likewise.
        start_speed: Option<f64>,
    },
}

impl Motion {
    /// The point whose coordinates describe the body in the equations of motion, in the body's frame `(2,)` [m]: the
    /// centre of mass of a free body, else the reference point.
    pub fn base_point(&self) -> [f64; 2] {
        match self {
            Motion::Free { centre_of_mass, .. } => *centre_of_mass,
            Motion::Fixed | Motion::Driven { .. } => [0.0; 2],
        }
    }
}

/// Mass properties of a body.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct MassProperties {
    /// Mass of the body [kg].
    pub mass: f64,
    /// Moment of inertia about the centre of mass [kg m^2].
    pub inertia: f64,
    /// Centre of mass in the body's frame `(2,)` [m].
    pub centre_of_mass: [f64; 2],
}

/// The cycle, and the number of cycles of a life.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Life {
    /// Duration of one cycle; 0 for an external simulator, where it is unknown [s].
    pub period: f64,
    /// Length of the life [cycles].
    pub cycles: u32,
    /// Distance between two checkpoints [cycles]; `cycles` is a multiple of it.
    pub checkpoint_every: u32,
    /// Cycles that settle the motion before the first measured one, at least; 0 to measure from the start.
    pub settle_cycles: u32,
    /// Free body whose turn is the cycle; `period` is then the time that a turn takes at its start speed.
    pub turn_of: Option<usize>,
}

impl Life {
    /// A life with these checkpoints, whose cycles have no period yet.
    pub(super) fn of_checkpoints(cycles: u32, checkpoint_every: u32) -> Self {
        Life { period: 0.0, cycles, checkpoint_every, settle_cycles: 0, turn_of: None }
    }

    /// The checkpoints `(m,)` [cycles]: `checkpoint_every` and its multiples up to `cycles`.
    pub fn checkpoints(&self) -> Vec<u32> {
        (1..=self.cycles / self.checkpoint_every).map(|k| k * self.checkpoint_every).collect()
    }

    /// True if one cycle without any before it is the whole life: a motion seen once, from its start, which need not repeat.
    pub fn is_single_cycle(&self) -> bool {
        (self.cycles, self.settle_cycles) == (1, 0)
    }
}

/// Default settings of a study.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct StudySettings {
    /// Size of the Monte Carlo population.
    pub population: usize,
    /// Number of simulations of the initial design.
    pub initial: usize,
    /// Largest number of simulations under way at once after the initial design; a round of learning adds half of it.
    pub batch: usize,
    /// Largest number of evaluations.
    pub max_evaluations: usize,
    /// Seed of all random draws.
    pub seed: u64,
}

impl StudySettings {
    /// The settings of a scene of `variables` random variables without `[study]`.
    ///
    /// The initial design has 6 simulations and 4 per variable, 12 to 30, and 3/2 per variable from the 21st on: learning places the
    /// others better, but only once the surrogates see every variable. A batch is as small as two machines allow, four, and grows by two for every eight variables, as
    /// more directions have to be tried.
    pub fn for_variables(variables: usize) -> Self {
        StudySettings {
            population: 100_000,
            initial: (6 + 4 * variables).clamp(12, 30).max(3 * variables / 2),
            batch: 2 * (2 + variables / 8),
            max_evaluations: (10 * variables).max(600),
            seed: 1,
        }
    }
}
