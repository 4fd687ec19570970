//! What a drawing of a mechanism shows, as data in SI: bodies, joints, loads and drives in one position of the cycle, for the
//! drawing, the sketch in the terminal and other programs.

use crate::presentation::report::format::{exactly_with_unit, seven_digits, unit_scale};
use crate::presentation::report::mechanism::{self, Circle, Pose, of_body, place};
use common::scene::{Drive, Form, Load, Motion, OutputUnit, Scene, Table, Units, Value, filled};
use serde::Serialize;

/// Usual unit of lengths; a shorter or longer length has one that suits it.
pub const LENGTH_UNIT: &str = "mm";

/// Distance below which two points of a drawing are one [m].
const SAME_POINT: f64 = 1e-9;

/// A mechanism in one position.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DrawnMechanism {
    /// Bodies in the order of the scene.
    pub bodies: Vec<DrawnBody>,
    /// Joints in the order of the scene.
    pub joints: Vec<DrawnJoint>,
    /// Loads in the order of the scene.
    pub loads: Vec<DrawnLoad>,
    /// Drives of the driven bodies.
    pub drives: Vec<DrawnDrive>,
    /// Acceleration of gravity `(2,)` [m/s^2].
    pub gravity_m_s2: [f64; 2],
    /// Unit of the scale.
    #[serde(skip)]
    pub length_unit: String,
}

/// Motion of a body that does not move.
pub const FIXED: &str = "fixed";

/// Kind of a hinge with clearance.
pub const CLEARANCE: &str = "clearance";

/// Kinds of joints with their symbol in the drawing, their sign in a sketch, and what they are; without a sign, the lines of the joint show it.
pub const SYMBOLS: [(&str, &str, Option<char>, &str); 12] = [
    (CLEARANCE, "circle with a dot", Some('●'), "hinge with clearance"),
    ("revolute", "circle", Some('o'), "ideal hinge"),
    ("prismatic", "block on a rail", Some('■'), "slider"),
    ("guide", "block on a rail", Some('■'), "slider in a guide with clearance"),
    ("fixed", "square", Some('+'), "rigid connection"),
    ("slot", "block on a line", Some('o'), "pin in a slot"),
    ("gear", "dashed circles", None, "pitch circles of gears"),
    ("internal-gear", "dashed circles", None, "pitch circles of an internal gear"),
    ("belt", "dashed circles and lines", None, "belt"),
    ("rack", "dashed circle and line", None, "wheel and rack"),
    ("cam", "dashed outline", None, "cam"),
    ("linear-drive", "dashed cylinder", None, "linear drive"),
];

/// A body in its place.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DrawnBody {
    /// Name in the scene.
    pub name: String,
    /// Fixed, driven or free.
    pub motion: &'static str,
    /// Corners of the body, without repeated points `(p, 2)` [m].
    pub outline_m: Vec<[f64; 2]>,
    /// Points where the body is held by the ground `(s, 2)` [m].
    pub supports_m: Vec<[f64; 2]>,
}

/// A joint in its place.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DrawnJoint {
    /// Name in the scene.
    pub name: String,
    /// `revolute`, `clearance`, `gear`, ... as in scenes.
    pub kind: &'static str,
    /// Position of the first body's point, the journal `(2,)` [m].
    pub at_m: [f64; 2],
    /// Ends of the rail of a prismatic joint or a guide `(2, 2)` [m]: where the first body's point goes through the cycle.
    pub rail_m: Option<[[f64; 2]; 2]>,
    /// True if the rail belongs to a fixed body.
    pub on_ground: bool,
    /// Lines of strands, racks, cams and linear drives, each `(n, 2)` [m].
    pub shapes_m: Vec<Vec<[f64; 2]>>,
    /// Centres and radii of journal and bore, or of wheels [m].
    pub circles_m: Vec<Circle>,
}

impl DrawnJoint {
    /// Lines of wheels and of all other shapes, each `(n, 2)` [m].
    pub fn lines(&self) -> Vec<Vec<[f64; 2]>> {
        let wheels = self.circles_m.iter().filter(|_| self.kind != CLEARANCE);
        let wheels = wheels.map(|(centre, radius)| mechanism::around(|_| *radius, *centre));
        wheels.chain(self.shapes_m.iter().cloned()).collect()
    }
}

/// A load in its place.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DrawnLoad {
    /// Name in the scene.
    pub name: String,
    /// Kind and size in words, e.g. `force 3 N`.
    pub size: String,
    /// Symbol and place of the load.
    pub symbol: LoadSymbol,
}

/// Symbol of a load.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum LoadSymbol {
    /// An arrow: point of application [m], direction [1].
    Arrow([f64; 2], [f64; 2]),
    /// A curved arrow: centre [m]; true if counter-clockwise.
    Turn([f64; 2], bool),
    /// A coil between two points [m].
    Coil([f64; 2], [f64; 2]),
    /// A spiral at a point [m].
    Spiral([f64; 2]),
}

/// A drive in its place.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DrawnDrive {
    /// Name of the driven body.
    pub body: String,
    /// Axis of the body `(2,)` [m].
    pub pivot_m: [f64; 2],
    /// Angle of the body in the drawn position in degrees.
    pub angle_deg: f64,
    /// Speed in words, e.g. `900 r/min`.
    pub speed: String,
    /// True if the body begins counter-clockwise.
    pub counter_clockwise: bool,
}

/// Mean of some points; the origin without any.
pub fn middle_of(points: &[[f64; 2]]) -> [f64; 2] {
    let n = points.len().max(1) as f64;
    points.iter().fold([0.0; 2], |m, p| [m[0] + p[0] / n, m[1] + p[1] / n])
}

impl DrawnMechanism {
    /// The mechanism in position `shown` of a cycle, given as poses per instant and body `(n, bodies)`; `None` without an
    /// instant of that number, for poses that are not finite, or if all points coincide.
    pub fn new(scene: &Scene, cycle: &[Vec<Pose>], shown: usize) -> Option<Self> {
        let poses = cycle.get(shown)?;
        let bodies = scene.bodies.iter().enumerate().map(|(index, body)| {
            let placed = |points: Vec<[f64; 2]>| points.iter().map(|p| of_body(&poses[index], *p)).collect();
            let motion = match body.motion {
                Motion::Fixed => FIXED,
                Motion::Driven { .. } => "driven",
                Motion::Free { .. } => "free",
            };
            DrawnBody {
                name: body.name.clone(),
                motion,
                outline_m: placed(mechanism::outline(scene, index)),
                supports_m: placed(mechanism::supports(scene, index)),
            }
        });
        let joints = (0..scene.joints.len()).map(|index| joint(scene, cycle, poses, index));
        let loads = scene.loads.iter().map(|load| self::load(scene, poses, load));
        let drives = scene.bodies.iter().zip(poses).filter_map(|(body, (pivot, angle))| {
            let Motion::Driven { drive, .. } = &body.motion else { return None };
            let unit = scene.units.of(OutputUnit::AngularVelocity);
            let (speed, counter_clockwise) = drive_in_words(drive, &unit);
            let angle_deg = angle.to_degrees().rem_euclid(360.0);
            Some(DrawnDrive { body: body.name.clone(), pivot_m: *pivot, angle_deg, speed, counter_clockwise })
        });
        let drawn = Self {
            bodies: bodies.collect(),
            joints: joints.collect(),
            loads: loads.collect(),
            drives: drives.collect(),
            gravity_m_s2: scene.gravity,
            length_unit: scene.units.symbol(LENGTH_UNIT).to_owned(),
        };
        let [low, high] = drawn.extent();
        let size = (high[0] - low[0]).max(high[1] - low[1]);
        (size.is_finite() && size > SAME_POINT).then_some(drawn)
    }

    /// True if it has a joint of this kind.
    pub fn has(&self, kind: &str) -> bool {
        self.joints.iter().any(|joint| joint.kind == kind)
    }

    /// True if the ground holds one of its bodies.
    pub fn has_supports(&self) -> bool {
        self.bodies.iter().any(|body| !body.supports_m.is_empty())
    }

    /// Lower left and upper right corner of bodies, joints and rails `(2, 2)` [m].
    pub fn extent(&self) -> [[f64; 2]; 2] {
        let bodies = self.bodies.iter().flat_map(|body| body.outline_m.iter().chain(&body.supports_m));
        let joints = self.joints.iter().map(|joint| &joint.at_m);
        let rails = self.joints.iter().flat_map(|joint| joint.rail_m.iter().flatten());
        let coils = self.loads.iter().flat_map(|load| match &load.symbol {
            LoadSymbol::Coil(a, b) => vec![a, b],
            _ => vec![],
        });
        let shapes = self.joints.iter().flat_map(DrawnJoint::lines).flatten();
        mechanism::extent(bodies.chain(joints).chain(rails).chain(coils).copied().chain(shapes))
    }
}

fn joint(scene: &Scene, cycle: &[Vec<Pose>], poses: &[Pose], index: usize) -> DrawnJoint {
    let joint = &scene.joints[index];
    let fixed = scene.bodies[joint.bushing.body].motion == Motion::Fixed;
    let rail_m =
        mechanism::rail(joint, cycle).map(|ends| ends.map(|p| of_body(&poses[joint.bushing.body], p)));
    DrawnJoint {
        name: joint.name.clone(),
        kind: joint.kind.words().0,
        at_m: place(poses, &joint.journal),
        on_ground: fixed && rail_m.is_some(),
        rail_m,
        shapes_m: mechanism::shapes(poses, joint),
        circles_m: mechanism::circles(poses, joint),
    }
}

fn load(scene: &Scene, poses: &[Pose], load: &Load) -> DrawnLoad {
    let middle = |body: usize| of_body(&poses[body], middle_of(&mechanism::outline(scene, body)));
    // Without the name, which comes first.
    let values: Vec<Value> = load.values().into_iter().skip(1).map(|(_, value)| value).collect();
    let symbol = match &values[..] {
        // Along its direction a spring ends at the height of its anchor, across it nowhere in particular.
        [Value::Place(at), Value::Place(anchor), Value::Pair([dx, dy]), ..] => {
            let (from, [x, y]) = (place(poses, at), place(poses, anchor));
            let height = (from[0] - x) * dx + (from[1] - y) * dy;
            LoadSymbol::Coil(from, [from[0] - height * dx, from[1] - height * dy])
        }
        [Value::Place(a), Value::Place(b), ..] => LoadSymbol::Coil(place(poses, a), place(poses, b)),
        [Value::Place(at), Value::Pair(direction), Value::Curve(size)] => {
            let sign = largest(&size.table.value).signum();
            LoadSymbol::Arrow(place(poses, at), direction.map(|d| sign * d))
        }
        // A drag acts against the motion, to either side; it is drawn along its direction.
        [Value::Place(at), Value::Pair(along), ..] => LoadSymbol::Arrow(place(poses, at), *along),
        [Value::Body(a), Value::Body(b), ..] => {
            let joins = |body: usize, other: usize| {
                scene.joints.iter().find(|j| j.journal.body == body && j.bushing.body == other)
            };
            let shared = joins(*a, *b).or_else(|| joins(*b, *a));
            LoadSymbol::Spiral(shared.map_or_else(|| middle(*a), |joint| place(poses, &joint.journal)))
        }
        [Value::Body(body), Value::Curve(size)] => {
            LoadSymbol::Turn(middle(*body), largest(&size.table.value) >= 0.0)
        }
        [Value::Body(body), Value::Number(size), ..] => LoadSymbol::Turn(middle(*body), *size >= 0.0),
        other => unreachable!("no symbol for a load with the values {other:?}"),
    };
    DrawnLoad { name: load.name(), size: size_of(load, &scene.units), symbol }
}

/// The value that is largest in size, with its sign; 0 for none.
fn largest(values: &[f64]) -> f64 {
    values.iter().copied().fold(0.0, |most: f64, value| if value.abs() > most.abs() { value } else { most })
}

/// Smallest and largest value of a table, as numbers.
fn range(table: &Table, scale: f64) -> String {
    let [least, most] = table.range().map(|value| seven_digits(value * scale));
    format!("{least} to {most}")
}

/// A drive in words, and whether it begins counter-clockwise.
fn drive_in_words(drive: &Drive, unit: &OutputUnit) -> (String, bool) {
    match drive {
        Drive::ConstantSpeed { speed, .. } => (exactly_with_unit(unit, speed.abs()), *speed >= 0.0),
        Drive::Angle(table) => {
            let first_change = table.value.windows(2).map(|pair| pair[1] - pair[0]).find(|step| *step != 0.0);
            let angles = range(table, 1f64.to_degrees());
            (format!("angle {angles} deg by table"), first_change.unwrap_or(1.0) > 0.0)
        }
        Drive::Speed { table, .. } => {
            let speeds = unit.after(&range(table, unit.to_shown(1.0)));
            (format!("{speeds} by table"), largest(&table.value) >= 0.0)
        }
    }
}

/// Size of a load in words.
fn size_of(load: &Load, units: &Units) -> String {
    let values = load.values();
    let is_zero = |value: &Value| *value == Value::Number(0.0);
    filled(load.kind().words[0].1, |keys| {
        let mut named = keys.split('|').filter_map(|name| values.iter().find(|(key, _)| key.name == name));
        let shown = named.clone().find(|(_, value)| !is_zero(value)).or_else(|| named.next_back());
        shown.map_or_else(String::new, |(key, value)| size(key.form, value, units))
    })
}

/// The size of a value of this form, with its unit.
fn size(form: Form, value: &Value, units: &Units) -> String {
    let unit = match form {
        Form::Number(kind, _) | Form::NumberOr(kind, ..) | Form::Pair(kind) | Form::Curve(kind) => {
            units.symbol(kind.si)
        }
        _ => "",
    };
    let scale = 1.0 / unit_scale(unit);
    let number = match value {
        Value::Number(number) => seven_digits(scale * number.abs()),
        Value::Pair([x, y]) => seven_digits(scale * x.hypot(*y)),
        Value::Curve(curve) => range(&curve.table, scale),
        _ => String::new(),
    };
    if unit.is_empty() { number } else { format!("{number} {}", unit.replace("^2", "²")) }
}
