//! The resolved scene: what remains of a scene file after expressions, units, names and ranges were checked.
//!
//! Planar, SI units, angles counter-clockwise from +x. Bodies are referred to by index into [`Scene::bodies`].

use super::attachment::Attachment;
use super::drive::Drive;
use super::joint::Joint;
use super::load::Load;
use super::output::Output;
use crate::accuracy::NamedAccuracy;
use crate::random::{Correlation, RandomVariable};
use serde::{Deserialize, Serialize};

/// A whole study case: mechanism, uncertainty, limit states, life.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// Short name, as used on the command line.
    pub name: String,
    /// One line for people.
    pub title: String,
    /// All bodies; the fixed frame is one of them.
    pub bodies: Vec<Body>,
    /// All joints, in the order of the file.
    pub joints: Vec<Joint>,
    /// All loads.
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
    /// Cycle and life.
    pub life: Life,
    /// Defaults of a study of this scene.
    pub study: StudySettings,
    /// Setting at which an evaluation is made unless another one is asked for.
    #[serde(default)]
    pub accuracy: NamedAccuracy,
    /// Whose simulator evaluates a sample, if not this program's own. Such a scene has no bodies, joints or loads, and its
    /// random variables are the simulator's inputs.
    #[serde(default)]
    pub simulator: Option<ExternalSimulator>,
}

/// A simulator of somebody else.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ExternalSimulator {
    /// How it is asked.
    pub kind: SimulatorKind,
    /// How long one evaluation may take [s].
    pub timeout: f64,
}

/// How a simulator is asked.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum SimulatorKind {
    /// A program of this machine, over its standard input and output.
    Program(Program),
    /// A server, by the UM-Bridge protocol.
    UmBridge(UmBridgeModel),
}

/// A program that answers lines of JSON.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Program {
    /// Program and arguments, not empty.
    pub command: Vec<String>,
    /// Folder it runs in.
    pub folder: String,
}

/// A model of a UM-Bridge server.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct UmBridgeModel {
    /// Address without a `/` at its end, e.g. `http://127.0.0.1:4242`.
    pub url: String,
    /// Name of the model.
    pub model: String,
    /// What the model is told with every request.
    pub config: toml::Table,
}

impl Scene {
    /// Lever arm of a place: its vector from the base point of its body, in the body's frame `(2,)` [m].
    pub fn arm(&self, place: &Attachment) -> [f64; 2] {
        let origin = self.bodies[place.body].motion.base_point();
        [place.position[0] - origin[0], place.position[1] - origin[1]]
    }
}

/// A rigid body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Body {
    /// Unique name.
    pub name: String,
    /// How it moves.
    pub motion: Motion,
    /// Named points, in the body's own frame, whose origin is the body's reference point.
    pub points: Vec<Point>,
}

/// A named point of a body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Name, unique in its body.
    pub name: String,
    /// Position in the body's frame `(2,)` [m].
    pub position: [f64; 2],
}

/// How a body moves.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Motion {
    /// Part of the frame: its frame coincides with the global one.
    Fixed,
    /// Turns about its reference point as prescribed; costs no unknowns.
    Driven {
        /// Position of the reference point `(2,)` [m].
        position: [f64; 2],
        /// Its angle as a function of time.
        drive: Drive,
        /// What it weighs, if the torque that drives it or its energy are of interest; else it counts as
        /// massless.
        inertia: Option<DrivenInertia>,
    },
    /// Three unknowns.
    Free {
        /// Mass [kg].
        mass: f64,
        /// Moment of inertia about the centre of mass [kg m^2].
        inertia: f64,
        /// Centre of mass in the body's frame `(2,)` [m].
        centre_of_mass: [f64; 2],
        /// Approximate position of the reference point at time zero `(2,)` [m].
        start_position: [f64; 2],
        /// Approximate angle at time zero [rad].
        start_angle: f64,
        /// Velocity of the reference point at time zero, as far as drives and joints leave it free `(2,)` [m/s].
        start_velocity: [f64; 2],
        /// Angular velocity at time zero, likewise [rad/s].
        start_speed: f64,
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

/// Inertia of a driven body.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct DrivenInertia {
    /// Mass [kg].
    pub mass: f64,
    /// Moment of inertia about the centre of mass [kg m^2].
    pub inertia: f64,
    /// Centre of mass in the body's frame, whose origin is the axis `(2,)` [m].
    pub centre_of_mass: [f64; 2],
}

/// Failure when the output has reached the threshold, g = threshold - output <= 0; or has fallen to it,
/// g = output - threshold <= 0.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LimitState {
    /// Unique name, e.g. `wear`.
    pub name: String,
    /// Index into [`Scene::outputs`].
    pub output: usize,
    /// Threshold in the unit of the output (SI).
    pub threshold: f64,
    /// On which side of the threshold it has failed.
    #[serde(default)]
    pub fails: Fails,
}

/// A side of a threshold.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Fails {
    /// At the threshold and above.
    #[default]
    Above,
    /// At the threshold and below.
    Below,
}

/// Cycle and life.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Life {
    /// Duration of one cycle; 0 for an external simulator, of which it is not known [s].
    pub period: f64,
    /// Cycles to simulate.
    pub cycles: u32,
    /// Outputs are reported every so many cycles; `cycles` is a multiple of it.
    pub checkpoint_every: u32,
    /// Cycles run before the first measured one, so that the motion has settled; none for a motion that is to be
    /// seen from its start.
    pub settle_cycles: u32,
}

impl Life {
    /// The checkpoints: every, 2 every, ..., cycles.
    pub fn checkpoints(&self) -> Vec<u32> {
        (1..=self.cycles / self.checkpoint_every).map(|k| k * self.checkpoint_every).collect()
    }
}

/// Defaults of a study.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct StudySettings {
    /// Monte Carlo population.
    pub population: usize,
    /// Size of the initial design.
    pub initial: usize,
    /// Points proposed per round; set by the study, never by the number of workers.
    pub batch: usize,
    /// Budget of evaluations.
    pub max_evaluations: usize,
    /// Seed of every random draw.
    pub seed: u64,
}

impl Default for StudySettings {
    /// What a scene without `[study]` gets.
    fn default() -> Self {
        StudySettings { population: 100_000, initial: 120, batch: 12, max_evaluations: 600, seed: 1 }
    }
}
