//! The built-in scenes as they resolve, and what samples and settings change.

use common::scene::*;

fn flapping_wing() -> SceneSource {
    SceneSource::builtin("flapping-wing").unwrap()
}

fn body<'s>(scene: &'s Scene, name: &str) -> &'s Body {
    scene.bodies.iter().find(|body| body.name == name).unwrap()
}

fn point(body: &Body, name: &str) -> [f64; 2] {
    body.points.iter().find(|point| point.name == name).unwrap().position
}

fn clearance(joint: &Joint) -> &Clearance {
    match &joint.kind {
        JointKind::Clearance(clearance) => clearance,
        _ => panic!("joint {} is ideal", joint.name),
    }
}

fn near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found} is not within {tolerance} of {expected}");
}

#[test]
fn the_flapping_wing_has_the_numbers_of_the_model() {
    let scene = flapping_wing().nominal().clone();
    assert_eq!((scene.bodies.len(), scene.joints.len(), scene.loads.len()), (6, 6, 2));
    assert_eq!(scene.variables.len(), 30);
    assert_eq!((scene.life.cycles, scene.life.checkpoint_every), (72_000, 1_000));
    near(scene.life.period, 0.125, 1e-15);
    // 40.0549 mm * cos(3 deg) = 40.0000062 mm
    near(point(body(&scene, "right_rod"), "rocker_pin")[0], 0.04, 1e-8);
    let Motion::Free { mass, inertia, centre_of_mass, .. } = body(&scene, "left_rod").motion else {
        panic!()
    };
    near(mass, 0.57e-3, 1e-18);
    near(inertia, 0.57e-3 * 0.04 * 0.04 / 12.0, 1e-13);
    near(centre_of_mass[0], 0.02, 1e-8);
    let left = body(&scene, "left_rocker");
    assert_eq!(point(left, "rod_pin"), [0.016179, 0.0]);
    assert_eq!(point(left, "wing"), [-0.029, -0.0]);
    let names: Vec<_> = scene.joints.iter().map(|joint| joint.name.as_str()).collect();
    assert_eq!(names, ["1", "2", "3", "4", "5", "6"]);
    for joint in &scene.joints {
        let joint = clearance(joint);
        near(joint.radial_clearance(), 23.5e-6, 1e-15);
        assert_eq!(joint.journal_material.elastic_modulus, 2e11);
        assert_eq!(joint.bushing_material.elastic_modulus, 1.1e11);
        assert_eq!(joint.contact_law, ContactLaw::LocalHertz);
        assert_eq!(joint.contact_damping, ContactDamping::HuntCrossley { factor: 7.5 });
        assert_eq!((joint.wear_coefficient, joint.friction), (1.299e-13, 0.025));
        assert_eq!((joint.film_damping, joint.friction_speed), (7.24, 0.0024));
        assert_eq!((joint.width, joint.control_points.number()), (0.004, 36));
    }
    let thresholds: Vec<_> =
        scene.limit_states.iter().map(|limit| (limit.name.as_str(), limit.threshold)).collect();
    assert_eq!(thresholds[0], ("wear", 30e-6));
    assert_eq!(thresholds[1].0, "asymmetry");
    near(thresholds[1].1, 25.0 * std::f64::consts::PI / 30.0, 1e-14);
}

#[test]
fn the_published_drive_declares_its_control_points_a_part_of_its_model() {
    for name in SceneSource::builtin_names() {
        let source = SceneSource::builtin(name).unwrap();
        assert_eq!(source.nominal().control_points_of_model, name.starts_with("flapping-wing"), "{name}");
    }
}

/// Rocker angle of the ideal linkage at one crank angle, in the reported sense, by bisection of the closure.
fn ideal_angle(scene: &Scene, side: &str, sign: f64, crank: f64) -> f64 {
    let rocker = body(scene, &format!("{side}_rocker"));
    let frame_pin = point(body(scene, "frame"), &format!("{side}_pin"));
    let rod = point(body(scene, &format!("{side}_rod")), "rocker_pin")[0];
    let radius = point(body(scene, "crank"), "pin")[0];
    let rod_pin = point(rocker, "rod_pin")[0];
    let gap = |angle: f64| {
        let body_angle = sign * angle;
        let x = frame_pin[0] + rod_pin * body_angle.cos() - radius * crank.cos();
        let y = frame_pin[1] + rod_pin * body_angle.sin() - radius * crank.sin();
        x.hypot(y) - rod
    };
    let (mut low, mut high) = (-0.7_f64, 0.7_f64);
    assert!(gap(low) * gap(high) < 0.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if gap(low) * gap(middle) <= 0.0 { high = middle } else { low = middle }
    }
    low
}

/// With ideal joints the rockers have the published range, differ by 0.927 deg at most
/// and by 20.33 r/min at most.
#[test]
fn ideal_kinematics_of_the_flapping_wing() {
    let scene = flapping_wing().nominal().clone();
    let OutputKind::AngularVelocityDifference { a, b } = &scene.outputs[1].kind else { panic!() };
    assert_eq!((a.label.as_str(), b.label.as_str()), ("right", "left"));
    let n = 7200;
    let step = std::f64::consts::TAU / f64::from(n);
    let angles = |side: &str, sign: f64| -> Vec<f64> {
        (0..n).map(|i| ideal_angle(&scene, side, sign, step * f64::from(i))).collect()
    };
    let (right, left) = (angles("right", a.sign), angles("left", b.sign));
    let published = published_results("flapping-wing").unwrap();
    let [highest, lowest] =
        ["rocker_highest", "rocker_lowest_right"].map(|name| published[name].to_degrees());
    for side in [&right, &left] {
        near(side.iter().copied().fold(f64::MIN, f64::max).to_degrees(), highest, 0.01);
        near(side.iter().copied().fold(f64::MAX, f64::min).to_degrees(), lowest, 0.01);
    }
    let difference: Vec<f64> = right.iter().zip(&left).map(|(r, l)| r - l).collect();
    let largest = difference.iter().fold(0.0, |largest: f64, x| largest.max(x.abs())).to_degrees();
    near(largest, 0.927, 0.005);
    let speed = 8.0 * std::f64::consts::TAU;
    let rates = (0..difference.len()).map(|i| {
        let (before, after) = (difference[i], difference[(i + 1) % difference.len()]);
        (after - before) / step * speed * 30.0 / std::f64::consts::PI
    });
    near(rates.fold(0.0, |largest: f64, x| largest.max(x.abs())), 20.33, 0.1);
}

fn parameters(source: &SceneSource, name: &str) -> (f64, f64, f64, f64) {
    let variable = source.variables().iter().find(|variable| variable.name == name).unwrap();
    let (lower, upper) = variable.distribution.support();
    (variable.distribution.parent_mean(), variable.distribution.given_std(), lower, upper)
}

#[test]
fn variables_have_the_spread_of_the_table() {
    let paper = flapping_wing();
    let order: Vec<_> = paper.variables().iter().map(|variable| variable.name.as_str()).collect();
    assert_eq!(
        order[..10],
        [
            "bushing_radius_1",
            "bushing_radius_2",
            "bushing_radius_3",
            "bushing_radius_4",
            "bushing_radius_5",
            "bushing_radius_6",
            "bushing_width_12",
            "bushing_width_34",
            "bushing_width_56",
            "rod_length",
        ]
    );
    assert_eq!((order[25], order[28], order[29]), ("wear_coefficient_12", "load_stiffness", "friction"));
    let (mean, std, lower, upper) = parameters(&paper, "bushing_radius_4");
    near(mean, 1.5235e-3, 1e-18);
    near(std, 0.075e-6, 1e-18);
    near(lower, 1.5235e-3 - 0.225e-6, 1e-15);
    near(upper, 1.5235e-3 + 0.225e-6, 1e-15);
    let (mean, std, ..) = parameters(&paper, "wear_coefficient_12");
    near(std, 0.018 * mean, 1e-28);
    near(parameters(&paper, "journal_poisson_34").1, 0.002 * 0.31, 1e-15);
    near(parameters(&paper, "rod_inclination").1, 1.5e-4, 1e-18);

    let workshop = SceneSource::builtin("flapping-wing-tolerances").unwrap();
    let spread = |name| parameters(&workshop, name).1;
    near(spread("bushing_radius_4"), 0.7e-6, 1e-18);
    near(spread("bushing_width_12"), 1e-5, 1e-18);
    near(spread("friction"), 0.015 * 0.025, 1e-16);
    near(spread("load_stiffness"), 0.006 * 95.0, 1e-13);
    // All but names, spreads and the accuracy they ask for is shared.
    let (mut paper, mut workshop) = (paper.nominal().clone(), workshop.nominal().clone());
    assert_ne!(paper.name, workshop.name);
    for scene in [&mut paper, &mut workshop] {
        scene.variables.clear();
        scene.name.clear();
        scene.title.clear();
    }
    assert_eq!(
        (paper.accuracy.name.as_str(), workshop.accuracy.name.as_str()),
        ("balanced+jump-2000", "balanced")
    );
    paper.accuracy = workshop.accuracy.clone();
    assert_eq!(paper, workshop);
}

/// The drive in the wind tunnel is that of the simulations but for speed, load, life and the limit of the asymmetry.
#[test]
fn the_experiment_shares_the_drive() {
    let mut drive = flapping_wing().nominal().clone();
    let mut tunnel = SceneSource::builtin("flapping-wing-experiment").unwrap().nominal().clone();
    near(tunnel.life.period, 0.12, 1e-15);
    assert_eq!((tunnel.life.cycles, tunnel.loads.len(), tunnel.variables.len()), (104_000, 2, 31));
    assert!(tunnel.loads.iter().all(|load| matches!(load, Load::Drag { .. })), "{:?}", tunnel.loads);
    assert!(tunnel.variables.iter().all(|variable| variable.name != "load_stiffness"));
    near(tunnel.limit_states[1].threshold, 1f64.to_radians(), 1e-15);
    for scene in [&mut drive, &mut tunnel] {
        scene.bodies.retain(|body| body.name != "crank");
    }
    assert_eq!((drive.bodies, drive.joints), (tunnel.bodies, tunnel.joints));
}

#[test]
fn a_sample_changes_exactly_what_its_variables_change() {
    let source = flapping_wing();
    let nominal = source.nominal().clone();
    assert_eq!(source.resolve_sample(&source.means()).unwrap(), nominal);

    let mut sample = source.means();
    sample[0] += 1e-7; // bushing_radius_1
    sample[6] += 1e-5; // bushing_width_12
    sample[9] += 1e-6; // rod_length
    let scene = source.resolve_sample(&sample).unwrap();
    assert_eq!(clearance(&scene.joints[0]).bushing_radius, sample[0]);
    assert_eq!(clearance(&scene.joints[1]).bushing_radius, clearance(&nominal.joints[1]).bushing_radius);
    assert_eq!(clearance(&scene.joints[1]).width, sample[6]);
    assert_eq!(clearance(&scene.joints[2]).width, 0.004);
    let rod = point(body(&scene, "right_rod"), "rocker_pin")[0];
    near(rod, sample[9] * 3.0_f64.to_radians().cos(), 1e-17);
    let Motion::Free { inertia, .. } = body(&scene, "right_rod").motion else { panic!() };
    near(inertia, 0.57e-3 * rod * rod / 12.0, 1e-20);
}

#[test]
fn settings_by_name_or_key() {
    let source = flapping_wing();
    let rod = source.parse_setting("rod_length=50.0686mm").unwrap();
    assert_eq!(rod.0, "rod_length");
    let radius = source.parse_setting("joints.3.journal_radius = 1.4 mm").unwrap();
    let scene = source.resolve_with(&[rod, radius]).unwrap();
    near(point(body(&scene, "left_rod"), "rocker_pin")[0], 0.05, 1e-7);
    near(clearance(&scene.joints[2]).radial_clearance(), 123.5e-6, 1e-15);

    for (setting, reason) in [
        ("rod_length", "expected variable=value"),
        ("rod_lenght=1mm", "did you mean \"rod_length\""),
        ("rod_length=1 N", "is a force, expected a length (mm, um, m, ...)"),
        ("rod_length=", "is empty"),
        ("friction=1mm", "is a length, expected a plain number (no unit)"),
    ] {
        let found = source.parse_setting(setting).unwrap_err().to_string();
        assert!(found.contains(reason), "{setting}: {found}");
    }
    let found = source.resolve_with(&[("bushing_radius_1".to_owned(), 1.4e-3)]).unwrap_err().to_string();
    assert!(
        found.contains("joints.1.bushing_radius") && found.contains("larger than the journal"),
        "{found}"
    );
    let found = source.resolve_sample(&[0.0; 3]).unwrap_err().to_string();
    assert!(found.contains("3 values") && found.contains("30"), "{found}");
}

#[test]
fn a_scene_leaves_out_parts_of_another() {
    let scene = |without: &str, rest: &str| {
        let text = format!("[scene]\nname = \"less\"\nextends = \"four-bar\"\nwithout = {without}\n{rest}");
        SceneSource::parse(&text, "less.toml")
    };
    let whole = SceneSource::builtin("four-bar").unwrap();
    let variables = whole.variables().len();
    // A load of another type takes the place of the one that is left out.
    let drag = "[[loads]]\nname = \"air\"\ntype = \"rotational-drag\"\nbody = \"rocker\"\nlinear = \"1 N mm s/rad\"\n";
    let less = scene("[\"loads.work\", \"variables.load_torque\"]", drag).unwrap();
    assert!(matches!(&less.nominal().loads[..], [Load::RotationalDrag { .. }]), "{:?}", less.nominal().loads);
    assert_eq!(less.variables().len(), variables - 1);
    assert_eq!(SceneSource::parse(less.text(), "sent").unwrap().nominal(), less.nominal());
    // Keys within rows and tables.
    let bare = scene("[\"joints.crank.film_damping\", \"scene.title\"]", "").unwrap();
    let JointKind::Clearance(crank) = &bare.nominal().joints[0].kind else { panic!("an ideal joint") };
    assert_eq!((bare.nominal().title.as_str(), crank.film_damping), ("less", 0.0));
    let fault = |without: &str| scene(without, "").unwrap_err().to_string();
    let lost = scene("[\"loads.pull\"]", "").unwrap_err();
    assert_eq!(lost.to_string(), "less.toml: scene.without: the extended scene has no \"loads.pull\"");
    assert_eq!(lost.0[0].location.as_ref().unwrap().line, 4);
    assert!(fault("\"loads\"").contains("scene.without: \"loads\" is no list of keys"));
    assert!(fault("[1]").contains("is no list of keys"));
    let alone = whole.text().replacen("[scene]\n", "[scene]\nwithout = [\"loads.push\"]\n", 1);
    let alone = SceneSource::parse(&alone, "alone.toml").unwrap_err().to_string();
    assert!(alone.contains("scene.without: needs `extends`"), "{alone}");
}

#[test]
fn texts_travel() {
    for name in SceneSource::builtin_names() {
        let source = SceneSource::builtin(name).unwrap();
        let again = SceneSource::parse(source.text(), name).unwrap();
        assert_eq!(again.nominal(), source.nominal());
        assert_eq!(again.digest(), source.digest());
        assert!(!source.text().contains("extends"));
    }
    assert_ne!(flapping_wing().digest(), SceneSource::builtin("four-bar").unwrap().digest());
}

/// A study resolves each sample once, beside a simulation of a tenth of a second or more: 10 ms would be too much,
/// and are fifty times what it takes.
#[test]
fn resolving_a_sample_costs_nothing_beside_simulating_it() {
    let source = flapping_wing();
    let mut sample = source.means();
    let start = std::time::Instant::now();
    for i in 0..1000 {
        sample[9] += 1e-9 * f64::from(i % 3);
        source.resolve_sample(&sample).unwrap();
    }
    let each = start.elapsed().as_secs_f64() / 1000.0;
    assert!(each < 0.01, "{each} s");
}
