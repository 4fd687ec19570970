//! Position of a mechanism's drives at a time, in words.

use common::scene::{Motion, Scene};
use worker::mechanism::Prescribed;

/// Angles of the driven bodies at a time [s], e.g. `crank angle 123.4 deg`.
pub fn drive_at(scene: &Scene, time: f64) -> String {
    let angles: Vec<String> = scene
        .bodies
        .iter()
        .filter_map(|body| {
            let motion = Prescribed::from_body(body).filter(|_| body.motion != Motion::Fixed)?;
            let turned = motion.angle(time).to_degrees().rem_euclid(360.0);
            Some(format!("{} angle {turned:.1} deg", body.name))
        })
        .collect();
    if angles.is_empty() { format!("t = {time} s") } else { angles.join(", ") }
}
