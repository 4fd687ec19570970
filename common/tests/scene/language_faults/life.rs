//! Faults of the cycle.

use super::{EVERYTHING, faults};
use common::scene::SceneSource;

#[test]
fn life() {
    let life = "[life]";
    let fault = |from: &str, to: &str, expected: &str| {
        let found = faults(life, from, to);
        assert_eq!(found.len(), 1, "{found:#?}");
        assert!(found[0].contains(expected), "found    {}\nexpected {expected}", found[0]);
    };
    fault(
        "period = \"0.1 s\"\n",
        "",
        "life.period: is missing, expected a time: the scene has 4 driven bodies, not one",
    );
    fault(
        "settle_cycles = 3",
        "settle_cycles = -1",
        "life.settle_cycles: -1 is out of range, allowed: 0 to 1000",
    );
    fault("settle_cycles = 3", "settle_cycles = 1001", "life.settle_cycles: 1001 is out of range");
    // issue: a hundred million checkpoints passed, and failed after the simulation.
    fault(
        "cycles = 2000\ncheckpoint_every = 1000",
        "cycles = 100000000\ncheckpoint_every = 1",
        "life.checkpoint_every: 1 is out of range, allowed: so long that cycles = 100000000 has at most 100000 checkpoints",
    );
    fault(
        "cycles = 2000\ncheckpoint_every = 1000",
        "cycles = 90000\ncheckpoint_every = 1",
        "life.checkpoint_every: 90000 checkpoints of 22 outputs are more than 200000 values",
    );
    // 0.15 s holds three tables of the wheel, half a turn each, and half of a turn of the crank, the cam and the lever.
    let mut found = faults(life, "\"0.1 s\"", "\"0.15 s\"");
    assert_eq!(found.len(), 5, "{found:#?}");
    let cylinder = found.pop().expect("five");
    assert!(cylinder.contains("0.1 s, the period of joints.cylinder.length"), "{cylinder}");
    let wheel = found.remove(1);
    assert!(wheel.contains("bodies.wheel.speed.value: advances by 540 deg over a cycle"), "{wheel}");
    for (fault, body) in found.iter().zip(["crank", "cam", "lever"]) {
        let expected =
            format!("life.period: a cycle of 0.15 s is not a multiple of 0.1 s, the period of bodies.{body}");
        assert!(fault.contains(&expected), "{fault}");
    }
    // A motion seen once, from its start, may be cut anywhere.
    let once = EVERYTHING
        .replacen(
            "\"0.1 s\"\ncycles = 2000\ncheckpoint_every = 1000",
            "\"0.15 s\"\ncycles = 1\ncheckpoint_every = 1",
            1,
        )
        .replacen("settle_cycles = 3", "settle_cycles = 0", 1);
    let found = SceneSource::parse(&once, "once").unwrap_err().to_string();
    assert!(
        found.contains("conditions: a motion that is seen once, in one cycle, has no conditions"),
        "{found}"
    );
    let (before, after) = once.split_once("[[conditions]]").unwrap();
    let once = format!("{before}[study]{}", after.split_once("[study]").unwrap().1);
    assert_eq!(SceneSource::parse(&once, "once").unwrap().nominal().life.period, 0.15);
}

#[test]
fn without_a_repeating_drive_the_period_must_be_given() {
    let four_bar = SceneSource::builtin("four-bar").unwrap().text().to_owned();
    let angle = "angle = { over = \"time\", at = [\"0 s\", \"1 s\"], value = [\"0 deg\", \"9 deg\"], repeat = false }";
    let text = four_bar.replacen("start_angle = \"0 deg\"\nspeed = \"900 r/min\"", angle, 1);
    let found = SceneSource::parse(&text, "my.toml").unwrap_err().to_string();
    assert!(
        found.contains("life.period: is missing, expected a time: the table of \"crank\" does not repeat"),
        "{found}"
    );
}
