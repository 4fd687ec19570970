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

/// The point that has in the triangle `p`, `q` the place of `x` in the triangle `a`, `b`.
fn carried([a, b, x]: [[f64; 2]; 3], p: [f64; 2], q: [f64; 2]) -> [f64; 2] {
    let minus = |u: [f64; 2], v: [f64; 2]| [u[0] - v[0], u[1] - v[1]];
    let (base, own, now) = (minus(b, a), minus(x, a), minus(q, p));
    let length = base[0].powi(2) + base[1].powi(2);
    let along = (own[0] * base[0] + own[1] * base[1]) / length;
    let across = (base[0] * own[1] - base[1] * own[0]) / length;
    [p[0] + along * now[0] - across * now[1], p[1] + along * now[1] + across * now[0]]
}

/// Places of all pins of a linkage at an angle of its crank, pin 1 to 2, from those before. A step is a pin with two others: it has its
/// distances from them, or (`true`) lies on the link that they belong to.
fn solved(
    linkage: &ImportedLinkage,
    angle: f64,
    steps: &[(usize, [usize; 2], bool)],
    places: &mut [[f64; 2]],
) {
    let file = |k: usize| linkage.pins[k - 1].at;
    let [x, y] = [0, 1].map(|axis| file(2)[axis] - file(1)[axis]);
    let (sin, cos) = angle.sin_cos();
    places[1] = [file(1)[0] + cos * x - sin * y, file(1)[1] + sin * x + cos * y];
    for (pin, [a, b], on_link) in steps {
        let (p, q) = (places[a - 1], places[b - 1]);
        places[pin - 1] = if *on_link {
            carried([file(*a), file(*b), file(*pin)], p, q)
        } else {
            dyad(p, far(file(*pin), file(*a)), q, far(file(*pin), file(*b)), places[pin - 1])
        };
    }
}

/// Linkages of dyads: file, steps of [`solved`], and the body and pin that are compared.
#[test]
fn linkages_follow_their_dyads() {
    let (dyad, link) = (false, true);
    let four_bar = (3, [2, 4], dyad);
    for (name, steps, body, pin) in [
        ("drag-link", vec![four_bar], "output", 3),
        ("pump-jack", vec![four_bar, (5, [3, 4], link)], "beam", 5),
        ("tandem-wiper", vec![four_bar, (5, [2, 6], dyad)], "left", 5),
        ("watt-1", vec![four_bar, (5, [2, 3], link), (6, [3, 4], link), (7, [5, 6], dyad)], "output", 7),
        ("watt-2", vec![four_bar, (5, [3, 4], link), (6, [5, 7], dyad)], "output", 6),
        ("stephenson-3", vec![four_bar, (5, [2, 3], link), (6, [5, 7], dyad)], "output", 6),
        ("dwell", vec![four_bar, (5, [2, 3], link), (6, [5, 7], dyad)], "output", 6),
        ("klann", vec![four_bar, (5, [2, 3], link), (6, [5, 7], dyad), (8, [5, 6], link)], "leg", 8),
        // Lengths of Jansen (2007), The Great Pretender.
        (
            "jansen",
            vec![
                (3, [2, 4], dyad),
                (5, [2, 4], dyad),
                (6, [4, 3], dyad),
                (7, [6, 5], dyad),
                (8, [5, 7], dyad),
            ],
            "foot",
            8,
        ),
        (
            "pantograph",
            vec![(4, [3, 2], dyad), (5, [3, 4], link), (6, [5, 2], dyad), (7, [5, 6], link)],
            "copy",
            7,
        ),
        ("peaucellier", vec![(4, [2, 3], dyad), (5, [2, 3], dyad), (6, [4, 5], dyad)], "far1", 6),
    ] {
        let (scene, linkage) = scene(&format!("{name}.pmks"));
        let mut places: Vec<[f64; 2]> = linkage.pins.iter().map(|pin| pin.at).collect();
        let mut heights = Vec::new();
        for (angle, place) in path(&scene, body, &format!("p{pin}")) {
            solved(&linkage, angle, &steps, &mut places);
            assert!(far(place, places[pin - 1]) < 1e-5, "{name}: {place:?} against {:?}", places[pin - 1]);
            if name == "peaucellier" {
                // The product of the distances is that of the squares' difference, so that a circle through the pivot gives a line.
                let products = [place, places[1]].map(|at| far(at, places[2])).iter().product::<f64>();
                assert!((products - 82.0 * 92.0).abs() < 1e-3, "{products}");
            }
            if name == "pantograph" {
                // The copy is twice as large, about the fixed pin.
                let twice = [0, 1].map(|axis| 2.0 * places[1][axis] - places[2][axis]);
                assert!(far(place, twice) < 1e-5, "{place:?} against {twice:?}");
            }
            heights.push(place[1]);
        }
        // A leg steps level: for two fifths of its time the foot is near the ground.
        if ["foot", "leg"].contains(&body) {
            let (low, high) =
                heights.iter().fold((f64::MAX, f64::MIN), |(low, high), y| (low.min(*y), high.max(*y)));
            let down = heights.iter().filter(|y| **y - low < 0.15 * (high - low)).count();
            assert!(down > 30, "{name}: {down} of 73");
        }
    }
    let (scene, _) = self::scene("four-bar.linkage2");
    let lengths = [far([20.0, 0.0], [50.0, 60.0]), far([50.0, 60.0], [80.0, 0.0])];
    let mut before = [50.0, 60.0];
    for (angle, place) in path(&scene, "link2", "p2") {
        let crank = [20.0 * angle.cos(), 20.0 * angle.sin()];
        before = self::dyad(crank, lengths[0], [80.0, 0.0], lengths[1], before);
        near(place, before);
    }
}

#[test]
fn mechanisms_with_slides_have_their_closed_forms() {
    let (scene, _) = self::scene("whitworth.pmks");
    for (angle, [x, y]) in path(&scene, "output", "p4") {
        let output = (40.0 * angle.sin()).atan2(40.0 * angle.cos() + 25.0);
        near([x, y], [85.0 * output.cos() - 25.0, 85.0 * output.sin()]);
    }
    let (scene, _) = self::scene("scotch-yoke.pmks");
    for (angle, place) in path(&scene, "yoke", "p4") {
        near(place, [30.0 * angle.cos(), 0.0]);
    }
    let (scene, _) = self::scene("swinging-cylinder.pmks");
    for (angle, place) in path(&scene, "cylinder", "p5") {
        let swing = (20.0 * angle.sin()).atan2(90.0 - 20.0 * angle.cos());
        near(place, [90.0 - 40.0 * swing.cos(), 40.0 * swing.sin()]);
    }
    let (scene, linkage) = self::scene("toggle-press.pmks");
    let mut places: Vec<[f64; 2]> = linkage.pins.iter().map(|pin| pin.at).collect();
    for (angle, place) in path(&scene, "ram", "p5") {
        solved(&linkage, angle, &[(3, [2, 4], false)], &mut places);
        let [x, y] = places[2];
        near(place, [55.0, y - (65.0_f64.powi(2) + 25.0 - (55.0 - x).powi(2)).sqrt()]);
    }
    let (scene, _) = self::scene("scissor-lift.pmks");
    let left = path(&scene, "table", "p8");
    for ((angle, [x, y]), (_, left)) in path(&scene, "table", "p7").into_iter().zip(left) {
        // Bars of 100 mm at an angle, of which one is driven at a quarter of its length.
        let pushed = far([0.75 * x, 0.25 * y], [150.0 - 12.0 * angle.sin(), 12.0 * angle.cos()]);
        assert!(
            (x.hypot(y) - 100.0).abs() < 1e-6 && (pushed - far([60.0, 15.0], [150.0, 12.0])).abs() < 1e-6
        );
        near(left, [x - 80.0, y]);
    }
}

#[test]
fn a_landing_gear_folds_by_the_stroke_of_its_cylinder() {
    let (scene, linkage) = scene("landing-gear.linkage2");
    let at = |k: usize| linkage.pins[k].at;
    let wheel = path(&scene, "link0", "p2")[36].1;
    let short = far(at(5), at(6)) - 12.0;
    let push = dyad(at(4), far(at(4), at(5)), at(6), short, at(5));
    let knee = carried([at(4), at(5), at(3)], at(4), push);
    let brace = dyad(at(0), far(at(0), at(1)), knee, far(at(3), at(1)), at(1));
    near(wheel, carried([at(0), at(1), at(2)], at(0), brace));
    assert!(far(wheel, at(2)) > 10.0, "{wheel:?}");
}

#[test]
fn a_link_of_pmks_plus_moves_by_its_closed_forms() {
    let (scene, linkage) = scene("slots.pmksplus");
    assert_eq!(linkage.unread, ["force 2F1,BC,F1,VG,Fe,VG,0,1E8"]);
    assert_eq!(linkage.driven().map(|(_, pin, speed)| (pin.at, speed)), Some(([0.0; 2], -20.0)));
    // The crank of 3 cm begins upward; a rod of 5 cm with its block on the ground, and a lever with the crank's pin in its slot.
    for (angle, place) in path(&scene, "BC", "C") {
        let [x, y] = [-30.0 * angle.sin(), 30.0 * angle.cos()];
        near(place, [x + (2500.0 - y * y).sqrt(), 0.0]);
    }
    for (angle, place) in path(&scene, "DE", "E") {
        let [x, y] = [60.0 - 30.0 * angle.sin(), 30.0 * angle.cos()];
        let share = 120f64.hypot(60.0) / x.hypot(y);
        near(place, [share * x - 60.0, share * y]);
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

#[test]
fn what_cannot_be_read_is_said_with_its_place() {
    for (text, said) in [
        ("<linkage3/>", "<linkage2> was expected"),
        ("<linkage2><connector id=\"0\" x=\"a\" y=\"0\"/></linkage2>", "1:11: x = \"a\" is no number"),
        ("ground,a,R,0,zero", "line 1: \"zero\" where a number was expected"),
        ("ground,a,R,0,0", "no input"),
        (
            "ground,input,R,0,0\ninput,yoke,RP,30,0,90\nyoke,ground,P,30,0,0",
            "no hinge beside that of its drive",
        ),
        ("https://app.pmksplus.com/", "copy the whole link"),
        ("https://app.pmksplus.com/?2P.Fe.K,0.1011.MA,A,0,0", "MA,A,0,0: expected flags with a name"),
        ("https://app.pmksplus.com/?2P.Fe.K,0.1011.MA,A,0,+,0", "\"+\" is no number of PMKS+"),
        ("https://app.pmksplus.com/?2P.Fe.K,0.1011.MA,A,0,0,0..YRAB,AB,0,0,0,0,,A,B,,..", "no joint B"),
    ] {
        let fault = read(text).unwrap_err();
        assert!(fault.contains(said), "{fault}");
    }
    let linkage = read("ground,input,R,0,0\ninput,a,R,1,0\nd=0").unwrap();
    assert_eq!(linkage.unread, ["line 3: d=0"]);
}
