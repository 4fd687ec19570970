//! Influence of the gaps in joints with clearance on a coordinate of a mechanism whose drive is held.
//!
//! With the drive held at time t, the closures phi(q, t) = e leave no freedom: e `(m,)` are the gaps of the joints, zero for ideal joints
//! and the eccentricity e_j [m] in a joint with clearance. To first order in the gaps a coordinate o(q) moves by
//!
//!   delta o = o_q (dphi/dq)^-1 e = sum over j of g_j . e_j,
//!
//! with one vector g_j per joint with clearance: [1] for a length o, [1/m] for an angle. Valid for clearances that are small against the
//! lengths of the mechanism, away from dead points.
//!
//! # Source
//! Position error of linkages with clearance by the mechanism's Jacobian: Tsai, Lai (2004), Kinematic sensitivity analysis of linkage
//! with joint clearance based on transmission quality, Mechanism and Machine Theory 39, 1189-1206.

use super::assembly::ideal_cycle;
use super::closure::Closure;
use super::frame::Frame;
use super::prescribed::Prescribed;
use crate::plane::{dot, left};
use common::failure::SimulationFailure;
use common::scene::{JointKind, PlayOf, Scene};
use nalgebra::DVector;
use std::f64::consts::{PI, TAU};

/// Intervals of the cycle in which the time of an angle is sought.
const INTERVALS: usize = 720;

/// Joints with clearance of the scene with their vectors g_j in the bushing's frame `(2,)`, in the position in which the body `drive`
/// first has this angle up to whole turns [rad].
///
/// # Errors
/// [`SimulationFailure`] if the mechanism cannot be moved there, if the drive does not have that angle, or if the drives leave the
/// motion open.
pub(crate) fn gap_influences(
    scene: &Scene,
    of: &PlayOf,
    drive: usize,
    angle: f64,
    iterations: &mut u64,
) -> Result<Vec<(usize, [f64; 2])>, SimulationFailure> {
    let name = &scene.bodies[drive].name;
    let refuse = |what: String| SimulationFailure::NotModelled { what };
    let time = time_of(scene, drive, angle).ok_or_else(|| {
        refuse(format!("a backlash with {name} at {:.3} deg, an angle it does not have", angle.to_degrees()))
    })?;
    let poses = ideal_cycle(scene, INTERVALS + 1, iterations)?;
    if poses.len() <= INTERVALS {
        return Err(refuse("a backlash where the drives leave the ideal motion open".into()));
    }
    let before = poses.partition_point(|pose| pose.time <= time).max(1) - 1;
    let closure = Closure::new(scene);
    let mut q = DVector::from_vec(poses[before].q.iter().flatten().flatten().copied().collect());
    closure.close(time, &mut q, iterations).map_err(|open| SimulationFailure::CannotAssemble {
        joint: scene.joints[open.joint].name.clone(),
        time,
        gap: open.gap,
    })?;
    let at = closure.split(&q);
    let frame = |body: usize| match (at[body], Prescribed::from_body(&scene.bodies[body])) {
        (Some(q), _) => Frame::free(&q, &[0.0; 3]),
        (None, Some(motion)) => motion.frame(time),
        (None, None) => Frame::default(),
    };
    let gradient = match of {
        PlayOf::Angle(body) => (*body, [0.0, 0.0, 1.0]),
        PlayOf::Point { at, direction: [x, y] } => {
            let arm = frame(at.body).turn(scene.arm(at));
            (at.body, [*x, *y, dot([*x, *y], left(arm))])
        }
    };
    let Some(rows) = closure.gap_influence(time, &q, gradient) else {
        return Err(refuse(
            "a backlash at a dead point, or where the drives leave the ideal motion open".into(),
        ));
    };
    let with_clearance = scene.joints.iter().enumerate();
    let with_clearance = with_clearance.filter(|(_, joint)| matches!(joint.kind, JointKind::Clearance(_)));
    Ok(with_clearance.map(|(k, joint)| (k, frame(joint.bushing.body).turn_back(rows[k]))).collect())
}

/// The first time of the cycle at which a driven body has an angle up to whole turns [s].
fn time_of(scene: &Scene, drive: usize, angle: f64) -> Option<f64> {
    let motion = Prescribed::from_body(&scene.bodies[drive])?;
    let off = |t: f64| {
        let turned = (motion.angle(t) - angle).rem_euclid(TAU);
        if turned > PI { turned - TAU } else { turned }
    };
    let time = |k: usize| scene.life.period * k as f64 / INTERVALS as f64;
    if off(0.0).abs() < 1e-12 {
        return Some(0.0);
    }
    let crossed = |k: &usize| {
        let (a, b) = (off(time(*k)), off(time(*k + 1)));
        a * b <= 0.0 && (a - b).abs() < PI
    };
    let k = (0..INTERVALS).find(crossed)?;
    let (mut low, mut high) = (time(k), time(k + 1));
    let sign = off(low);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if off(middle) * sign > 0.0 { low = middle } else { high = middle }
    }
    Some(high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::scene::{Attachment, SceneSource};

    #[test]
    fn the_gap_of_a_piston_pin_moves_the_slider_by_the_inclination_of_the_rod() {
        // The guide holds the slider, the pin turns about the crank's: x moves by (e along the rod) / cos beta, the rod by
        // (e across, less what the slider takes) / l.
        let scene = SceneSource::builtin("slider-crank").expect("built in").nominal().clone();
        let body = |name: &str| scene.bodies.iter().position(|b| b.name == name).expect("there");
        let (crank, slider) = (body("crank"), body("slider"));
        let of = PlayOf::Point { at: Attachment { body: slider, position: [0.0; 2] }, direction: [1.0, 0.0] };
        for angle in [30.0_f64, 90.0, 200.0, 330.0, 390.0] {
            let angle = angle.to_radians();
            let found = gap_influences(&scene, &of, crank, angle, &mut 0).expect("it moves");
            let [(2, g)] = found[..] else { panic!("one joint with clearance: {found:?}") };
            let cos = (1.0 - (0.05 * angle.sin() / 0.12).powi(2)).sqrt();
            // In the rod's frame the first axis is along the rod.
            assert!((g[0] - 1.0 / cos).abs() < 1e-9 && g[1].abs() < 1e-9, "{angle}: {g:?} {cos}");
        }
    }

    #[test]
    fn an_angle_that_a_drive_does_not_have_is_refused() {
        let mut scene = SceneSource::builtin("four-bar").expect("built in").nominal().clone();
        scene.life.period *= 0.25;
        let of = PlayOf::Angle(3);
        assert!(gap_influences(&scene, &of, 1, 0.5, &mut 0).is_ok());
        let refused = gap_influences(&scene, &of, 1, 3.0, &mut 0);
        assert!(
            matches!(&refused, Err(SimulationFailure::NotModelled { what }) if what.contains("at 171.887 deg")),
            "{refused:?}"
        );
    }
}
