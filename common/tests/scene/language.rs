//! Every word of the language of scenes means what it says; documents name no word that it does not have.

use common::scene::*;
use std::f64::consts::{PI, TAU};

const EVERYTHING: &str = include_str!("../scenes/everything.toml");

pub fn scene() -> Scene {
    SceneSource::parse(EVERYTHING, "everything").unwrap().nominal().clone()
}

pub fn body(scene: &Scene, name: &str) -> usize {
    scene.bodies.iter().position(|body| body.name == name).unwrap()
}

pub fn joint<'s>(scene: &'s Scene, name: &str) -> &'s Joint {
    scene.joints.iter().find(|joint| joint.name == name).unwrap()
}

fn place(scene: &Scene, name: &str, position: [f64; 2]) -> Attachment {
    Attachment { body: body(scene, name), position }
}

/// Numbers that differ by the rounding of their units at most.
#[track_caller]
pub fn same(found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() <= 4.0 * f64::EPSILON * expected.abs(), "{found}, not {expected}");
    }
}

#[track_caller]
pub fn same_table(found: &Table, at: &[f64], value: &[f64], repeat: bool) {
    same(&found.at, at);
    same(&found.value, value);
    assert_eq!(found.repeat, repeat);
}

#[test]
fn drives() {
    let scene = scene();
    let drive = |name: &str| match scene.bodies[body(&scene, name)].motion.clone() {
        Motion::Driven { drive, inertia, .. } => (drive, inertia),
        _ => panic!("{name} is not driven"),
    };
    let (Drive::ConstantSpeed { start_angle, speed }, inertia) = drive("crank") else { panic!() };
    same(&[start_angle, speed], &[PI / 6.0, 20.0 * PI]);
    let expected = MassProperties { mass: 0.2, inertia: 1e-5, centre_of_mass: [0.001, 0.002] };
    assert_eq!(inertia, Some(expected));

    let (Drive::Speed { start_angle, table }, inertia) = drive("wheel") else { panic!() };
    same(&[start_angle], &[PI / 18.0]);
    same_table(&table, &[0.0, 0.02, 0.05], &[0.0, 40.0 * PI, 0.0], true);
    assert_eq!(inertia, None);

    let (Drive::Angle(table), inertia) = drive("cam") else { panic!() };
    let degrees = |angle: f64| angle * PI / 180.0;
    same_table(&table, &[0.0, 0.06, 0.1], &[5.0, 245.0, 365.0].map(degrees), true);
    let on_axis = MassProperties { mass: 0.1, inertia: 2e-5, centre_of_mass: [0.0, 0.0] };
    assert_eq!(inertia, Some(on_axis));

    let (Drive::Angle(table), inertia) = drive("lever") else { panic!() };
    // A right triangle: 9 cm^2 of 1 cm, and b h (b^2 + h^2) / 36 of its area.
    let found = inertia.expect("by its shape");
    same(&[found.mass], &[9e-4 * 0.01 * 7850.0]);
    assert!((found.inertia - 78.5 * 0.0018 * 0.0045 / 36.0).abs() < 1e-18, "{found:?}");
    assert!((found.centre_of_mass[0] - 0.01).abs() < 1e-15 && (found.centre_of_mass[1] - 0.02).abs() < 1e-15);
    same_table(&table, &[0.0, 0.05, 0.1], &[0.0, PI / 18.0, 0.0], true);
}

#[test]
fn free_bodies_start_with_their_velocities_or_at_rest() {
    let scene = scene();
    let start = |name: &str| match scene.bodies[body(&scene, name)].motion {
        Motion::Free { start_velocity, start_speed, .. } => (start_velocity, start_speed),
        _ => panic!("{name} is not free"),
    };
    assert_eq!(start("rod").0, Some([1.0, -2.0]));
    same(&[start("rod").1.unwrap()], &[TAU]);
    assert_eq!(start("slider"), (None, None));
}

#[test]
fn joints() {
    let scene = scene();
    let hinge = joint(&scene, "hinge");
    assert_eq!(hinge.kind, JointKind::Revolute);
    assert_eq!(hinge.journal, place(&scene, "rod", [0.0, 0.0]));
    assert_eq!(hinge.bushing, place(&scene, "crank", [0.02, 0.0]));
    assert_eq!(hinge.friction, Some(IdealFriction { coefficient: 0.1, speed: 0.001, size: 0.005 }));
    let guide = joint(&scene, "guide");
    assert_eq!(guide.friction, Some(IdealFriction { coefficient: 0.15, speed: 0.002, size: 0.01 }));
    assert!(["plain_guide", "weld", "worn"].iter().all(|name| joint(&scene, name).friction.is_none()));
    let JointKind::Prismatic { axis, angle } = guide.kind else { panic!() };
    same(&[axis, angle], &[PI / 12.0, -PI / 9.0]);
    assert_eq!(joint(&scene, "plain_guide").kind, JointKind::Prismatic { axis: 0.0, angle: 0.0 });
    let JointKind::Fixed { angle } = joint(&scene, "weld").kind else { panic!() };
    same(&[angle], &[PI / 2.0]);
}

#[test]
fn clearances() {
    let scene = scene();
    let clearance = |name: &str| match &joint(&scene, name).kind {
        JointKind::Clearance(clearance) => clearance.clone(),
        _ => panic!("{name} is ideal"),
    };
    let steel = Material { elastic_modulus: 206e9, poisson_ratio: 0.3 };
    let worn = Clearance {
        journal_radius: 0.004,
        bushing_radius: 0.00425,
        width: 0.01,
        journal_material: steel,
        bushing_material: steel,
        contact_law: ContactLaw::Foundation,
        contact_damping: ContactDamping::HuntCrossley { factor: 7.5 },
        film_damping: 3.0,
        friction: 0.05,
        friction_speed: 0.005,
        wears: WearingSurfaces::Bushing,
        wear_coefficient: 1e-13,
        journal_wear_coefficient: None,
        control_points: ControlPoints::Number(40),
        wall: Some(0.001),
    };
    assert_eq!(clearance("worn"), worn);
    let by = |law, coefficient, least_speed| ContactDamping::Restitution { law, coefficient, least_speed };
    // The last one is the mean of its fit.
    for (name, damping, wear_coefficient, gap) in [
        ("unworn", by(RestitutionLaw::LankaraniNikravesh, 0.9, 0.002), 0.0, 30e-6),
        ("struck", by(RestitutionLaw::Flores, 1.0, 0.001), 1e-13, 30e-6),
        ("held", by(RestitutionLaw::HuntCrossley, 0.7, 0.001), 0.0, 30e-6),
        ("undamped", ContactDamping::None, 1e-13, 21.75e-6),
    ] {
        let found = clearance(name);
        assert_eq!((found.contact_damping, found.wear_coefficient), (damping, wear_coefficient), "{name}");
        assert_eq!((found.film_damping, found.wall), (0.0, None), "{name}");
        let by_arc = name == "undamped";
        assert_eq!(found.control_points == ControlPoints::ByArc, by_arc, "{name}");
        assert_eq!(found.control_points.number(), 36, "{name}");
        // 4.03 mm - 4 mm loses two digits.
        assert!((found.radial_clearance() - gap).abs() < 1e-17, "{name}");
    }
}

#[test]
fn loads() {
    let scene = scene();
    let load = |name: &str| scene.loads.iter().find(|load| load.name() == name).unwrap().clone();
    let named = str::to_owned;
    let (rod, slider) = (body(&scene, "rod"), body(&scene, "slider"));
    let (far, pin) = (place(&scene, "rod", [0.02, 0.0]), place(&scene, "slider", [0.0, 0.0]));
    let origin = place(&scene, "frame", [0.0, 0.0]);
    let (name, direction) = (named("lift"), [0.0, 1.0]);
    let lift = Load::DirectionalSpring {
        name,
        at: far,
        anchor: origin,
        direction,
        stiffness: 95.0,
        free_length: -0.02,
    };
    assert_eq!(load("lift"), lift);
    assert_eq!(load("weight"), Load::ConstantForce { name: named("weight"), at: pin, force: [0.0, -3.0] });
    assert_eq!(load("brake"), Load::ConstantTorque { name: named("brake"), body: rod, torque: -0.8 });
    let (name, a, b) = (named("spring"), far, origin);
    let spring = Load::Spring { name, a, b, stiffness: 2000.0, damping: 4.0, free_length: 0.03 };
    assert_eq!(load("spring"), spring);
    let (name, a, b) = (named("soft_spring"), pin, origin);
    assert_eq!(
        load("soft_spring"),
        Load::Spring { name, a, b, stiffness: 1.0, damping: 0.0, free_length: 0.0 }
    );

    let Load::TorsionSpring { a, b, stiffness, damping, free_angle, .. } = load("torsion") else { panic!() };
    assert_eq!((a, b, stiffness, damping), (rod, origin.body, 0.5, 0.01));
    same(&[free_angle], &[PI / 9.0]);
    let (name, a, b) = (named("plain_torsion"), slider, rod);
    let plain = Load::TorsionSpring { name, a, b, stiffness: 0.5, damping: 0.0, free_angle: 0.0 };
    assert_eq!(load("plain_torsion"), plain);

    let Load::VariableForce { at, direction, size, .. } = load("push") else { panic!() };
    assert_eq!((at, size.over), (pin, Over::Time));
    same(&direction, &[0.6, 0.8]);
    // The middle value is that of a random variable, whose mean is its own.
    same_table(&size.table, &[0.0, 0.01, 0.05], &[1.0, 5.5, 1.0], true);
    let Load::VariableForce { direction, size, .. } = load("pull") else { panic!() };
    assert_eq!((direction, size.over), ([-1.0, 0.0], Over::Angle(body(&scene, "crank"))));
    same_table(&size.table, &[0.0, PI / 2.0, PI], &[0.0, 2.0, 0.0], true);
    let Load::VariableTorque { body, torque, .. } = load("twist") else { panic!() };
    assert_eq!((body, torque.over), (slider, Over::Angle(rod)));
    same_table(&torque.table, &[-PI / 6.0, PI / 6.0], &[0.0, 2.0], false);
    let Load::Motor { body, stall_torque, no_load_speed, .. } = load("motor") else { panic!() };
    assert_eq!((body, stall_torque), (rod, -0.3));
    same(&[no_load_speed], &[-100.0 * PI]);
}

#[test]
fn drags() {
    let scene = scene();
    let all: Vec<&Load> =
        scene.loads.iter().filter(|l| matches!(l, Load::Drag { .. } | Load::RotationalDrag { .. })).collect();
    let [air, water, fan, plain_fan] = all[..] else { panic!("{all:?}") };
    let Load::Drag { at, direction, linear, quadratic, flow, factor: Some(factor), .. } = air else {
        panic!()
    };
    assert_eq!((*at, *direction), (place(&scene, "rod", [0.02, 0.0]), [0.0, 1.0]));
    assert_eq!((*linear, *quadratic, *flow), (0.2, 1.5, -20.0));
    assert_eq!(factor.over, Over::Angle(body(&scene, "crank")));
    same_table(&factor.table, &[0.0, PI, TAU], &[1.0, 0.25, 1.0], true);
    let (name, at) = ("water".to_owned(), place(&scene, "slider", [0.0, 0.0]));
    let direction = [1.0, 0.0];
    let expected = Load::Drag { name, at, direction, linear: 0.0, quadratic: 2.0, flow: 0.0, factor: None };
    assert_eq!(*water, expected);
    let Load::RotationalDrag { body: on, linear, quadratic, factor: Some(factor), .. } = fan else {
        panic!()
    };
    assert_eq!((*on, *linear, *quadratic, factor.over), (body(&scene, "rod"), 1e-4, 2e-5, Over::Time));
    same_table(&factor.table, &[0.0, 0.02, 0.05], &[1.0, 2.0, 1.0], true);
    let (name, body) = ("plain_fan".to_owned(), body(&scene, "slider"));
    let expected = Load::RotationalDrag { name, body, linear: 1e-4, quadratic: 0.0, factor: None };
    assert_eq!(*plain_fan, expected);
    // Loads that follow an angle couple the bodies.
    assert_eq!(air.bodies(), [scene.bodies.iter().position(|b| b.name == "rod").unwrap(), 1]);
}

#[test]
fn outputs_and_limit_states() {
    let scene = scene();
    let output = |name: &str| &scene.outputs.iter().find(|output| output.name == name).unwrap().kind;
    let index = |name: &str| scene.joints.iter().position(|joint| joint.name == name).unwrap();
    let signed = |name: &str, sign, label: &str| SignedBody {
        body: body(&scene, name),
        sign,
        label: label.to_owned(),
    };
    assert_eq!(*output("wear"), OutputKind::LargestWear { joints: vec![index("worn")] });
    // By default every joint that wears: neither the ideal ones nor those with wear = false.
    let worn = ["worn", "struck", "undamped", "rail"].map(index).to_vec();
    assert_eq!(*output("all_wear"), OutputKind::LargestWear { joints: worn.clone() });
    // Of the bushings and the journals those that wear.
    let wear = |quantity, joints: &[&str]| OutputKind::Wear {
        quantity,
        joints: joints.iter().map(|name| index(name)).collect(),
    };
    assert_eq!(*output("bushing_wear"), wear(WearQuantity::BushingDepth, &["worn", "undamped", "rail"]));
    assert_eq!(*output("journal_wear"), wear(WearQuantity::JournalDepth, &["struck", "undamped", "rail"]));
    let all = ["worn", "struck", "undamped", "rail"];
    assert_eq!(*output("growth"), wear(WearQuantity::ClearanceGrowth, &all));
    assert_eq!(*output("volume"), wear(WearQuantity::Volume, &all));
    let coefficients = |name: &str| match &scene.joints[index(name)].kind {
        JointKind::Clearance(clearance) => clearance.wear_coefficients(),
        _ => panic!("{name} is ideal"),
    };
    assert_eq!(
        ["worn", "struck", "undamped"].map(coefficients),
        [[1e-13, 0.0], [0.0, 1e-13], [1e-13, 5e-14]]
    );
    let (a, b) = (signed("rod", 1.0, "right"), signed("crank", -1.0, "left"));
    assert_eq!(*output("speed"), OutputKind::AngularVelocityDifference { a, b });
    let (a, b) = (signed("rod", 1.0, "rod"), signed("slider", -1.0, "slider"));
    assert_eq!(*output("angle"), OutputKind::AngleDifference { a, b });
    let chosen = vec![index("hinge"), index("worn")];
    assert_eq!(*output("hinge_force"), OutputKind::PeakJointForce { joints: chosen });
    let all = (0..scene.joints.len()).collect();
    assert_eq!(*output("force"), OutputKind::PeakJointForce { joints: all });
    let at = place(&scene, "slider", [0.0, 0.0]);
    let (wanted, measure) = ([None, None], ErrorMeasure::Largest);
    assert_eq!(*output("error"), OutputKind::PositionError { at, wanted, measure });
    assert_eq!(*output("torque"), OutputKind::DrivingTorque { body: body(&scene, "crank") });
    let rod = body(&scene, "rod");
    let measure = ErrorMeasure::Largest;
    assert_eq!(*output("rod_error"), OutputKind::AngleError { body: rod, wanted: None, measure });
    let OutputKind::PositionError {
        wanted: [Some(x), Some(y)], measure: ErrorMeasure::RootMeanSquare, ..
    } = output("stroke_error")
    else {
        panic!("{:?}", output("stroke_error"));
    };
    same(&x.table.at, &[0.0, PI, 2.0 * PI]);
    assert_eq!((x.over, y.over), (Over::Angle(body(&scene, "crank")), Over::Time));
    assert_eq!((x.table.repeat, y.table.repeat, y.table.value[1]), (true, false, 0.01));
    let OutputKind::AngleError { wanted: Some(function), measure: ErrorMeasure::RootMeanSquare, .. } =
        output("function_error")
    else {
        panic!("{:?}", output("function_error"));
    };
    same(&function.table.value, &[0.0, PI / 2.0]);
    let at = place(&scene, "rod", [0.02, 0.0]);
    assert_eq!(*output("jolt"), OutputKind::Acceleration { at });
    assert_eq!(*output("jerk_of_rod"), OutputKind::AngularAcceleration { body: rod });
    let with_clearance = ["worn", "unworn", "struck", "held", "undamped", "rail"].map(index).to_vec();
    assert_eq!(*output("strokes"), OutputKind::Impacts { joints: with_clearance });
    let (joints, measure) = (vec![index("struck")], ImpactMeasure::Total);
    assert_eq!(*output("blows"), OutputKind::ImpactEnergy { joints, measure });
    let (joints, measure) = (["struck", "held"].map(index).to_vec(), ImpactMeasure::Largest);
    assert_eq!(*output("hardest_blow"), OutputKind::ImpactEnergy { joints, measure });
    let held = Some(HeldInput { body: body(&scene, "crank"), angle: PI / 6.0 });
    assert_eq!(*output("lost_motion"), OutputKind::Backlash { body: rod, held });
    let at = place(&scene, "slider", [0.0, 0.0]);
    assert_eq!(*output("play"), OutputKind::PositionBacklash { at, direction: PI / 2.0, held: None });
    // Thresholds are in the kind of their output.
    let thresholds: Vec<f64> = scene.limit_states.iter().map(|limit| limit.threshold).collect();
    same(&thresholds, &[5e-6, PI / 60.0, 2000.0, 0.0005, 4.0, 1e-4, 9e-6, 900.0, 1e4, 50.0, 0.02]);
    let fails: Vec<Fails> = scene.limit_states[4..7].iter().map(|limit| limit.fails).collect();
    assert_eq!(fails, [Fails::Above, Fails::Below, Fails::Outside { lower: 2e-6 }]);
    assert_eq!(scene.limit_states[7].fails, Fails::Above);
}

#[test]
fn a_scene_says_how_accurately_it_is_to_be_simulated() {
    let accuracy = scene().accuracy;
    assert_eq!((accuracy.name.as_str(), accuracy.accuracy.cycle_jump), ("draft+jump-500", 500));
    let unsaid = EVERYTHING.replace("accuracy = \"draft+jump-500\"\n", "");
    assert_eq!(SceneSource::parse(&unsaid, "unsaid").unwrap().nominal().accuracy.name, "balanced");
}

#[test]
fn life_and_its_defaults() {
    let expected =
        Life { period: 0.1, cycles: 2000, checkpoint_every: 1000, settle_cycles: 3, turn_of: None };
    assert_eq!(scene().life, expected);
    let four_bar = SceneSource::builtin("four-bar").unwrap();
    assert_eq!(four_bar.nominal().life.settle_cycles, 1);
}

/// With one driven body the cycle is its turn or its table.
#[test]
fn the_period_is_that_of_the_only_drive() {
    let four_bar = SceneSource::builtin("four-bar").unwrap().text().to_owned();
    let period = |drive: &str| {
        let text = four_bar.replacen("speed = \"900 r/min\"", drive, 1);
        let text = text.replacen("start_angle = \"0 deg\"\n", "", 1);
        SceneSource::parse(&text, "my.toml").unwrap().nominal().life.period
    };
    same(&[period("speed = \"-900 r/min\"")], &[1.0 / 15.0]);
    let table = "at = [\"0.1 s\", \"0.2 s\", \"0.4 s\"]";
    let angle = format!("angle = {{ over = \"time\", {table}, value = [\"0 deg\", \"9 deg\", \"0 deg\"] }}");
    same(&[period(&angle)], &[0.4 - 0.1]);
    let speed =
        format!("speed = {{ over = \"time\", {table}, value = [\"0 r/min\", \"400 r/min\", \"0 r/min\"] }}");
    same(&[period(&speed)], &[0.4 - 0.1]);
}

#[test]
fn issue_loads_that_do_not_repeat_were_stepped_back_without_a_word() {
    let keys = |text: &str| -> Vec<String> {
        let source = SceneSource::parse(text, "my.toml").unwrap();
        source.warnings().into_iter().map(|warning| warning.key).collect()
    };
    // A table over the angle of a free body may be left where the body turns back.
    assert_eq!(keys(EVERYTHING), [""; 0]);
    let once = EVERYTHING.replacen("over = { angle = \"rod\" }", "over = \"time\"", 1).replacen(
        "at = [\"-30 deg\", \"30 deg\"]",
        "at = [\"0 s\", \"0.05 s\"]",
        1,
    );
    assert_eq!(keys(&once), ["loads.twist.torque"]);
    let crank = EVERYTHING.replacen("over = { angle = \"rod\" }", "over = { angle = \"crank\" }", 1);
    assert_eq!(keys(&crank), ["loads.twist.torque"]);
    let lever = EVERYTHING.replacen("over = { angle = \"rod\" }", "over = { angle = \"lever\" }", 1);
    assert_eq!(keys(&lever), [""; 0]);
    for name in SceneSource::builtin_names() {
        assert_eq!(SceneSource::builtin(name).unwrap().warnings(), [], "{name}");
    }
}

#[test]
fn parameters_that_nothing_reads_are_listed() {
    let unused = |text: &str| SceneSource::parse(text, "my.toml").unwrap().unused_parameters;
    // `spread` is read by a random variable alone, `arm` by another parameter too.
    assert_eq!(unused(EVERYTHING), [""; 0]);
    // One that only an unused one reads is unused with it; what a random variable changes must be read by something.
    let text = EVERYTHING.replacen("[parameters]", "[parameters]\nzeta = \"3 mm\"\nalpha = \"2 * zeta\"", 1);
    assert_eq!(unused(&text), ["alpha", "zeta"]);
    let text = text.replacen("changes = [\"parameters.arm\"]", "changes = [\"parameters.zeta\"]", 1);
    assert_eq!(unused(&text), ["alpha", "zeta"]);
    let text = text.replacen("wall = \"1 mm\"", "wall = \"alpha\"", 1);
    assert_eq!(unused(&text), [""; 0]);
    for name in SceneSource::builtin_names() {
        assert_eq!(SceneSource::builtin(name).unwrap().unused_parameters, [""; 0], "{name}");
    }
}
