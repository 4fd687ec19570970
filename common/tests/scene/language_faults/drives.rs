//! Faults of drives and of tables.

use super::{faults, one_fault};

#[test]
fn drives() {
    let speed = "speed = \"600 r/min\"\n";
    one_fault("crank", speed, "", "bodies.crank.speed: is missing, expected an angular velocity (r/min");
    one_fault(
        "crank",
        speed,
        "speed = \"0 * 600 r/min\"\n",
        "bodies.crank.speed: \"0 * 600 r/min\" = 0 r/min is out of range, allowed: not 0",
    );
    let angle = "angle = { over = \"time\", at = [\"0 s\", \"1 s\"], value = [\"0 deg\", \"1 deg\"] }";
    one_fault("crank", speed, &format!("{speed}{angle}\n"), "give either speed or angle, not both");
    one_fault(
        "cam",
        "angle = {",
        "angle = \"3 deg\"\n#",
        "bodies.cam.angle: \"3 deg\" is a text, expected a table",
    );
    one_fault(
        "cam",
        "angle = {",
        "start_angle = \"3 deg\"\nangle = {",
        "bodies.cam.start_angle: belongs to speed",
    );
    one_fault("crank", "mass = \"0.2 kg\"\n", "", "bodies.crank.mass: is missing, expected a mass");
    one_fault("crank", "inertia = \"1e-5 kg m^2\"\n", "", "bodies.crank.inertia: is missing");
    one_fault(
        "crank",
        "inertia = \"1e-5 kg m^2\"",
        "inertia = \"0 g mm^2\"",
        "bodies.crank.inertia: \"0 g mm^2\"",
    );
    let both = faults("name = \"wheel\"", "[[bodies]]", "centre_of_mass = [\"0 m\", \"0 m\"]\n[[bodies]]");
    assert_eq!(both.len(), 2, "{both:#?}");
    assert!(both[0].contains("wheel.mass: is missing") && both[1].contains("wheel.inertia: is missing"));
    one_fault("rod", "start_speed = \"60 r/min\"", "start_speed = \"60 m/s\"", "bodies.rod.start_speed");
    one_fault(
        "rod",
        "start_velocity = [\"1 m/s\",",
        "start_velocity = [\"1 m\",",
        "bodies.rod.start_velocity.x",
    );
}

#[test]
fn tables() {
    one_fault("wheel", "over = \"time\"", "over = \"tyme\"", "bodies.wheel.speed.over: \"tyme\" is unknown");
    one_fault("wheel", "over = \"time\", ", "", "bodies.wheel.speed.over: is missing, expected \"time\"");
    one_fault(
        "wheel",
        "over = \"time\"",
        "over = { angle = \"crank\" }",
        "bodies.wheel.speed.over: the value is a table, expected \"time\"",
    );
    one_fault(
        "wheel",
        "\"20 ms\"",
        "\"50 ms\"",
        "bodies.wheel.speed.at.3: 0.05 s is out of range, allowed: > 0.05 s, the argument before it",
    );
    one_fault(
        "wheel",
        "\"20 ms\"",
        "\"20 mm\"",
        "bodies.wheel.speed.at.2: \"20 mm\" is a length, expected a time",
    );
    one_fault("wheel", "\"1200 r/min\", ", "", "bodies.wheel.speed.value: has 2 values for 3 arguments");
    one_fault(
        "wheel",
        "\"0 r/min\"] }",
        "\"3 r/min\"] }",
        "speed.value: starts with 0 r/min and ends with 3 r/min: a table that repeats ends with the value it starts",
    );
    one_fault("wheel", "\"1200 r/min\"", "1200", "bodies.wheel.speed.value.2: 1200 has no unit");
    one_fault(
        "wheel",
        "at = [\"0 s\", \"20 ms\", \"50 ms\"]",
        "at = \"0 s\"",
        "\"0 s\" is a text, expected a list",
    );
    one_fault("wheel", "value = [", "values = 3, value = [", "bodies.wheel.speed.values: unknown key");
    one_fault(
        "cam",
        "repeat = true",
        "repeat = 1",
        "cam.angle.repeat: 1 is a number, expected true or false",
    );
    one_fault(
        "lever",
        "at = [\"0 s\", \"50 ms\", \"0.1 s\"], value = [\"0 deg\", \"10 deg\", \"0 deg\"]",
        "at = [\"0 s\"], value = [\"0 deg\"], repeat = false",
        "bodies.lever.angle.at: has 1 of the at least 2 arguments of a table",
    );
    // Two points that repeat would be a straight line.
    one_fault(
        "lever",
        "\"50 ms\", \"0.1 s\"], value = [\"0 deg\", \"10 deg\", \"0 deg\"]",
        "\"0.1 s\"], value = [\"0 deg\", \"10 deg\"]",
        "has 2 of the at least 3 arguments of a table",
    );
    let all = faults("name = \"wheel\"", "\"20 ms\", \"50 ms\"]", "\"20 ms\", \"5 ms\", \"1 ms\"]");
    assert_eq!(all.len(), 3, "{all:#?}");
}
