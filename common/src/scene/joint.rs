//! Joints between bodies: ideal ones and those with clearance.

use super::choice::choice;
use super::values::{Attachment, Drive, Table};
use serde::{Deserialize, Serialize};

/// A joint between two bodies.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Joint {
    /// Name, unique in its scene.
    pub name: String,
    /// Journal side (for an ideal joint: first body).
    pub journal: Attachment,
    /// Bushing side (for an ideal joint: second body). The wear profile lives in this body's frame.
    pub bushing: Attachment,
    /// Ideal or with clearance.
    pub kind: JointKind,
    /// Coulomb friction of an ideal revolute or prismatic joint; `None`: it has none. A joint with clearance has its own.
    pub friction: Option<IdealFriction>,
}

/// Coulomb friction of an ideal joint: mu tanh(v_t / v_0) times the normal force, against the sliding speed v_t [m/s].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct IdealFriction {
    /// Coulomb friction coefficient, mu [1].
    pub coefficient: f64,
    /// Speed at which tanh regularises the friction, v_0 [m/s].
    pub speed: f64,
    /// Radius of the pin of a revolute joint, or length of the guide that bears a prismatic joint's slider [m].
    pub size: f64,
}

/// Kinds of joint. Ideal ones are constraints; their second body is the one in whose frame directions are given.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum JointKind {
    /// Revolute joint without clearance: the two points coincide.
    Revolute,
    /// Translational joint: the first body's point slides along a line through the second body's point, and the
    /// two bodies do not turn against each other.
    Prismatic {
        /// Direction of the line in the second body's frame [rad].
        axis: f64,
        /// Angle of the first body minus that of the second [rad].
        angle: f64,
    },
    /// The two points coincide and the bodies do not turn against each other.
    Fixed {
        /// Angle of the first body minus that of the second [rad].
        angle: f64,
    },
    /// A journal in a larger bushing.
    Clearance(Clearance),
    /// A slider in a wider guide.
    Guide(GuideClearance),
    /// The first body's point lies on a line through the second body's point; both bodies turn.
    Slot {
        /// Direction of the line in the second body's frame [rad].
        axis: f64,
    },
    /// The distance of the two points is a given function of time [m].
    LinearDrive(Drive),
    /// Gear pair, rack or belt.
    Mesh(Mesh),
    /// The first body's point is at a distance along `direction` from the second body's that depends on the angle of the second body.
    Cam {
        /// Direction in the global frame `(2,)` [1].
        direction: [f64; 2],
        /// Distance [m] over the angle of the second body [rad]: a cubic spline.
        lift: Table,
    },
}

/// The word of a kind of joint, its keys of the places on its two bodies, and its key of the length on which the friction of an ideal
/// joint acts.
type JointWords = (&'static str, [&'static str; 2], Option<&'static str>);

impl JointKind {
    /// The words of all kinds in a scene.
    pub const WORDS: [JointWords; 12] = [
        ("revolute", ["a", "b"], Some("pin_radius")),
        ("prismatic", ["a", "b"], Some("guide_length")),
        ("fixed", ["a", "b"], None),
        ("clearance", ["journal", "bushing"], None),
        ("guide", ["slider", "guide"], None),
        ("slot", ["a", "b"], None),
        ("linear-drive", ["a", "b"], None),
        ("gear", ["a", "b"], None),
        ("internal-gear", ["a", "b"], None),
        ("belt", ["a", "b"], None),
        ("rack", ["a", "b"], None),
        ("cam", ["a", "b"], None),
    ];

    /// The words of the kind.
    pub fn words(&self) -> JointWords {
        Self::WORDS[match self {
            JointKind::Revolute => 0,
            JointKind::Prismatic { .. } => 1,
            JointKind::Fixed { .. } => 2,
            JointKind::Clearance(_) => 3,
            JointKind::Guide(_) => 4,
            JointKind::Slot { .. } => 5,
            JointKind::LinearDrive(_) => 6,
            JointKind::Mesh(Mesh { form, .. }) => 7 + *form as usize,
            JointKind::Cam { .. } => 11,
        }]
    }

    /// True for a joint with clearance, a journal in its bushing or a slider in its guide; false for an ideal one.
    pub fn has_clearance(&self) -> bool {
        matches!(self, JointKind::Clearance(_) | JointKind::Guide(_))
    }
}

/// A translational joint with clearance: a rectangular slider between the two parallel faces of a straight guide.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GuideClearance {
    /// Direction of the guide in the frame of its body [rad].
    pub axis: f64,
    /// Angle of the slider's body minus that of the guide's where the slider lies along the guide [rad].
    pub angle: f64,
    /// Length of the slider along the guide [m].
    pub length: f64,
    /// Height of the slider [m].
    pub height: f64,
    /// Width of the contact, normal to the plane [m].
    pub width: f64,
    /// Clearance c between slider and guide on each side [m].
    pub clearance: f64,
    /// Ends of the guide along its direction, from its point, the first one below the second `(2,)` [m].
    pub reach: [f64; 2],
    /// Material of the slider.
    pub slider_material: Material,
    /// Material of the guide.
    pub guide_material: Material,
    /// Dissipation of the contact.
    pub contact_damping: ContactDamping,
    /// Coulomb friction coefficient, mu [1].
    pub friction: f64,
    /// Speed at which tanh regularises the friction, v_0 [m/s].
    pub friction_speed: f64,
    /// Wear of the guide and of the slider; `None`: neither wears.
    pub wear: Option<GuideWear>,
}

impl GuideClearance {
    /// Wear coefficients of guide and slider, zero for a surface that does not wear `(2,)` [1/Pa].
    pub fn wear_coefficients(&self) -> [f64; 2] {
        self.wear.as_ref().map_or([0.0; 2], GuideWear::coefficients)
    }
}

/// Wear of the faces of a guide and of its slider.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GuideWear {
    /// Surfaces that wear; the guide is in the place of the bushing, the slider in that of the journal.
    pub wears: WearingSurfaces,
    /// Archard wear coefficient K_H [1/Pa] of the surface that wears, of the guide if both do; zero: it does not wear.
    pub coefficient: f64,
    /// Wear coefficient of the slider if both surfaces wear [1/Pa]; `None`: that of the guide.
    pub slider_coefficient: Option<f64>,
    /// Number of control points of each face of the guide, of each face of the slider if the slider alone wears.
    pub control_points: usize,
}

impl GuideWear {
    /// Wear coefficients of guide and slider, zero for a surface that does not wear `(2,)` [1/Pa].
    pub fn coefficients(&self) -> [f64; 2] {
        self.wears.coefficients(self.coefficient, self.slider_coefficient)
    }
}

/// Number of control points of a wear profile.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum ControlPoints {
    /// As the scene says.
    Number(usize),
    /// Chosen by each evaluation from the contact arc of its first cycle.
    ByArc,
}

impl ControlPoints {
    /// Number where the scene says none.
    pub const DEFAULT: usize = 36;
    /// Most control points: more are finer than any contact arc.
    pub const MOST: usize = 360;

    /// The number given, or that of the profiles whose contact arc is still to be found.
    pub const fn number(self) -> usize {
        match self {
            ControlPoints::Number(number) => number,
            ControlPoints::ByArc => Self::DEFAULT,
        }
    }
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
    /// Law of the normal contact force.
    pub contact_law: ContactLaw,
    /// Dissipation of the contact.
    pub contact_damping: ContactDamping,
    /// Viscous film between journal and bushing, on the relative velocity of the centres [N s/m].
    pub film_damping: f64,
    /// Coulomb friction coefficient, mu [1].
    pub friction: f64,
    /// Speed at which tanh regularises the friction, v_0 [m/s].
    pub friction_speed: f64,
    /// Surfaces that wear.
    pub wears: WearingSurfaces,
    /// Archard wear coefficient K_H [1/Pa] of the surface that wears, of the bushing if both do; zero: it does not wear.
    pub wear_coefficient: f64,
    /// Wear coefficient of the journal if both surfaces wear [1/Pa]; `None`: that of the bushing.
    pub journal_wear_coefficient: Option<f64>,
    /// Control points of each wear profile.
    pub control_points: ControlPoints,
    /// Thickness of the bushing's wall, if it may be worn through [m].
    pub wall: Option<f64>,
}

impl Clearance {
    /// Radial clearance c = R2 - R1 [m].
    pub fn radial_clearance(&self) -> f64 {
        self.bushing_radius - self.journal_radius
    }

    /// Wear coefficients of bushing and journal, zero for a surface that does not wear `(2,)` [1/Pa].
    pub fn wear_coefficients(&self) -> [f64; 2] {
        self.wears.coefficients(self.wear_coefficient, self.journal_wear_coefficient)
    }
}

/// Surfaces of a joint that wear.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum WearingSurfaces {
    /// The bore of the bushing; the journal stays round.
    #[default]
    Bushing,
    /// The journal; the bore stays round.
    Journal,
    /// Both, each with its own profile.
    Both,
}

impl WearingSurfaces {
    /// Words of the choices for a hinge in a scene file.
    pub const OF_HINGE: [(&'static str, Self); 3] =
        [("bushing", Self::Bushing), ("journal", Self::Journal), ("both", Self::Both)];

    /// Words of the choices for a guide in a scene file.
    pub const OF_GUIDE: [(&'static str, Self); 3] =
        [("guide", Self::Bushing), ("slider", Self::Journal), ("both", Self::Both)];

    /// Wear coefficients of both surfaces of a joint, the bushing's first, from that of the joint and that of a journal which wears too,
    /// zero for a surface that does not wear `(2,)` [1/Pa].
    pub(super) fn coefficients(self, own: f64, of_journal: Option<f64>) -> [f64; 2] {
        match self {
            Self::Bushing => [own, 0.0],
            Self::Journal => [0.0, own],
            Self::Both => [own, of_journal.unwrap_or(own)],
        }
    }
}

/// Kinds of meshing, in the order of their words in [`JointKind::WORDS`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum MeshForm {
    /// Two wheels that turn in opposite directions.
    Gear,
    /// A wheel inside another one.
    InternalGear,
    /// Two pulleys and the strand on the left of the line from a to b.
    Belt,
    /// A straight rack, of which the place a is on the pitch line, and a wheel about the place b.
    Rack,
}

/// A gear pair, a rack or a belt: an ideal joint of one condition on two turning bodies.
///
/// phi = u . d + rho_a theta_a + rho_b theta_b is constant, d the vector from the place of b to that of a [m], u the fixed direction of the line
/// of action [1], rho the lever arms of its force [m]. The force along u on a, its opposite on b and their moments are those of teeth on the flank
/// that the sign of the pressure angle names, or of the taut strand of a belt, so that the bearings carry them; a force of the other sign is one
/// that these cannot transmit. Valid while the distance between the centres changes little, as in bearings with clearance.
///
/// # Source
/// Norton (2011), Design of Machinery, section 9.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Mesh {
    /// Wheels, a rack or a belt.
    pub form: MeshForm,
    /// Pitch radii of a and b; of a rack zero `(2,)` [m].
    pub radii: [f64; 2],
    /// Angle of the line of action to the common tangent of the pitch circles [rad].
    pub pressure_angle: f64,
    /// Direction u of the line of action in the global frame, that of the force on a `(2,)` [1].
    pub direction: [f64; 2],
    /// Lever arms rho of the force on a and on b, counter-clockwise positive `(2,)` [m].
    pub arms: [f64; 2],
    /// Value of phi that the joint keeps [m].
    pub value: f64,
    /// Distance by which the pitch lines miss each other, below zero where they overlap; of a belt the overlap of its pulleys [m].
    pub gap: f64,
}

/// An isotropic elastic material.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Material {
    /// Young's modulus [Pa].
    pub elastic_modulus: f64,
    /// Poisson's ratio [1].
    pub poisson_ratio: f64,
}

choice! {
    /// Law of the normal contact force.
    pub enum ContactLaw;
    /// F = K_n delta^1.5 with the penetration measured in the direction of the eccentricity.
    "local-hertz" => LocalHertz "F = K delta^1.5 along the eccentricity; cheap, but on a worn bore it feeds energy into vibration"
    /// Linear elastic (Winkler) foundation along the bore.
    "foundation" => Foundation
        "elastic foundation along the bore; stays conservative as the bore wears, with more worn volume than K F s on wide arcs"
}

/// Dissipation of the contact.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum ContactDamping {
    /// No dissipation: D = 0.
    None,
    /// F_N = F_el (1 + D delta_dot), never below zero, D given.
    HuntCrossley {
        /// Damping factor D [s/m].
        factor: f64,
    },
    /// F_N as above with D = C(e) / max(v_0, least_speed), e the coefficient of restitution and v_0 the approach speed at
    /// which the contact began.
    Restitution {
        /// The function C(e).
        law: RestitutionLaw,
        /// Coefficient of restitution e in (0, 1] [1].
        coefficient: f64,
        /// Lower bound of the approach speed in the formula [m/s].
        least_speed: f64,
    },
}

choice! {
    /// The damping factor of an impact, C(e) = D v_0 [1], from the coefficient of restitution e; explained by its authors.
    ///
    /// # Source
    /// Lankarani, Nikravesh (1990), A contact force model with hysteresis damping for impact analysis of multibody systems;
    /// Hunt, Crossley (1975), Coefficient of restitution interpreted as damping in vibroimpact; Flores, Machado, Silva,
    /// Martins (2011), On the continuous contact force models for soft materials in multibody dynamics.
    pub enum RestitutionLaw;
    /// C(e) = 3 (1 - e^2) / 4.
    "lankarani-nikravesh" => LankaraniNikravesh "Lankarani-Nikravesh"
    /// C(e) = 3 (1 - e) / 2.
    "hunt-crossley" => HuntCrossley "Hunt-Crossley"
    /// C(e) = 8 (1 - e) / (5 e).
    "flores" => Flores "Flores"
}
