use super::*;
use common::scene::{Scene, SceneSource};
use worker::mechanism::{Prescribed, ideal_cycle};

/// A file of the tests, and the scene that it gives.
fn scene(name: &str) -> (Scene, ImportedLinkage) {
    let path = format!("{}/tests/linkages/{name}", env!("CARGO_MANIFEST_DIR"));
    let linkage =
        read(&std::fs::read_to_string(&path).expect(&path)).unwrap_or_else(|fault| panic!("{name}: {fault}"));
    let text = linkage.scene("read", name);
    let source = SceneSource::parse(&text, name).unwrap_or_else(|faults| panic!("{faults}\n{text}"));
    (source.nominal().clone(), linkage)
}

/// Places of a point of a body at 73 instants of a cycle [mm], with the angle of the driven body [rad].
fn path(scene: &Scene, body: &str, point: &str) -> Vec<(f64, [f64; 2])> {
    let index = scene.bodies.iter().position(|other| other.name == body).expect(body);
    let at = scene.bodies[index].points.iter().find(|other| other.name == point).expect(point).position;
    let crank = scene
        .bodies
        .iter()
        .find_map(|body| Prescribed::from_body(body).filter(|motion| motion.angle(1.0) != 0.0));
    let place = common::scene::Attachment { body: index, position: at };
    let poses = ideal_cycle(scene, 73, &mut 0).unwrap_or_else(|failure| panic!("{}: {failure}", scene.title));
    assert_eq!(poses.len(), 73, "{}: the motion is not determined", scene.title);
    let of = |pose: worker::mechanism::Pose| {
        let q = pose.q[index].expect("a free body");
        let (sin, cos) = q[2].sin_cos();
        let [x, y] = scene.arm(&place);
        let moved = [q[0] + cos * x - sin * y, q[1] + sin * x + cos * y];
        (crank.as_ref().map_or(0.0, |crank| crank.angle(pose.time)), moved.map(|x| 1e3 * x))
    };
    poses.into_iter().map(of).collect()
}

/// The point at the distances `r` from `p` and `s` from `q` that is nearer to `before`.
fn dyad(p: [f64; 2], r: f64, q: [f64; 2], s: f64, before: [f64; 2]) -> [f64; 2] {
    let d = (q[0] - p[0]).hypot(q[1] - p[1]);
    let along = (r * r - s * s + d * d) / (2.0 * d);
    let across = (r * r - along * along).sqrt();
    let u = [(q[0] - p[0]) / d, (q[1] - p[1]) / d];
    let point =
        |side: f64| [p[0] + along * u[0] - side * across * u[1], p[1] + along * u[1] + side * across * u[0]];
    let far = |x: [f64; 2]| (x[0] - before[0]).hypot(x[1] - before[1]);
    if far(point(1.0)) < far(point(-1.0)) { point(1.0) } else { point(-1.0) }
}

fn far(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

#[track_caller]
fn near(found: [f64; 2], exact: [f64; 2]) {
    assert!(far(found, exact) < 1e-6, "{found:?} against {exact:?}");
}

#[test]
fn a_slider_crank_and_a_cylinder_move_by_their_closed_forms() {
    let (scene, _) = scene("slider-crank.pmks");
    for (angle, [x, y]) in path(&scene, "piston", "p4") {
        near([x, y], [30.0 * angle.cos() + (6400.0 - (30.0 * angle.sin()).powi(2)).sqrt(), 0.0]);
    }
    let (lift, linkage) = self::scene("lift.linkage2");
    assert_eq!(linkage.cylinders.len(), 1);
    // At half of the cycle the cylinder is longer by its throw.
    let places = path(&lift, "link0", "p1");
    assert!((far(places[36].1, [60.0, -30.0]) - far([90.0, 20.0], [60.0, -30.0]) - 20.0).abs() < 1e-6);
}

#[test]
fn the_coupler_of_a_hoeken_linkage_draws_its_line() {
    let (scene, _) = scene("hoeken.pmks");
    let (mut before, mut heights) = ([10.0, 40.0], Vec::new());
    for (angle, place) in path(&scene, "coupler", "p5") {
        // The crank of the file begins at 180 degrees, that of the scene at zero.
        let crank = [-20.0 * angle.cos(), -20.0 * angle.sin()];
        before = dyad(crank, 50.0, [40.0, 0.0], 50.0, before);
        near(place, [2.0 * before[0] - crank[0], 2.0 * before[1] - crank[1]]);
        if angle.cos() >= -1e-9 {
            heights.push(place[1]);
        }
    }
    // Over half a turn the line is straight to 1 % of its length of 80 mm.
    let (low, high) = heights.iter().fold((f64::MAX, f64::MIN), |(low, high), y| (low.min(*y), high.max(*y)));
    assert!(heights.len() > 30 && high - low < 0.8, "{low} to {high}");
}

#[test]
fn four_bars_and_six_bars_follow_their_dyads() {
    let (scene, _) = self::scene("four-bar.linkage2");
    let lengths = [far([20.0, 0.0], [50.0, 60.0]), far([50.0, 60.0], [80.0, 0.0])];
    let mut before = [50.0, 60.0];
    for (angle, place) in path(&scene, "link2", "p2") {
        let crank = [20.0 * angle.cos(), 20.0 * angle.sin()];
        before = dyad(crank, lengths[0], [80.0, 0.0], lengths[1], before);
        near(place, before);
    }
    for (name, of, ground) in
        [("watt-2.pmks", "rocker", [150.0, 0.0]), ("stephenson-3.pmks", "coupler", [-10.0, 90.0])]
    {
        let (scene, linkage) = self::scene(name);
        let pin = |k: usize| linkage.pins[k].at;
        let lengths = [far(pin(4), pin(5)), far(pin(5), ground)];
        let (joints, mut before) = (path(&scene, of, "p5"), pin(5));
        for ((_, from), (_, place)) in joints.into_iter().zip(path(&scene, "output", "p6")) {
            before = dyad(from, lengths[0], ground, lengths[1], before);
            near(place, before);
        }
    }
}

#[test]
fn a_quick_return_has_the_time_ratio_of_its_lengths() {
    let (scene, linkage) = scene("quick-return.linkage2");
    assert_eq!(linkage.unread.len(), 1, "{:?}", linkage.unread);
    assert!(linkage.unread[0].contains("gears"), "{:?}", linkage.unread);
    // The lever swings by asin(r / c) to either side of the line to the crank.
    let swings = path(&scene, "link1", "p3");
    let angle = |[x, y]: [f64; 2]| x.atan2(y + 80.0);
    for (crank, place) in &swings {
        let exact = (40.0 * crank.cos()).atan2(80.0 + 40.0 * crank.sin());
        assert!((angle(*place) - exact).abs() < 1e-9, "{} against {exact}", angle(*place));
    }
    let most = swings.iter().map(|(_, place)| angle(*place)).fold(0.0, f64::max);
    assert!((most - 0.5_f64.asin()).abs() < 1e-3, "{most}");
}

/// Lengths of Jansen (2007), The Great Pretender.
#[test]
fn a_leg_of_jansen_steps_level() {
    let (scene, linkage) = scene("jansen.pmks");
    assert_eq!(linkage.links.len(), 8);
    let (mut knee, mut top, mut heel) = (linkage.pins[4].at, linkage.pins[2].at, linkage.pins[6].at);
    let mut hip = linkage.pins[5].at;
    let mut foot = linkage.pins[7].at;
    let pivot = [-38.0, -7.8];
    let mut heights = Vec::new();
    for (angle, place) in path(&scene, "foot", "p8") {
        let crank = [-15.0 * angle.sin(), 15.0 * angle.cos()];
        top = dyad(crank, 50.0, pivot, 41.5, top);
        hip = dyad(pivot, 40.1, top, 55.8, hip);
        knee = dyad(crank, 61.9, pivot, 39.3, knee);
        heel = dyad(hip, 39.4, knee, 36.7, heel);
        foot = dyad(knee, 49.0, heel, 65.7, foot);
        assert!(far(place, foot) < 1e-5, "{place:?} against {foot:?}");
        heights.push(place[1]);
    }
    // For half of its time the foot is within a tenth of its lift from the ground.
    let (low, high) = heights.iter().fold((f64::MAX, f64::MIN), |(low, high), y| (low.min(*y), high.max(*y)));
    let down = heights.iter().filter(|y| **y - low < 0.1 * (high - low)).count();
    assert!(down > 30, "{down} of 73");
}

#[test]
fn what_cannot_be_read_is_said_with_its_place() {
    for (text, said) in [
        ("<linkage3/>", "<linkage2> was expected"),
        ("<linkage2><connector id=\"0\" x=\"a\" y=\"0\"/></linkage2>", "1:11: x = \"a\" is no number"),
        ("ground,a,R,0,zero", "line 1: \"zero\" where a number was expected"),
        ("ground,a,R,0,0", "no input"),
    ] {
        let fault = read(text).unwrap_err();
        assert!(fault.contains(said), "{fault}");
    }
    let linkage = read("ground,input,R,0,0\ninput,a,R,1,0\nd=0").unwrap();
    assert_eq!(linkage.unread, ["line 3: d=0"]);
}
