//! The resolved scene: what remains of a scene file after expressions, units, names and ranges were checked.
//!
//! Planar, SI units, angles counter-clockwise from +x. Bodies are referred to by index into [`Scene::bodies`].

use crate::random::RandomVariable;
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
    /// Limit states over the outputs.
    pub limit_states: Vec<LimitState>,
    /// Cycle and life.
    pub life: Life,
    /// Defaults of a study of this scene.
    pub study: StudySettings,
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
    /// Turns about its reference point at constant speed; costs no unknowns.
    Driven {
        /// Position of the reference point `(2,)` [m].
        position: [f64; 2],
        /// Angle at time zero [rad].
        start_angle: f64,
        /// Angular velocity, counter-clockwise positive [rad/s].
        speed: f64,
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
    },
}

/// A point of a body, by position in the body's frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Attachment {
    /// Index into [`Scene::bodies`].
    pub body: usize,
    /// Position in that body's frame `(2,)` [m].
    pub position: [f64; 2],
}

/// A joint between two bodies.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Joint {
    /// Unique name.
    pub name: String,
    /// Journal side (for an ideal joint: first body).
    pub journal: Attachment,
    /// Bushing side (for an ideal joint: second body). The wear profile lives in this body's frame.
    pub bushing: Attachment,
    /// What the joint is.
    pub kind: JointKind,
}

/// Kinds of joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum JointKind {
    /// Revolute joint without clearance.
    IdealRevolute,
    /// Journal in a larger bushing.
    Clearance(Clearance),
}

/// A revolute joint with clearance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Clearance {
    /// Radius of the journal, R1 [m].
    pub journal_radius: f64,
    /// Initial radius of the bushing, R2 > R1 [m].
    pub bushing_radius: f64,
    /// Width of the bushing, L [m].
    pub width: f64,
    /// Material of the journal.
    pub journal_material: Material,
    /// Material of the bushing.
    pub bushing_material: Material,
    /// Law of the normal force.
    pub contact_law: ContactLaw,
    /// Dissipation in contact.
    pub contact_damping: ContactDamping,
    /// Viscous film between journal and bushing, on the relative velocity of the centres [N s/m].
    pub film_damping: f64,
    /// Coulomb friction coefficient, mu [1].
    pub friction: f64,
    /// Speed at which tanh regularises the friction, v_0 [m/s].
    pub friction_speed: f64,
    /// Archard wear coefficient K_H [1/Pa]; zero: the joint does not wear.
    pub wear_coefficient: f64,
    /// Number of control points of the wear profile.
    pub control_points: usize,
}

impl Clearance {
    /// Radial clearance c = R2 - R1 [m].
    pub fn radial_clearance(&self) -> f64 {
        self.bushing_radius - self.journal_radius
    }
}

/// An isotropic elastic material.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Material {
    /// Young's modulus [Pa].
    pub elastic_modulus: f64,
    /// Poisson's ratio [1].
    pub poisson_ratio: f64,
}

/// Law of the normal contact force.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum ContactLaw {
    /// F = K_n delta^1.5 with the penetration measured in the direction of the eccentricity.
    LocalHertz,
    /// Linear elastic (Winkler) foundation along the bore.
    Foundation,
}

/// Dissipation of the contact.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum ContactDamping {
    /// None.
    None,
    /// F_N = F_el (1 + D delta_dot), never below zero.
    HuntCrossley {
        /// Damping factor D [s/m].
        factor: f64,
    },
}

/// A load.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Load {
    /// Spring acting along a fixed direction d on a point p of a body against an anchor point a of another:
    /// with y = d . (p - a), the force on p is -stiffness (y - free_length) d, and its opposite acts on a.
    DirectionalSpring {
        /// Name.
        name: String,
        /// Where it acts.
        at: Attachment,
        /// What y is measured from.
        anchor: Attachment,
        /// Unit direction d in the global frame `(2,)` [1].
        direction: [f64; 2],
        /// Stiffness [N/m].
        stiffness: f64,
        /// y at which the force vanishes, y_0 [m].
        free_length: f64,
    },
    /// Constant force on a point of a body, in the global frame.
    ConstantForce {
        /// Name.
        name: String,
        /// Where it acts.
        at: Attachment,
        /// Force `(2,)` [N].
        force: [f64; 2],
    },
    /// Constant torque on a body.
    ConstantTorque {
        /// Name.
        name: String,
        /// Index of the body.
        body: usize,
        /// Torque, counter-clockwise positive [N m].
        torque: f64,
    },
}

/// A quantity returned at every checkpoint of life.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Output {
    /// Unique name, e.g. `max_wear_depth`.
    pub name: String,
    /// What it is.
    pub kind: OutputKind,
}

/// Kinds of output.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum OutputKind {
    /// Largest wear depth over the control points of these joints, delta_0 [m].
    LargestWear {
        /// Indices into [`Scene::joints`].
        joints: Vec<usize>,
    },
    /// Largest over a cycle of |s_a omega_a - s_b omega_b|, gamma_max [rad/s].
    AngularVelocityDifference {
        /// First body and sign of its angle.
        a: SignedBody,
        /// Second body and sign of its angle.
        b: SignedBody,
    },
}

/// A body with the sense in which its angle is reported.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SignedBody {
    /// Index into [`Scene::bodies`].
    pub body: usize,
    /// +1 or -1.
    pub sign: f64,
    /// What a reader calls it, e.g. `right`.
    pub label: String,
}

/// Failure when the output has reached the threshold: g = threshold - output <= 0.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LimitState {
    /// Unique name, e.g. `wear`.
    pub name: String,
    /// Index into [`Scene::outputs`].
    pub output: usize,
    /// Threshold in the unit of the output (SI).
    pub threshold: f64,
}

/// Cycle and life.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Life {
    /// Duration of one cycle [s].
    pub period: f64,
    /// Cycles to simulate.
    pub cycles: u32,
    /// Outputs are reported every so many cycles; `cycles` is a multiple of it.
    pub checkpoint_every: u32,
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
