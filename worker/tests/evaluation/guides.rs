//! Sliders with clearance in their guides: closed forms of bounces, friction and energy, and the published slider-crank.

use crate::scenes::reference_shown as run;
use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::outputs::Evaluation;
use common::scene::*;
use worker::simulate::{SimulateOptions, simulate};

/// The slider-crank of Flores, Leine and Glocker (2010).
pub(crate) const PUBLISHED: &str = include_str!("../../../common/tests/scenes/guided-slider-crank.toml");

const MASS: f64 = 0.5;

/// A slider by itself in a horizontal guide, seen from its start.
const ALONE: &str = include_str!("scenes/slider-alone.toml");

fn parsed(text: &str) -> Scene {
    SceneSource::parse(text, "scene").expect("valid").nominal().clone()
}

/// The slider by itself, with a changed guide, pressed by `force` [N].
fn slider(force: [f64; 2], period: f64, change: impl Fn(&mut GuideClearance)) -> Scene {
    let mut scene = parsed(ALONE);
    scene.life.period = period;
    let at = Attachment { body: 1, position: [0.0; 2] };
    scene.loads = vec![Load::ConstantForce { name: "press".into(), at, force }];
    let JointKind::Guide(guide) = &mut scene.joints[0].kind else { panic!("it is a guide") };
    change(guide);
    scene
}

/// Times, and motion of the only body that moves.
fn history(evaluation: &Evaluation) -> (&[f64], &[[f64; 2]]) {
    let cycle = evaluation.first_cycle.as_ref().expect("asked for");
    (&cycle.time, &cycle.motion[0].position)
}

/// The cycle has one impact of this energy [J].
fn assert_impact(evaluation: &Evaluation, energy: f64) {
    let [number, found] = [1, 2].map(|output| evaluation.histories[output][0]);
    println!("{number} impacts, {found:e} J, closed form {energy:e} J");
    assert_eq!(number, 1.0);
    assert!((found / energy - 1.0).abs() < 0.01, "{found:e} J against {energy:e} J");
}

/// Restitution of an impact with the factor D v0 = `factor`: the root x of factor (1 + x) = ln[(1 + factor) / (1 - x factor)].
fn restitution(factor: f64) -> f64 {
    let off = |x: f64| factor * (1.0 + x) - ((1.0 + factor) / (1.0 - x * factor)).ln();
    let (mut low, mut high) = (1e-9, (1.0_f64).min(1.0 / factor - 1e-12));
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if off(middle) > 0.0 { low = middle } else { high = middle }
    }
    low
}

#[test]
fn a_slider_that_falls_on_its_face_returns_by_its_restitution() {
    const CLEARANCE: f64 = 5e-4;
    // Falls from the middle, 0.5 mm in 10.1 ms: the next apex is another sqrt(2 c / g) e after the impact.
    let fall = (2.0 * CLEARANCE / 9.81_f64).sqrt();
    for coefficient in [0.6, 0.8, 0.95, 1.0] {
        let damping =
            ContactDamping::Restitution { law: RestitutionLaw::Flores, coefficient, least_speed: 1e-4 };
        let e = if coefficient == 1.0 { 1.0 } else { restitution(1.6 * (1.0 - coefficient) / coefficient) };
        let scene =
            slider([0.0, -9.81 * MASS], fall * (1.0 + 1.5 * e), |guide| guide.contact_damping = damping);
        let evaluation = run(&scene);
        let (time, position) = history(&evaluation);
        let after = time.iter().zip(position).filter(|(time, _)| **time > 1.05 * fall);
        let apex = after.map(|(_, at)| at[1]).fold(f64::NEG_INFINITY, f64::max);
        let closed = CLEARANCE * (e * e - 1.0);
        println!("restitution {coefficient}: {e}, apex {apex:e}, closed form {closed:e}");
        assert!((apex - closed).abs() < 2e-3 * CLEARANCE, "{coefficient}: {apex:e} against {closed:e}");
        assert!(position.iter().all(|at| at[0].abs() < 1e-9), "it falls straight");
        assert_impact(&evaluation, MASS * 9.81 * CLEARANCE);
        let energy = evaluation.diagnostics.energy.expect("asked for");
        assert!(energy.residual().abs() < 2e-3 * energy.turnover, "{energy:?}");
        assert_eq!(energy.unphysical, 0.0);
        if coefficient == 1.0 {
            assert!(energy.dissipated.abs() < 1e-9 * energy.turnover, "{energy:?}");
        } else {
            let lost = (1.0 - e * e) * MASS * 9.81 * CLEARANCE;
            assert!((energy.dissipated / lost - 1.0).abs() < 0.01, "{energy:?} against {lost:e} J");
        }
    }
}

/// A force F beside the middle turns the slider, too: its corner, 30 mm from the middle, strikes first, after the time t = sqrt(2 c m'/F) with
/// 1/m' = 1/m + a x/J, where x is the arm of the force. The motion afterwards gives the impulse p of the contact and its arm a, the centre of
/// pressure. The normal velocity v = F t/m' there returns by the restitution; the force goes on during the contact of the time T, which ends where
/// it began: p (1/m + a^2/J) = (1 + e) v + T F/m'.
#[test]
fn a_slider_that_strikes_with_a_corner_returns_by_its_restitution() {
    const CLEARANCE: f64 = 5e-4;
    const INERTIA: f64 = 2e-4;
    const CORNER: f64 = 0.03;
    const FORCE: f64 = 0.05;
    const BESIDE: f64 = 0.01;
    let accelerated = |arm: f64| FORCE * (1.0 / MASS + arm * BESIDE / INERTIA);
    let strikes = (2.0 * CLEARANCE / accelerated(CORNER)).sqrt();
    for coefficient in [0.5, 0.7, 0.9, 1.0] {
        for side in [1.0_f64, -1.0] {
            let damping =
                ContactDamping::Restitution { law: RestitutionLaw::Flores, coefficient, least_speed: 1e-4 };
            let mut scene = slider([0.0, -FORCE], strikes + 4e-3, |guide| guide.contact_damping = damping);
            let Load::ConstantForce { at, .. } = &mut scene.loads[0] else { panic!("it is a force") };
            at.position = [side * BESIDE, 0.0];
            let evaluation = run(&scene);
            let (time, position) = history(&evaluation);
            let cycle = evaluation.first_cycle.as_ref().expect("asked for");
            let last = time.len() - 1;
            let touches: Vec<usize> = (0..=last).filter(|k| cycle.joint_force[0].1[*k] > 0.0).collect();
            let contact = time[touches[touches.len() - 1]] - time[touches[0] - 1];
            let after = time.iter().position(|time| *time > strikes + 1e-3).expect("within the cycle");
            let vertical = (position[last][1] - position[after][1]) / (time[last] - time[after]);
            let turned = side * cycle.motion[0].speed[last];
            let impulse = MASS * vertical + FORCE * 0.5 * (time[last] + time[after]);
            let arm = (INERTIA * turned + FORCE * BESIDE * time[last]) / impulse;
            let gained = impulse * (1.0 / MASS + arm * arm / INERTIA);
            let returned = gained / accelerated(arm) / strikes - 1.0 - contact / strikes;
            let e =
                if coefficient == 1.0 { 1.0 } else { restitution(1.6 * (1.0 - coefficient) / coefficient) };
            println!("restitution {coefficient}: {returned}, closed form {e}; pressed at {arm:e} m");
            assert!((returned - e).abs() < 0.005, "{coefficient}: {returned} against {e}");
            assert!(arm > 0.98 * CORNER && arm < CORNER, "{arm}");
            let approach = accelerated(CORNER) * strikes;
            assert_impact(&evaluation, 0.5 * approach * approach / (1.0 / MASS + CORNER * CORNER / INERTIA));
            let energy = evaluation.diagnostics.energy.expect("asked for");
            assert!(energy.residual().abs() < 2e-3 * energy.turnover, "{energy:?}");
            assert_eq!(energy.unphysical, 0.0);
        }
    }
}

#[test]
fn a_pressed_slider_slides_on_without_friction_and_stops_with_it() {
    let (speed, press, mu) = (0.5, 100.0, 0.2);
    let closed = MASS * speed * speed / (2.0 * mu * press);
    for friction in [0.0, mu] {
        let mut scene = slider([0.0, -press], 0.02, |guide| {
            guide.clearance = 1e-6;
            guide.contact_damping = ContactDamping::HuntCrossley { factor: 50.0 };
            guide.friction = friction;
        });
        if let Motion::Free { start_velocity, .. } = &mut scene.bodies[1].motion {
            *start_velocity = Some([speed, 0.0]);
        }
        let evaluation = run(&scene);
        let (time, position) = history(&evaluation);
        let (end, at) = (time[time.len() - 1], position[position.len() - 1][0]);
        let expected = if friction > 0.0 { closed } else { speed * end };
        println!("friction {friction}: {at:e} m, closed form {expected:e} m");
        let bound = if friction > 0.0 { 0.01 } else { 1e-6 };
        assert!((at / expected - 1.0).abs() < bound, "{friction}: {at} against {expected}");
        let energy = evaluation.diagnostics.energy.expect("asked for");
        assert!(energy.residual().abs() < 5e-3 * energy.turnover, "{energy:?}");
    }
}

#[test]
fn a_slider_that_leaves_its_guide_is_refused_by_name() {
    let mut scene = slider([0.0, -1.0], 0.1, |_| {});
    if let Motion::Free { start_velocity, .. } = &mut scene.bodies[1].motion {
        *start_velocity = Some([0.5, 0.0]);
    }
    // Its end is 20 mm from that of the guide.
    match simulate(&scene, &Accuracy::draft(), SimulateOptions::default()) {
        Err(SimulationFailure::NotModelled { what }) => {
            // The motion is not determined by the joints, so that it is not known what guide it needs.
            assert!(what.starts_with("joint rail: its slider stands out of its guide by"), "{what}");
            assert!(what.ends_with(" s"), "{what}");
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_slider_that_leaves_its_guide_is_told_what_guide_it_needs() {
    // The same crank, driven, in a guide that ends 59 mm too early: the slider reaches from 153 to 459 mm, and 50 mm further on either side.
    let from = PUBLISHED.find("name = \"crank\"").expect("there");
    let to = PUBLISHED[from..].find("[bodies.points]").expect("there") + from;
    let driven = "name = \"crank\"\nmotion = \"driven\"\nposition = [\"0 mm\", \"0 mm\"]\nstart_angle = \"0 deg\"\nspeed = \"3000 r/min\"\n";
    let text = format!("{}{driven}{}", &PUBLISHED[..from], &PUBLISHED[to..]);
    let bearing = text.find("[[joints]]\nname = \"crank_bearing\"").expect("there");
    let pin = text.find("[[joints]]\nname = \"crank_pin\"").expect("there");
    let text = format!("{}{}", &text[..bearing], &text[pin..]).replacen("520 mm", "450 mm", 1);
    // The start velocities are those of another drive.
    let lines =
        text.lines().filter(|line| !line.starts_with("start_velocity") && !line.starts_with("start_speed"));
    let text = lines.collect::<Vec<_>>().join("\n");
    match simulate(&parsed(&text), &Accuracy::draft(), SimulateOptions::default()) {
        Err(SimulationFailure::NotModelled { what }) => {
            let advice = "; with ideal joints it needs a guide_start of at most 103.000 mm and a guide_end of at least 509.000 mm";
            assert!(
                what.starts_with("joint guide: its slider stands out") && what.ends_with(advice),
                "{what}"
            );
        }
        other => panic!("{other:?}"),
    }
}

/// Rigid slider-crank with clearance in its guide. Free flight, with the equations of motion in crank and rod angle integrated by themselves
/// (Runge-Kutta, 1 us): y = 0.494396 mm and 120.464 rad/s at 2 ms; at 2.693 ms the slider meets the upper face at 0.84176 m/s, flat. The reference
/// results of Siconos for this benchmark (`SliderCrankMoreauJeanCombinedProjectionOSI.ref`, rigid impacts, steps of 0.1 ms) have 0.829 m/s between
/// 2.7 and 2.8 ms, both corners of the upper face at once, a bounce down to 0.785 of the clearance at 4.2 ms, and 92.19 rad/s there.
#[test]
fn the_published_slider_crank_strikes_its_guide_when_and_how_it_should() {
    let scene = parsed(PUBLISHED);
    let evaluation = run(&scene);
    let cycle = evaluation.first_cycle.as_ref().expect("asked for");
    let of = |body: &str| cycle.motion.iter().find(|motion| motion.body == body).expect("it moves");
    let (crank, slider) = (of("crank"), of("slider"));
    let at = |time: f64| cycle.time.iter().position(|t| *t > time - 1e-9).expect("within the cycle");
    let two = at(2e-3);
    assert!((cycle.time[two] - 2e-3).abs() < 1e-9, "{}", cycle.time[two]);
    assert!((slider.position[two][1] / 0.494396e-3 - 1.0).abs() < 1e-4, "{:?}", slider.position[two]);
    assert!((crank.speed[two] / 120.464 - 1.0).abs() < 1e-5, "{}", crank.speed[two]);
    let force =
        cycle.joint_force.iter().find(|(name, _)| name == "guide").map(|(_, f)| f).expect("its force");
    assert!(force[..at(2.68e-3)].iter().all(|f| *f == 0.0));
    let before = at(2.68e-3);
    let speed = (slider.position[before][1] - slider.position[before - 1][1])
        / (cycle.time[before] - cycle.time[before - 1]);
    assert!((speed / 0.8418 - 1.0).abs() < 0.01, "{speed} m/s before the impact");
    let (first, last) = (at(2.72e-3), at(4.7e-3));
    let bounce =
        (first..last).min_by(|&a, &b| slider.position[a][1].total_cmp(&slider.position[b][1])).expect("some");
    let (y, time) = (slider.position[bounce][1] / 1e-3, cycle.time[bounce]);
    println!(
        "bounce to {y} of the clearance at {time} s; {} rad/s at 4.2 ms; joints {:?}",
        crank.speed[at(4.2e-3)],
        evaluation.joints
    );
    println!("tilt {:e}", slider.angle[first..last].iter().fold(0.0_f64, |a, b| a.max(b.abs())));
    assert!((y - 0.785).abs() < 0.015 && (time - 4.2e-3).abs() < 2e-4, "{y} at {time}");
    assert!((crank.speed[at(4.2e-3)] / 92.19 - 1.0).abs() < 0.01, "{}", crank.speed[at(4.2e-3)]);
    let energy = evaluation.diagnostics.energy.expect("asked for");
    println!("energy off by {:e} of the turnover", energy.residual() / energy.turnover);
    assert!(energy.residual().abs() < 2e-3 * energy.turnover && energy.dissipated > 0.0, "{energy:?}");
}
