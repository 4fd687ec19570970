//! A scene as a program that gives cycles: requests of the wear loop on standard input, replies on standard output, as any multibody program
//! may give them.

use crate::simulate::{ServedCycle, simulate_one_cycle};
use common::accuracy::NamedAccuracy;
use common::external::{CycleContacts, JointCycle, WornSurfaces};
use common::scene::{Clearance, ControlPoints, GuideClearance, JointKind, OutputKind, Scene, SceneSource};
use serde::Deserialize;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::{BufRead, Result, Write};

/// A request, as far as it is read.
#[derive(Deserialize)]
struct Request {
    id: u64,
    sample: BTreeMap<String, f64>,
    accuracy: String,
    joints: BTreeMap<String, WornSurfaces>,
}

/// Answers requests until the input ends. Variables of the request that the scene has are set; the others of the scene are at their means.
///
/// # Errors
/// The input cannot be read, or the output cannot be written.
pub fn serve(source: &SceneSource, input: impl BufRead, mut output: impl Write) -> Result<()> {
    for line in input.lines() {
        let reply = match serde_json::from_str::<Request>(&line?) {
            Ok(request) => match answer(source, &request) {
                Ok(reply) => reply,
                Err(failure) => json!({ "id": request.id, "failure": failure }),
            },
            Err(error) => json!({ "failure": format!("not a request: {error}") }),
        };
        writeln!(output, "{reply}")?;
        output.flush()?;
    }
    Ok(())
}

fn answer(source: &SceneSource, request: &Request) -> std::result::Result<Value, String> {
    let settings: Vec<(String, f64)> = request
        .sample
        .iter()
        .filter(|(name, _)| source.variable(name).is_some())
        .map(|(name, value)| (name.clone(), *value))
        .collect();
    let sample = source.sample_with(&settings).map_err(|faults| faults.to_string())?;
    let mut scene = source.resolve_sample(&sample).map_err(|faults| faults.to_string())?;
    let accuracy: NamedAccuracy = request.accuracy.parse().map_err(|error| format!("accuracy: {error}"))?;
    let mut depths = BTreeMap::new();
    for (name, surfaces) in &request.joints {
        depths.insert(name.clone(), worn(&mut scene, name, surfaces)?);
    }
    let cycle =
        simulate_one_cycle(&scene, &accuracy.accuracy, &depths).map_err(|failure| failure.to_string())?;
    Ok(reply(request.id, &scene, &cycle))
}

/// Gives a joint as many control points as the request has; its depths [m].
fn worn(scene: &mut Scene, name: &str, surfaces: &WornSurfaces) -> std::result::Result<Vec<f64>, String> {
    let joint = scene.joints.iter_mut().find(|joint| joint.name == name);
    match (joint.map(|joint| &mut joint.kind), surfaces) {
        (Some(JointKind::Clearance(clearance)), WornSurfaces::Bore { bushing, journal }) => {
            clearance.control_points = ControlPoints::Number(bushing.len());
            let Clearance { bushing_radius, journal_radius, .. } = &*clearance;
            // Rounding of radii.
            let depth = |worn: f64| worn.max(0.0);
            let mut depths: Vec<f64> = bushing.iter().map(|radius| depth(radius - *bushing_radius)).collect();
            if clearance.wear_coefficients()[1] > 0.0 {
                depths.extend(journal.iter().map(|radius| depth(*journal_radius - radius)));
            }
            Ok(depths)
        }
        (
            Some(JointKind::Guide(GuideClearance { wear: Some(wear), .. })),
            WornSurfaces::Guide { guide, slider },
        ) => {
            wear.control_points = guide.len() / 2;
            Ok([&**guide, &**slider].concat())
        }
        _ => Err(format!("joints.{name}: the scene has no such joint with clearance or guide that wears")),
    }
}

fn reply(id: u64, scene: &Scene, cycle: &ServedCycle) -> Value {
    let column = |of: &[[f64; 2]], axis: usize| of.iter().map(|v| v[axis]).collect::<Vec<f64>>();
    let of_joint = |joint: &JointCycle| match &joint.contacts {
        CycleContacts::Bore { force, angle, eccentricity } => {
            let e = eccentricity.as_deref().unwrap_or_default();
            json!({
                "time": joint.time,
                "force_x": column(force, 0), "force_y": column(force, 1),
                "sliding": joint.sliding, "angle": angle,
                "eccentricity_x": column(e, 0), "eccentricity_y": column(e, 1),
            })
        }
        CycleContacts::Guide { load, position } => json!({
            "time": joint.time,
            "force": column(load, 0), "moment": column(load, 1), "normal": joint.normal,
            "sliding": joint.sliding, "position": position,
        }),
    };
    let joints: BTreeMap<&String, Value> =
        cycle.joints.iter().map(|(name, joint)| (name, of_joint(joint))).collect();
    let of_motion = |kind: &OutputKind| kind.wear().is_none();
    let outputs = scene.outputs.iter().zip(&cycle.outputs).filter(|(output, _)| of_motion(&output.kind));
    let outputs: BTreeMap<&String, f64> = outputs.map(|(output, value)| (&output.name, *value)).collect();
    json!({ "id": id, "joints": joints, "outputs": outputs })
}
