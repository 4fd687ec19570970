//! Replies of programs that give cycles: closed, as tables, and wrong.

use super::cycle_reply::ExpectedCycle;
use super::joint_cycle::{CycleContacts, CycleJoint, CycleSurfaces};
use super::reply::NoResult;
use serde_json::{Value, json};
use std::f64::consts::TAU;

fn expected() -> ExpectedCycle {
    let surfaces = CycleSurfaces::Bore { journal_radius: 4e-3, has_worn_journal: false };
    let joint = |name: &str| CycleJoint { name: name.into(), surfaces };
    ExpectedCycle { joints: vec![joint("pin")], outputs: vec![None, Some("speed".into())], period: 1.0 }
}

/// A journal that turns once, under a force of 10 N that turns with it; the last of `n` + 1 instants is left out.
fn turning(n: usize) -> Value {
    let time: Vec<f64> = (0..n).map(|k| k as f64 / n as f64).collect();
    let of = |f: fn(f64) -> f64| -> Vec<f64> { time.iter().map(|t| f(TAU * t)).collect() };
    let pin =
        json!({ "force_x": of(|a| 10.0 * a.cos()), "force_y": of(|a| 10.0 * a.sin()), "angle": of(|a| a) });
    json!({ "time": time, "joints": { "pin": pin }, "outputs": { "speed": 2.5 } })
}

fn fault(reply: &Value) -> String {
    match expected().read(&reply.to_string(), 7) {
        Err(NoResult::Fault(fault)) => fault,
        Err(NoResult::Failure(failure)) => failure.to_string(),
        Ok(_) => "none".into(),
    }
}

#[test]
fn a_cycle_is_closed_and_slides_by_its_angle() {
    let found = expected().read(&turning(48).to_string(), 0).unwrap();
    assert_eq!(found.outputs, [0.0, 2.5]);
    let pin = &found.joints[0];
    let CycleContacts::Bore { force, angle: Some(angle), .. } = &pin.contacts else { panic!("a bore") };
    assert_eq!((pin.time.len(), pin.time[48], force[48]), (49, 1.0, force[0]));
    assert!((angle[48] - TAU).abs() < 1e-12);
    assert!(pin.sliding.iter().all(|v| (v - 4e-3 * TAU).abs() < 1e-12), "{:?}", pin.sliding);
    // Force and speed are constant.
    assert!(found.sampling_error < 1e-12);
}

#[test]
fn bad_replies_are_named_by_their_field() {
    let changed = |pointer: &str, value: Value| {
        let mut reply = turning(48);
        *reply.pointer_mut(pointer).unwrap() = value;
        fault(&reply)
    };
    let without = |of: &str, key: &str| {
        let mut reply = turning(48);
        reply.pointer_mut(of).unwrap().as_object_mut().unwrap().remove(key);
        fault(&reply)
    };
    let half: Vec<f64> = (0..48).map(|k| f64::from(k) / 96.0).collect();
    let degrees: Vec<f64> = (0..48).map(|k| 7.5 * f64::from(k)).collect();
    for (found, said) in [
        (changed("/time", json!(half)), "joints.pin.time covers 0.4895833333333333 s of a cycle of 1 s"),
        (
            changed("/time/3", json!(0.0)),
            "joints.pin.time[3] is 0 s after 0.041666666666666664 s: instants ascend",
        ),
        (
            changed("/joints/pin/force_x/5", Value::Null),
            "the simulator returned null for output joints.pin.force_x[5] at cycle 7",
        ),
        (
            changed("/joints/pin/force_x/5", json!("nan")),
            "the simulator returned nan for output joints.pin.force_x[5] at cycle 7",
        ),
        (
            changed("/joints/pin/force_x/5", json!("no")),
            "joints.pin.force_x[5] is \"no\" instead of a number",
        ),
        (
            changed("/joints/pin/force_y", json!([1, 2])),
            "joints.pin.force_y has 2 values, expected 48 as time",
        ),
        (changed("/joints/pin/force_y", json!(3)), "joints.pin.force_y is 3, expected a list"),
        (
            changed("/joints/pin/angle", json!(degrees)),
            "joints.pin.angle advances by 57.2958 turns over the cycle, not by whole ones: it is in radians",
        ),
        (changed("/joints", json!({ "Pin": {} })), "joints.pin is missing; found: Pin"),
        (without("/joints/pin", "force_x"), "joints.pin.force_x is missing"),
        (without("/joints/pin", "angle"), "joints.pin: neither sliding nor angle is given"),
        (without("", "time"), "joints.pin.time is missing"),
        (without("/outputs", "speed"), "outputs.speed is missing"),
        (
            json!({ "failure": "locked" }).to_string().parse::<Value>().map(|reply| fault(&reply)).unwrap(),
            "the simulator reports: locked",
        ),
    ] {
        assert_eq!(found, said);
    }
    let mut reply = turning(48);
    reply["joints"]["pin"]["sliding"] = json!(vec![-0.025; 48]);
    assert_eq!(
        fault(&reply),
        "joints.pin.sliding is against the rate of angle: the bushing's frame turns the wrong way, or one of them is bushing minus journal"
    );
    let mut reply = turning(48);
    for axis in ["x", "y"] {
        let force = reply["joints"]["pin"][format!("force_{axis}")].as_array().unwrap().clone();
        let e: Vec<f64> = force.iter().map(|f| -3e-6 * f.as_f64().unwrap()).collect();
        reply["joints"]["pin"][format!("eccentricity_{axis}")] = json!(e);
    }
    assert_eq!(
        fault(&reply),
        "joints.pin.force_x and force_y point against the eccentricity: they are the force of the journal on the bushing, in the bushing's frame"
    );
    reply["joints"]["pin"]["eccentricity_x"] = json!(vec![0.03; 48]);
    assert_eq!(
        fault(&reply),
        "joints.pin.eccentricity_x and eccentricity_y reach 0.03 m, beyond the journal's radius of 0.004 m: they are in metres"
    );
    // A force of seven pulses, sampled twice a pulse.
    let mut reply = turning(48);
    let pulses: Vec<f64> = (0..48).map(|k| 100.0 * f64::from(k % 2)).collect();
    reply["joints"]["pin"]["force_x"] = json!(pulses);
    assert!(
        fault(&reply).starts_with("joints.pin.force_x and force_y jump between instants"),
        "{}",
        fault(&reply)
    );
}

#[test]
fn a_table_gives_the_same_cycle() {
    let reply = turning(48);
    let mut table = "time, pin.force_x, pin.force_y, pin.angle, speed\n".to_owned();
    let column = |pointer: &str| reply.pointer(pointer).unwrap().as_array().unwrap().clone();
    let columns = ["/time", "/joints/pin/force_x", "/joints/pin/force_y", "/joints/pin/angle"].map(column);
    for k in 0..48 {
        let row: Vec<String> = columns.iter().map(|column| column[k].to_string()).collect();
        table += &format!("{}, 2.5\n", row.join(", "));
    }
    assert_eq!(expected().read(&table, 0), expected().read(&reply.to_string(), 0));
    let said = expected().read(&table.replacen("2.5\n", "\n", 1), 0).unwrap_err();
    assert_eq!(said, NoResult::Fault("line 2, column speed: \"\" is no number".into()));
}
