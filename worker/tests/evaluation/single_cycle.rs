//! Motions seen once, from their start: one cycle, none before it, with wear.

use crate::scenes::shown as run;
use common::accuracy::Accuracy;
use common::scene::SceneSource;

/// A rotor in a bore, brought up from rest by a constant torque; its centre of mass is off the axis.
const ROTOR: &str = include_str!("scenes/rotor.toml");

#[test]
fn issue_a_single_cycle_from_rest_was_restarted_as_if_it_repeated() {
    let scene = SceneSource::parse(ROTOR, "rotor").expect("valid").nominal().clone();
    let (draft, reference) = (run(&scene, &Accuracy::draft()), run(&scene, &Accuracy::reference()));
    // m w^2 r at the end, with w = M t / (I + m r^2).
    let speed = 0.1 * 2.0 / (0.005 + 1e-6);
    let exact = speed * speed * 1e-3;
    for evaluation in [&draft, &reference] {
        let (force, error) = (evaluation.histories[1][0], evaluation.errors[1][0]);
        assert!((force / exact - 1.0).abs() < 0.05, "{force} against {exact}");
        assert_eq!(force, evaluation.joints[0].peak_force, "the output is that of the cycle measured");
        assert!(error < 0.1 * force, "{error}");
    }
    let ([worn, expected], [error, _]) = (
        [&draft, &reference].map(|evaluation| evaluation.histories[0][0]),
        [&draft, &reference].map(|evaluation| evaluation.errors[0][0]),
    );
    assert!(worn > 0.0 && (worn - expected).abs() < error.max(1e-3 * worn), "{worn} +- {error}, {expected}");
    assert!(error < 0.2 * worn, "{error}");
    assert_eq!(draft.diagnostics.simulated_cycles, 2, "the cycle, and the same cycle again for its error");
}

#[test]
fn issue_a_drive_that_does_not_repeat_failed_although_its_one_cycle_is_fine() {
    let stroke = "angle = { over = \"time\", at = [\"0 s\", \"50 ms\", \"0.1 s\"], value = [\"0 deg\", \"40 deg\", \"100 deg\"], \
                  repeat = false }";
    let four_bar = SceneSource::builtin("four-bar").expect("built in").text().to_owned();
    let life = "[life]\nperiod = \"0.1 s\"\ncycles = 1\ncheckpoint_every = 1\nsettle_cycles = 0\n";
    let text = four_bar.replacen("start_angle = \"0 deg\"\nspeed = \"900 r/min\"", stroke, 1).replacen(
        "[life]\ncycles = 8000\ncheckpoint_every = 1000\n",
        life,
        1,
    );
    let scene = SceneSource::parse(&text, "a-stroke").expect("valid").nominal().clone();
    let evaluation = run(&scene, &Accuracy::draft());
    let (speed, error) = (evaluation.histories[1][0], evaluation.errors[1][0]);
    assert!(speed > 0.0 && error < 0.2 * speed, "{speed} +- {error}");
    let first = evaluation.first_cycle.expect("asked for");
    let crank = first.motion.iter().find(|motion| motion.body == "crank").expect("it moves");
    assert!((crank.angle[crank.angle.len() - 1].to_degrees() - 100.0).abs() < 1e-9);
}
