//! Ideal joints of one condition and stops against closed forms: linear drive, gears, belt, rack, cam, slot, end stop.

use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::outputs::{CycleHistory, Evaluation};
use common::scene::SceneSource;
use std::f64::consts::TAU;
use worker::simulate::{SimulateOptions, simulate};

/// A scene that is seen once for `period` [s], with a frame whose points are `frame`, under `gravity` along y [m/s^2].
fn seen_once(period: f64, gravity: f64, frame: &str, rest: &str) -> Evaluation {
    evaluated(&text_of(period, gravity, frame, rest)).expect("simulated")
}

fn evaluated(text: &str) -> Result<Evaluation, SimulationFailure> {
    let source = SceneSource::parse(text, "coupled").unwrap_or_else(|faults| panic!("{faults}"));
    simulate(source.nominal(), &Accuracy::reference(), SimulateOptions::WITH_FIRST_CYCLE)
}

/// The text of such a scene.
fn text_of(period: f64, gravity: f64, frame: &str, rest: &str) -> String {
    format!(
        "gravity = [\"0 m/s^2\", \"{gravity} m/s^2\"]\n[scene]\nname = \"coupled\"\n[[bodies]]\nname = \"frame\"\nmotion = \"fixed\"\npoints = {{ {frame} }}\n{rest}\n\
         [[outputs]]\nname = \"force\"\ntype = \"peak-joint-force\"\n\
         [life]\ncycles = 1\ncheckpoint_every = 1\nsettle_cycles = 0\nperiod = \"{period} s\"\n"
    )
}

/// A free body of 2 kg and 0.01 kg m^2 about its reference point, at rest at this place.
fn free(name: &str, place: &str, points: &str) -> String {
    format!(
        "[[bodies]]\nname = \"{name}\"\nmotion = \"free\"\nmass = \"2 kg\"\ninertia = \"0.01 kg m^2\"\n\
         centre_of_mass = [\"0 m\", \"0 m\"]\nstart_position = [{place}]\nstart_angle = \"0 deg\"\npoints = {{ {points} }}\n"
    )
}

/// A driven body about the origin at 10 rad/s.
fn driven(name: &str, points: &str) -> String {
    format!(
        "[[bodies]]\nname = \"{name}\"\nmotion = \"driven\"\nposition = [\"0 m\", \"0 m\"]\nspeed = \"10 rad/s\"\npoints = {{ {points} }}\n"
    )
}

fn joint(name: &str, kind: &str, a: [&str; 2], b: [&str; 2], more: &str) -> String {
    format!(
        "[[joints]]\nname = \"{name}\"\ntype = \"{kind}\"\na = {{ body = \"{}\", point = \"{}\" }}\nb = {{ body = \"{}\", point = \"{}\" }}\n{more}\n",
        a[0], a[1], b[0], b[1]
    )
}

fn cycle(evaluation: &Evaluation) -> &CycleHistory {
    evaluation.first_cycle.as_ref().expect("asked for")
}

/// Force in a joint at every time.
fn force<'e>(evaluation: &'e Evaluation, joint: &str) -> &'e [f64] {
    let found = cycle(evaluation).joint_force.iter().find(|(name, _)| name == joint);
    &found.expect("a joint of this name").1
}

/// Time, position and angle of a body.
fn motion<'e>(evaluation: &'e Evaluation, body: &str) -> impl Iterator<Item = (f64, [f64; 2], f64)> + 'e {
    let found = cycle(evaluation);
    let body = found.motion.iter().find(|motion| motion.body == body).expect("a body of this name");
    found.time.iter().zip(&body.position).zip(&body.angle).map(|((t, x), angle)| (*t, *x, *angle))
}

#[track_caller]
fn near(found: f64, exact: f64, error: f64) {
    assert!((found - exact).abs() <= error, "{found} against {exact}");
}

#[test]
fn a_cylinder_lifts_a_boom_by_the_law_of_cosines() {
    let (lug, ground, length, speed) = ([0.9_f64, 0.2_f64], [0.6_f64, -0.3_f64], 0.6, 0.002);
    let boom = "[[bodies]]\nname = \"boom\"\nmotion = \"free\"\nmass = \"100 kg\"\ninertia = \"30 kg m^2\"\n\
                centre_of_mass = [\"1 m\", \"0 m\"]\nstart_position = [\"0 m\", \"0 m\"]\nstart_angle = \"0 deg\"\n\
                points = { pin = [\"0 m\", \"0 m\"], lug = [\"0.9 m\", \"0.2 m\"] }\n";
    let joints = joint("pin", "revolute", ["boom", "pin"], ["frame", "o"], "")
        + &joint(
            "cylinder",
            "linear-drive",
            ["boom", "lug"],
            ["frame", "g"],
            &format!("length = \"{length} m\"\nspeed = \"{speed} m/s\""),
        );
    let frame = "o = [\"0 m\", \"0 m\"], g = [\"0.6 m\", \"-0.3 m\"]";
    let found = seen_once(100.0, -9.81, frame, &(boom.to_owned() + &joints));
    let [r, c] = [lug, ground].map(|[x, y]| x.hypot(y));
    let (of_lug, of_ground) = (lug[1].atan2(lug[0]), ground[1].atan2(ground[0]));
    for ((t, centre, angle), force) in motion(&found, "boom").zip(force(&found, "cylinder")) {
        let s = length + speed * t;
        let included = ((r * r + c * c - s * s) / (2.0 * r * c)).acos();
        let exact = of_ground + included - of_lug;
        near(angle, exact, 1e-7);
        // The arm of the force about the pin from twice the area of the triangle; angular accelerations are below 1e-4 of g.
        let arm = r * c * included.sin() / s;
        near(*force, 100.0 * 9.81 * exact.cos() / arm, 0.5);
        near(centre[0].hypot(centre[1]), 0.0, 1e-9);
    }
    let largest = |name| force(&found, name).iter().copied().fold(0.0, f64::max);
    near(found.histories[0][0], largest("pin").max(largest("cylinder")), 1e-3);
}

/// Angle of the second wheel over that of the first, and forces in mesh and bearing, for a torque [N m] and 100 N along x on the second one, whose
/// start lies beside its bearing. What drives does the work against the torque, and no other.
fn pair(kind: &str, radii: [f64; 2], distance: f64, torque: f64) -> [f64; 3] {
    let [a, b] = radii;
    let wheels = driven("first", "centre = [\"0 m\", \"0 m\"]")
        + &free("second", &format!("\"{distance} m\", \"0.03 m\""), "centre = [\"0 m\", \"0 m\"]");
    let joints = joint("bearing", "revolute", ["second", "centre"], ["frame", "b"], "")
        + &joint(
            "mesh",
            kind,
            ["first", "centre"],
            ["second", "centre"],
            &format!("radius_a = \"{a} m\"\nradius_b = \"{b} m\""),
        );
    let load = format!(
        "[[loads]]\nname = \"brake\"\ntype = \"constant-torque\"\nbody = \"second\"\ntorque = \"{torque} N m\"\n\
         [[loads]]\nname = \"side\"\ntype = \"constant-force\"\nat = {{ body = \"second\", point = \"centre\" }}\nforce = [\"100 N\", \"0 N\"]\n"
    );
    let found = seen_once(0.5, 0.0, &format!("b = [\"{distance} m\", \"0 m\"]"), &(wheels + &joints + &load));
    let (t, _, angle) = motion(&found, "second").last().expect("instants");
    let last = |name: &str| *force(&found, name).last().expect("instants");
    let energy = found.diagnostics.energy.expect("of the first cycle");
    near(energy.turnover, 2.0 * (torque * angle).abs(), 1e-6);
    near(energy.input, 0.0, 1e-9);
    [angle / (10.0 * t), last("mesh"), last("bearing")]
}

#[test]
fn wheels_turn_by_their_radii_and_load_their_bearings_by_the_force_between_teeth() {
    let (sin, cos) = 20f64.to_radians().sin_cos();
    for (kind, radii, distance, ratio) in [
        ("gear", [0.02_f64, 0.05], 0.07, -0.4_f64),
        ("internal-gear", [0.02, 0.05], 0.03, 0.4),
        ("internal-gear", [0.05, 0.02], 0.03, 2.5),
        ("belt", [0.02, 0.05], 0.2, 0.4),
    ] {
        // Teeth push the second wheel away from the first outside it, its rim outward or itself inward within the other; a strand pulls it.
        let slope = ((radii[0] - radii[1]) / distance).asin();
        let (exact, along, across) = match kind {
            "belt" => (1.0, -slope.cos(), slope.sin()),
            "gear" => (1.0 / cos, sin / cos, 1.0),
            _ => (1.0 / cos, -sin / cos, 1.0),
        };
        let force = 5.0 / radii[1];
        for sign in [1.0, -1.0] {
            let [found, mesh, bearing] = pair(kind, radii, distance, -5.0 * sign * ratio.signum());
            near(found, ratio, 1e-9);
            near(mesh, sign * force * exact, 1e-6 * force);
            if sign > 0.0 {
                near(bearing, (100.0 + force * along).hypot(force * across), 1e-6 * force);
            }
        }
    }
}

#[test]
fn a_wheel_moves_a_rack_and_presses_it_against_its_guide() {
    let bodies = driven("wheel", "centre = [\"0 m\", \"0 m\"]")
        + &free("rack", "\"0 m\", \"-0.03 m\"", "line = [\"0 m\", \"0 m\"]");
    let joints = joint("guide", "prismatic", ["rack", "line"], ["frame", "g"], "")
        + &joint(
            "mesh",
            "rack",
            ["rack", "line"],
            ["wheel", "centre"],
            "radius = \"0.03 m\"\npressure_angle = \"-20 deg\"",
        );
    let load = "[[loads]]\nname = \"push\"\ntype = \"constant-force\"\nat = { body = \"rack\", point = \"line\" }\nforce = [\"-80 N\", \"0 N\"]\n";
    let found = seen_once(0.2, 0.0, "g = [\"0 m\", \"-0.03 m\"]", &(bodies + &joints + load));
    let angle = 20f64.to_radians();
    for (((t, x, _), mesh), guide) in
        motion(&found, "rack").zip(force(&found, "mesh")).zip(force(&found, "guide"))
    {
        near(x[0], 0.03 * 10.0 * t, 1e-10);
        near(*mesh, 80.0 / angle.cos(), 1e-6);
        near(*guide, 80.0 * angle.tan(), 1e-6);
    }
}

#[test]
fn a_cam_lifts_its_follower_with_the_force_of_its_inertia() {
    // 30 mm + 5 mm cos theta, at 24 points: the error of a cubic spline is at most 5/384 h^4 of the fourth derivative, 0.3 um.
    let points: Vec<f64> = (0..=24).map(|k| TAU * f64::from(k) / 24.0).collect();
    let list = |unit: &str, values: Vec<f64>| format!("{{ unit = \"{unit}\", values = {values:?} }}");
    let lift: Vec<f64> = points.iter().map(|angle| 0.03 + 0.005 * angle.cos()).collect();
    let lift = format!(
        "axis = \"90 deg\"\nlift = {{ over = {{ angle = \"cam\" }}, at = {}, value = {} }}",
        list("rad", points),
        list("m", [lift.split_last().expect("points").1, &[0.035][..]].concat())
    );
    let bodies = driven("cam", "centre = [\"0 m\", \"0 m\"]")
        + &free("follower", "\"0 m\", \"0.035 m\"", "foot = [\"0 m\", \"0 m\"]");
    let joints = joint("guide", "prismatic", ["follower", "foot"], ["frame", "g"], "axis = \"90 deg\"")
        + &joint("lift", "cam", ["follower", "foot"], ["cam", "centre"], &lift);
    let found = seen_once(0.6, 0.0, "g = [\"0 m\", \"0 m\"]", &(bodies + &joints));
    for ((t, x, _), force) in motion(&found, "follower").zip(force(&found, "lift")) {
        let cos = (10.0 * t).cos();
        near(x[1], 0.03 + 0.005 * cos, 3.1e-7);
        // Negative where the cam has to pull.
        near(*force, -2.0 * 0.005 * 100.0 * cos, 0.01);
    }
}

#[test]
fn issue_a_follower_jumped_from_cycle_to_cycle() {
    let bodies = driven("cam", "centre = [\"0 m\", \"0 m\"]")
        + &free("follower", "\"0 m\", \"0.03 m\"", "foot = [\"0 m\", \"0 m\"]");
    let rising = |last: f64| {
        let lift = format!(
            "axis = \"90 deg\"\nlift = {{ over = {{ angle = \"cam\" }}, at = [\"0 deg\", \"45 deg\", \"90 deg\"], \
             value = [\"30 mm\", \"33 mm\", \"{last} mm\"], repeat = false }}"
        );
        let joints = joint("guide", "prismatic", ["follower", "foot"], ["frame", "g"], "axis = \"90 deg\"")
            + &joint("lift", "cam", ["follower", "foot"], ["cam", "centre"], &lift);
        text_of(TAU / 10.0, 0.0, "g = [\"0 m\", \"0 m\"]", &(bodies.clone() + &joints))
    };
    assert!(evaluated(&rising(35.0)).is_ok(), "seen once");
    let in_cycles = |text: String| evaluated(&text.replace("settle_cycles = 0", "settle_cycles = 1"));
    assert!(in_cycles(rising(30.0)).is_ok(), "a dwell follows");
    let failure = in_cycles(rising(35.0)).expect_err("a jump").to_string();
    assert!(failure.contains("begin with a lift of 0.030000 m of the joint lift"), "{failure}");
}

#[test]
fn a_pin_in_a_slot_moves_a_yoke_harmonically() {
    let bodies = driven("crank", "pin = [\"0.04 m\", \"0 m\"]")
        + &free("yoke", "\"0.04 m\", \"0 m\"", "slot = [\"0 m\", \"0 m\"]");
    let joints = joint("guide", "prismatic", ["yoke", "slot"], ["frame", "g"], "")
        + &joint("slot", "slot", ["crank", "pin"], ["yoke", "slot"], "axis = \"90 deg\"");
    let found = seen_once(0.6, 0.0, "g = [\"0 m\", \"0 m\"]", &(bodies + &joints));
    for ((t, x, _), force) in motion(&found, "yoke").zip(force(&found, "slot")) {
        let cos = (10.0 * t).cos();
        near(x[0], 0.04 * cos, 1e-9);
        // Magnitudes are interpolated between time steps: across a change of sign by no more than what the force changes in a step of 5 ms.
        let error = if cos.abs() < 0.05 { 80.0 * 0.005 } else { 1e-4 };
        near(*force, (2.0 * 0.04 * 100.0 * cos).abs(), error);
    }
}

/// A slider of 2 kg that meets an end stop at 1 m/s: its depth without dissipation, and the speed v with which it leaves another one,
/// ln((1 + D v_0) / (1 - D v)) = D (v_0 + v).
#[test]
fn a_slider_leaves_an_end_stop_by_the_law_of_its_dissipation() {
    let slider = |dissipation: f64| {
        let body = "[[bodies]]\nname = \"slider\"\nmotion = \"free\"\nmass = \"2 kg\"\ninertia = \"1 kg m^2\"\n\
                    centre_of_mass = [\"0 m\", \"0 m\"]\nstart_position = [\"0.2 m\", \"0 m\"]\nstart_angle = \"0 deg\"\n\
                    start_velocity = [\"-1 m/s\", \"0 m/s\"]\npoints = { middle = [\"0 m\", \"0 m\"] }\n";
        let guide = joint("guide", "prismatic", ["slider", "middle"], ["frame", "g"], "");
        let stop = format!(
            "[[loads]]\nname = \"stop\"\ntype = \"end-stop\"\na = {{ body = \"slider\", point = \"middle\" }}\n\
             b = {{ body = \"frame\", point = \"g\" }}\nshortest = \"0.15 m\"\nstiffness = \"20000 N/m\"\ndissipation = \"{dissipation} s/m\"\n"
        );
        let found = seen_once(0.2, 0.0, "g = [\"0 m\", \"0 m\"]", &(body.to_owned() + &guide + &stop));
        let places: Vec<(f64, f64)> = motion(&found, "slider").map(|(t, x, _)| (t, x[0])).collect();
        let deepest = places.iter().fold(f64::INFINITY, |low, place| low.min(place.1));
        let [.., (t0, x0), (t1, x1)] = places[..] else { panic!("instants") };
        (0.15 - deepest, (x1 - x0) / (t1 - t0))
    };
    let (depth, speed) = slider(0.0);
    near(depth, (2.0_f64 / 20000.0).sqrt(), 1e-5);
    near(speed, 1.0, 1e-5);
    let (depth, v) = slider(0.4);
    assert!(depth < 0.0099 && v < 0.9, "{depth} {v}");
    near(((1.0 + 0.4) / (1.0 - 0.4 * v)).ln(), 0.4 * (1.0 + v), 1e-5);
}
