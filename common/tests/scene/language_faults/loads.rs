//! Faults of loads.

use super::one_fault;

#[test]
fn loads() {
    one_fault("spring", "type = \"spring\"", "type = \"sprung\"", "did you mean \"spring\"?");
    one_fault(
        "spring",
        "stiffness = \"2 N/mm\"",
        "stiffness = \"-2 N/mm\"",
        "loads.spring.stiffness: \"-2 N/mm\"",
    );
    one_fault(
        "spring",
        "\"4 N s/m\"",
        "\"4 N m s\"",
        "loads.spring.damping: \"4 N m s\" is a torsional damping",
    );
    one_fault(
        "spring",
        "\"30 mm\"",
        "\"-30 mm\"",
        "loads.spring.free_length: \"-30 mm\" is out of range, allowed: >= 0",
    );
    let frame = "b = { body = \"frame\", point = \"origin\" }";
    one_fault(
        "spring",
        frame,
        "b = { body = \"rod\", point = \"near\" }",
        "loads.spring: a and b are on the same body",
    );
    one_fault("torsion", "b = \"frame\"", "b = \"rod\"", "loads.torsion: a and b are the same body");
    one_fault(
        "torsion",
        "b = \"frame\"",
        "b = \"fram\"",
        "there is no body \"fram\", did you mean \"frame\"?",
    );
    one_fault(
        "torsion",
        "\"0.5 N m/rad\"",
        "\"0.5 N/m\"",
        "loads.torsion.stiffness: \"0.5 N/m\" is a stiffness, expected a torsional stiffness (N m/rad, N m/deg, ...)",
    );
    one_fault(
        "torsion",
        "\"0.01 N m s/rad\"",
        "\"0.01 N m\"",
        "expected a torsional damping (N m s/rad, ...)",
    );
    one_fault(
        "push",
        "direction = [3, 4]",
        "direction = [0, 0]",
        "loads.push.direction: [0, 0] is out of range",
    );
    one_fault(
        "push",
        "\"1 N\"] }",
        "\"1.5 N\"] }",
        "loads.push.size.value: starts with 1 N and ends with 1.5 N",
    );
    one_fault(
        "push",
        "size = {",
        "size = \"3 N\"\n#",
        "loads.push.size: \"3 N\" is a text, expected a table",
    );
    one_fault(
        "pull",
        "{ angle = \"crank\" }",
        "{ angle = \"crnk\" }",
        "loads.pull.size.over.angle: there is no body",
    );
    one_fault("pull", "{ angle = \"crank\" }", "{ }", "loads.pull.size.over.angle: is missing");
    one_fault(
        "pull",
        "{ angle = \"crank\" }",
        "{ angle = \"frame\" }",
        "loads.pull.size.over.angle: the angle of \"frame\" does not change: it is fixed",
    );
    one_fault(
        "pull",
        "{ angle = \"crank\" }",
        "\"angle\"",
        "loads.pull.size.over: \"angle\" is unknown; allowed: time",
    );
    one_fault(
        "pull",
        "\"180 deg\"",
        "\"200 deg\"",
        "loads.pull.size.at: repeats every 200 deg, and 360 deg is not a multiple of that",
    );
    one_fault(
        "twist",
        "\"30 deg\"]",
        "\"30 s\"]",
        "loads.twist.torque.at.2: \"30 s\" is a time, expected an angle",
    );
    one_fault(
        "twist",
        "\"2 N m\"",
        "\"2 N\"",
        "loads.twist.torque.value.2: \"2 N\" is a force, expected a torque",
    );
    one_fault(
        "motor",
        "no_load_speed = \"-3000 r/min\"",
        "no_load_speed = \"0 r/min\"",
        "loads.motor.no_load_speed: \"0 r/min\" is out of range, allowed: not 0",
    );
    one_fault(
        "motor",
        "stall_torque = \"-",
        "stall_torque = \"",
        "loads.motor: stall_torque and no_load_speed have",
    );
}

#[test]
fn drags() {
    let linear = "linear = \"0.2 N s/m\"";
    one_fault(
        "air",
        linear,
        "linear = \"-0.2 N s/m\"",
        "loads.air.linear: \"-0.2 N s/m\" is out of range, allowed: >= 0",
    );
    one_fault(
        "air",
        linear,
        "linear = \"0.2 N\"",
        "loads.air.linear: \"0.2 N\" is a force, expected a damping",
    );
    one_fault(
        "air",
        "1.5 N s^2/m^2",
        "1.5 N s/m",
        "loads.air.quadratic: \"1.5 N s/m\" is a damping, expected a quadratic drag (N s^2/m^2, kg/m, ...)",
    );
    one_fault("air", "-20 m/s", "-20 m", "loads.air.flow: \"-20 m\" is a length, expected a speed");
    one_fault(
        "air",
        "0.25",
        "-0.25",
        "loads.air.factor.value: -0.25 is out of range, allowed: >= 0: a drag slows down",
    );
    one_fault(
        "air",
        "direction = [0, 3]",
        "direction = [0, 0]",
        "loads.air.direction: [0, 0] is out of range",
    );
    one_fault(
        "water",
        "quadratic = \"2 kg/m\"\n",
        "",
        "loads.water.quadratic: is missing, expected a quadratic drag",
    );
    one_fault(
        "fan",
        "2e-5 N m s^2/rad^2",
        "2e-5 N m s/rad",
        "loads.fan.quadratic: \"2e-5 N m s/rad\" is a torsional damping, expected a quadratic torsional drag",
    );
    one_fault(
        "fan",
        "\"20 ms\", \"50 ms\"",
        "\"20 ms\", \"70 ms\"",
        "life.period: a cycle of 0.1 s is not a multiple of 0.07 s",
    );
    one_fault("plain_fan", "body = \"slider\"", "body = \"slidr\"", "there is no body \"slidr\"");
    one_fault("plain_fan", "linear", "flow = \"1 m/s\"\nlinear", "loads.plain_fan.flow: unknown key");
}
