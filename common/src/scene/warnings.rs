//! Warnings about a scene: what is valid but most likely not meant.
//!
//! Warnings about values whose magnitude no mechanism has, usually a wrong unit: masses and inertias against the size of a body,
//! clearances against their hinge, elastic moduli, wear coefficients, speeds, gravity.
//!
//! The bounds leave out what any material or machine can have; a value beyond them is wrong by a factor of ten at least.

use super::joint::{Clearance, GuideClearance, Joint, JointKind, Material, Mesh, MeshForm};
use super::load::Load;
use super::model::{Body, Motion, Scene};
use super::monotone::monotone_integral;
use super::output::OutputKind;
use super::values::{Curve, Drive, Over};
use serde::Serialize;
use std::f64::consts::PI;
use std::fmt;

/// A warning and the key it belongs to.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Warning {
    /// Path of the key, e.g. `loads.push.size`.
    pub key: String,
    /// What is likely not meant, and what to write instead.
    pub message: String,
}

impl Warning {
    /// A warning that belongs to this key.
    pub(super) fn new(key: String, message: impl Into<String>) -> Self {
        Self { key, message: message.into() }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.key, self.message)
    }
}

/// The warnings about a scene: bodies that nothing holds, loads of bodies whose motion is given, and loads that are seen in one cycle only, while cycles
/// follow each other.
pub(super) fn warnings(scene: &Scene) -> Vec<Warning> {
    [loose_bodies(scene), idle_loads(scene), single_loads(scene), far_stops(scene)].concat()
}

fn idle_loads(scene: &Scene) -> Vec<Warning> {
    let is_free = |body: &usize| matches!(scene.bodies[*body].motion, Motion::Free { .. });
    let is_seen = |body: &usize| {
        let shows = |kind: &OutputKind| matches!(kind, OutputKind::DrivingTorque { body: of } if of == body);
        scene.outputs.iter().any(|output| shows(&output.kind))
    };
    let has_effect = |load: &&Load| load.bodies().iter().any(|body| is_free(body) || is_seen(body));
    let message = "acts on fixed and driven bodies only, whose motion is given: without the output driving-torque it has no effect";
    let idle = scene.loads.iter().filter(|load| !has_effect(load));
    idle.map(|load| Warning::new(format!("loads.{}", load.name()), message)).collect()
}

fn loose_bodies(scene: &Scene) -> Vec<Warning> {
    let joined = scene.joints.iter().flat_map(|joint| [joint.journal.body, joint.bushing.body]);
    let held: Vec<usize> = joined.chain(scene.loads.iter().flat_map(Load::bodies)).collect();
    let bodies = scene.bodies.iter().enumerate();
    let loose = bodies.filter(|(k, body)| matches!(body.motion, Motion::Free { .. }) && !held.contains(k));
    let message = "is held by no joint and no load: it has no effect on the other bodies";
    loose.map(|(_, body)| Warning::new(format!("bodies.{}", body.name), message)).collect()
}

fn single_loads(scene: &Scene) -> Vec<Warning> {
    if scene.life.is_single_cycle() {
        return Vec::new();
    }
    let varying = scene.loads.iter().filter_map(Load::curve);
    let leaves_its_end = |curve: &Curve| match curve.over {
        _ if curve.table.repeat => false,
        Over::Time => true,
        Over::Angle(body) => has_full_turns(&scene.bodies[body].motion),
    };
    let once = varying.filter(|(_, _, curve, _)| leaves_its_end(curve));
    let message = "does not repeat, but the cycles follow each other: what comes before a measured cycle has the first value; \
                   write repeat = true, or cycles = 1, checkpoint_every = 1, settle_cycles = 0";
    once.map(|(name, key, ..)| Warning::new(format!("loads.{name}.{key}"), message)).collect()
}

/// Angle stops that the start angles are more than half a turn beyond.
fn far_stops(scene: &Scene) -> Vec<Warning> {
    let start = |body: usize| match scene.bodies[body].motion {
        Motion::Free { start_angle, .. } => Some(start_angle),
        Motion::Fixed => Some(0.0),
        Motion::Driven { .. } => None,
    };
    let far = scene.loads.iter().filter_map(|load| {
        let Load::AngleStop { name, a, b, lower, upper, .. } = load else { return None };
        let angle = start(*a)? - start(*b)?;
        let beyond = (angle - upper).max(lower - angle);
        let message = format!(
            "begins {:.0} deg beyond its stops: angles count whole turns, and the joints keep those of the start angles",
            beyond.to_degrees()
        );
        (beyond > PI).then(|| Warning::new(format!("loads.{name}"), message))
    });
    far.collect()
}

/// True if a drive turns the body further with every cycle.
fn has_full_turns(motion: &Motion) -> bool {
    let Motion::Driven { drive, .. } = motion else { return false };
    match drive {
        Drive::ConstantSpeed { .. } => true,
        Drive::Angle(table) => (table.value[table.value.len() - 1] - table.value[0]).abs() > PI,
        Drive::Speed { table, .. } => monotone_integral(table).abs() > PI,
    }
}

/// Largest radius of gyration of a body, in units of its largest distance from the centre of mass: a flywheel on a short crank.
const LARGEST_GYRATION: f64 = 10.0;
/// Density of a block around a body that is as heavy as the body [kg/m^3]: from a thin wire across it to twice that of gold.
const DENSITIES: (f64, f64) = (1e-3, 5e4);
/// Radial clearances of hinges are 0.01 to 2 % of the radius.
const LARGEST_CLEARANCE: f64 = 0.1;
/// Young's moduli from PTFE to diamond [Pa].
const MODULI: (f64, f64) = (3e8, 2e12);
/// Wear coefficients per hardness, from films in oil to abrasion of plastics, 1e-2 mm^3/(N m) [1/Pa].
const WEAR: (f64, f64) = (1e-21, 1e-11);
/// Largest speed of a driven body [rad/s]: a dental turbine has 4e4.
const LARGEST_SPEED: f64 = 1e5;
/// Gravity on the moon and on Jupiter, a tenth and ten times [m/s^2].
const GRAVITY: (f64, f64) = (0.1, 300.0);

/// The warnings about a scene.
pub(super) fn magnitudes(scene: &Scene) -> Vec<Warning> {
    let mut found = Vec::new();
    let mut warn = |key: String, message: String| found.push(Warning::new(key, message));
    for (k, body) in scene.bodies.iter().enumerate() {
        of_body(scene, k, body, &mut |key, message| warn(format!("bodies.{}.{key}", body.name), message));
    }
    for joint in &scene.joints {
        let warn: &mut Warn = &mut |key, message| warn(format!("joints.{}.{key}", joint.name), message);
        match &joint.kind {
            JointKind::Clearance(clearance) => of_hinge(clearance, warn),
            JointKind::Guide(guide) => of_guide(guide, warn),
            JointKind::Mesh(mesh) => of_mesh(mesh, warn),
            _ => {}
        }
    }
    let [x, y] = scene.gravity;
    let gravity = x.hypot(y);
    if gravity > 0.0 && !within(gravity, GRAVITY) {
        warn("gravity".to_owned(), format!("is {gravity:.3e} m/s^2; on earth it is 9.81 m/s^2"));
    }
    found
}

/// Takes a key of an element and the warning about it.
type Warn<'w> = dyn FnMut(&str, String) + 'w;

fn within(value: f64, (least, most): (f64, f64)) -> bool {
    (least..=most).contains(&value)
}

fn of_body(scene: &Scene, k: usize, body: &Body, warn: &mut Warn) {
    match &body.motion {
        Motion::Driven { drive: Drive::ConstantSpeed { speed, .. }, .. } if speed.abs() > LARGEST_SPEED => {
            let turns = speed.abs() * 30.0 / PI;
            warn("speed", format!("is {turns:.0} r/min, more than any machine has"));
        }
        Motion::Free { mass, inertia, centre_of_mass, .. } => {
            let Some(size) = size(scene, k, body, *centre_of_mass) else { return };
            let gyration = (inertia / mass).sqrt();
            if gyration > LARGEST_GYRATION * size {
                let (gyration, size) = (1e3 * gyration, 1e3 * size);
                let message = format!(
                    "with the mass it gives a radius of gyration of {gyration:.4} mm, but no point of the body is farther from its centre of \
                     mass than {size:.4} mm: check the units of inertia and mass"
                );
                warn("inertia", message);
            }
            let density = mass / (2.0 * size).powi(3);
            if !within(density, DENSITIES) {
                let width = 2e3 * size;
                let message = format!(
                    "is {mass:.3e} kg in a body of {width:.4} mm: a block of that size would have {density:.1e} kg/m^3 (steel: 7850): check \
                     the unit"
                );
                warn("mass", message);
            }
        }
        _ => {}
    }
}

/// Largest distance of a point or joint of a link from its centre of mass [m]; none for sliders and bodies with a single joint, whose
/// points do not show how large they are.
fn size(scene: &Scene, k: usize, body: &Body, [a, b]: [f64; 2]) -> Option<f64> {
    let of_body = |joint: &&Joint| [joint.journal.body, joint.bushing.body].contains(&k);
    let slides = |joint: &Joint| matches!(joint.kind, JointKind::Prismatic { .. } | JointKind::Guide(_));
    if scene.joints.iter().filter(of_body).count() < 2 || scene.joints.iter().filter(of_body).any(slides) {
        return None;
    }
    let places = scene.joints.iter().flat_map(|joint| [&joint.journal, &joint.bushing]);
    let joints = places.filter(|place| place.body == k).map(|place| place.position);
    let points = body.points.iter().map(|point| point.position);
    let size = points.chain(joints).map(|[x, y]| (x - a).hypot(y - b)).fold(0.0, f64::max);
    (size > 0.0).then_some(size)
}

/// Share of the larger pitch radius by which pitch lines may miss each other: the teeth of shifted profiles.
const LARGEST_GAP: f64 = 0.01;

fn of_mesh(mesh: &Mesh, warn: &mut Warn) {
    let [a, b] = mesh.radii;
    let gap = mesh.gap / a.max(b);
    if gap.abs() <= LARGEST_GAP {
        return;
    }
    let key = if mesh.form == MeshForm::Rack { "radius" } else { "radius_a" };
    let (what, millimetres) = (if gap > 0.0 { "miss" } else { "overlap" }, 1e3 * mesh.gap.abs());
    let lines = if mesh.form == MeshForm::Belt { "pulleys" } else { "pitch lines" };
    let message = format!(
        "with these radii the {lines} of both sides {what} each other by {millimetres:.4} mm at the start: check radii, places and units"
    );
    warn(key, message);
}

fn of_hinge(clearance: &Clearance, warn: &mut Warn) {
    let share = clearance.radial_clearance() / clearance.journal_radius;
    if share > LARGEST_CLEARANCE {
        let message = format!(
            "leaves a radial clearance of {:.0} % of the journal radius; hinges have 0.01 to 2 %: check the units of the radii and the \
             clearance",
            100.0 * share
        );
        warn("journal_radius", message);
    }
    if clearance.width > 100.0 * clearance.journal_radius {
        let ratio = clearance.width / clearance.journal_radius;
        warn("width", format!("is {ratio:.0} times the journal radius: check the unit"));
    }
    let materials = [&clearance.journal_material, &clearance.bushing_material];
    of_materials(["journal_material", "bushing_material"], materials, warn);
    let second = clearance.journal_wear_coefficient;
    of_wear(clearance.wear_coefficient, "journal_wear_coefficient", second, warn);
}

fn of_guide(guide: &GuideClearance, warn: &mut Warn) {
    let materials = [&guide.slider_material, &guide.guide_material];
    of_materials(["slider_material", "guide_material"], materials, warn);
    if let Some(wear) = &guide.wear {
        of_wear(wear.coefficient, "slider_wear_coefficient", wear.slider_coefficient, warn);
    }
}

/// Warns about the elastic moduli of two surfaces.
fn of_materials(keys: [&str; 2], materials: [&Material; 2], warn: &mut Warn) {
    for (key, Material { elastic_modulus, .. }) in keys.into_iter().zip(materials) {
        if !within(*elastic_modulus, MODULI) {
            let message = format!(
                "has an elastic modulus of {elastic_modulus:.3e} Pa; steel has 2.06e11 Pa = 206 GPa, plastics of bearings have 4e8 to 1e10 Pa"
            );
            warn(key, message);
        }
    }
}

/// Warns about the wear coefficients of two surfaces, the second of which has the key `second_key` if it is given [1/Pa].
fn of_wear(first: f64, second_key: &str, second: Option<f64>, warn: &mut Warn) {
    for (key, wear) in [("wear_coefficient", Some(first)), (second_key, second)] {
        let Some(wear) = wear.filter(|wear| *wear > 0.0 && !within(*wear, WEAR)) else { continue };
        let per_work = 1e9 * wear;
        let usual = "lubricated steel has about 1e-17 to 1e-13 1/Pa: check the unit";
        warn(key, format!("is {wear:.3e} 1/Pa = {per_work:.3e} mm^3/(N m); {usual}"));
    }
}

#[cfg(test)]
mod tests {
    use crate::scene::SceneSource;

    fn keys(source: &SceneSource) -> Vec<String> {
        source.warnings().into_iter().map(|warning| warning.key).collect()
    }

    #[test]
    fn issue_a_body_that_nothing_holds_had_no_warning() {
        let loose = "[[bodies]]\nname = \"loose\"\nmotion = \"free\"\nmass = \"1 g\"\ninertia = \"1 g mm^2\"\n\
                     centre_of_mass = [\"0 m\", \"0 m\"]\nstart_position = [\"0 m\", \"0 m\"]\nstart_angle = \"0 deg\"\n";
        let four_bar = SceneSource::builtin("four-bar").expect("built in");
        let with_it = SceneSource::parse(&format!("{}\n{loose}", four_bar.text()), "loose").expect("valid");
        assert_eq!(keys(&with_it), ["bodies.loose"]);
        let on_frame = four_bar.text().replace("body = \"rocker\"\ntorque", "body = \"frame\"\ntorque");
        assert_eq!(keys(&SceneSource::parse(&on_frame, "idle").expect("valid")), ["loads.work"]);
        // A driven body shows its loads by its torque alone.
        let on_crank = on_frame.replace("body = \"frame\"\ntorque", "body = \"crank\"\ntorque");
        let shown = "\n[[outputs]]\nname = \"shown\"\ntype = \"driving-torque\"\nbody = \"crank\"\n";
        for (text, expected) in [(on_crank.clone(), vec!["loads.work"]), (on_crank + shown, vec![])] {
            assert_eq!(keys(&SceneSource::parse(&text, "idle").expect("valid")), expected);
        }
        assert!(keys(&four_bar).is_empty());
    }

    const FOUR_BAR: &str = include_str!("../../scenes/four-bar.toml");

    #[test]
    fn issue_a_stop_a_turn_away_from_the_start_had_no_warning() {
        let four_bar = SceneSource::builtin("four-bar").unwrap();
        for (upper, expected) in [(360, vec![]), (-200, vec!["loads.gate"])] {
            let stop = format!(
                "\n[[loads]]\nname = \"gate\"\ntype = \"angle-stop\"\na = \"rocker\"\nb = \"frame\"\nlower = \"-300 deg\"\n\
                 upper = \"{upper} deg\"\nstiffness = \"1 N m/rad\"\n"
            );
            let source = SceneSource::parse(&(four_bar.text().to_owned() + &stop), "gate").expect("valid");
            assert_eq!(keys(&source), expected, "{upper}");
        }
    }

    #[test]
    fn built_in_scenes_have_ordinary_magnitudes() {
        for name in SceneSource::builtin_names() {
            let source = SceneSource::builtin(name).unwrap();
            assert_eq!(super::magnitudes(source.nominal()), [], "{name}");
        }
    }

    #[test]
    fn a_unit_that_is_wrong_by_a_thousand_is_pointed_out() {
        for (from, to, key) in [
            ("\"206 GPa\"", "\"2060 GPa\"", "journal_material"),
            ("\"206 GPa\"", "\"206 MPa\"", "journal_material"),
            ("width = \"10 mm\"", "width = \"10 m\"", "width"),
            ("coupler_mass = \"20 g\"", "coupler_mass = \"20 kg\"", "bodies.coupler.mass"),
            ("coupler_mass = \"20 g\"", "coupler_mass = \"1e-8 g\"", "bodies.coupler.mass"),
            ("\"coupler_mass * coupler_length^2 / 12\"", "\"3 kg m^2\"", "bodies.coupler.inertia"),
            ("\"1e-13 1/Pa\"", "\"1e-7 1/Pa\"", "wear_coefficient"),
            ("speed = \"900 r/min\"", "speed = \"9e6 r/min\"", "bodies.crank.speed"),
            ("[scene]", "gravity = [\"0 m/s^2\", \"-9810 m/s^2\"]\n[scene]", "gravity"),
        ] {
            assert!(FOUR_BAR.contains(from), "{from}");
            let source = SceneSource::parse(&FOUR_BAR.replace(from, to), "my.toml").unwrap();
            let found = source.warnings();
            let warning = found.iter().find(|warning| warning.key.ends_with(key));
            assert!(warning.is_some(), "{to}: {found:?}");
        }
        let guided = include_str!("../../tests/scenes/needle.toml").replace("\"105 GPa\"", "\"105 MPa\"");
        let found = SceneSource::parse(&guided, "my.toml").unwrap().warnings();
        assert!(found.iter().any(|warning| warning.key == "joints.bush.slider_material"), "{found:?}");
    }
}
