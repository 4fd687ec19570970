//! The model of a scene and its expected cost: part of `coordinator explain`.

use super::output::count;
use common::accuracy::NamedAccuracy;
use common::scene::{Motion, Scene};
use coordinator::presentation::format::duration;
use serde_json::{Value, json};
use std::fmt::Write;
use worker::simulate::{ContactArc, FirstLook, IslandModel, first_look};

/// The first cycle of a scene, or the failure of its simulation.
pub struct Model {
    look: Result<FirstLook, String>,
    accuracy: String,
}

impl Model {
    /// Simulates the settled first cycle at the accuracy of the study.
    pub fn new(scene: &Scene, accuracy: &NamedAccuracy) -> Self {
        let look = first_look(scene, &accuracy.accuracy).map_err(|failure| failure.to_string());
        Model { look, accuracy: accuracy.name.clone() }
    }

    /// The model as JSON.
    pub fn to_json(&self) -> Value {
        let look = match &self.look {
            Ok(look) => look,
            Err(failure) => return json!({ "failure": failure }),
        };
        let island = |i: &IslandModel| {
            json!({ "bodies": i.bodies, "unknowns": i.unknowns, "constraints": i.constraints,
                    "contacts": i.contacts, "ideal_joints": i.ideal_joints })
        };
        let arc = |a: &ContactArc| json!({ "joint": a.joint, "arc_rad": a.arc, "control_point_spacing_rad": a.spacing });
        json!({
            "islands": look.islands.iter().map(island).collect::<Vec<_>>(),
            "contact_arcs": look.arcs.iter().map(arc).collect::<Vec<_>>(),
            "wears": look.wears,
            "tier": if look.tier.is_ok() { "quasi-static" } else { "dynamic" },
            "why": why(look),
            "accuracy": self.accuracy,
            "steps_per_cycle": look.steps_per_cycle,
            "dynamic_cycles": look.dynamic_cycles,
            "quasi_static_cycles": look.quasi_static_cycles,
            "expected_s": look.expected.as_secs_f64(),
        })
    }

    /// Expected time of an evaluation; none if the first cycle cannot be simulated.
    pub fn expected(&self) -> Option<String> {
        let look = self.look.as_ref().ok()?;
        let (seconds, steps, accuracy) = (look.expected.as_secs_f64(), look.steps_per_cycle, &self.accuracy);
        let time =
            if seconds < 60.0 { format!("{seconds:.2} s") } else { duration(seconds).replace('\u{a0}', " ") };
        Some(format!("about {time} a simulation at `{accuracy}` here, {steps} time steps a cycle"))
    }

    /// Writes the model as text.
    pub fn write(&self, out: &mut String, scene: &Scene) -> std::fmt::Result {
        writeln!(out, "Model")?;
        let look = match &self.look {
            Ok(look) => look,
            Err(failure) => return writeln!(out, "  The first cycle cannot be simulated: {failure}.\n"),
        };
        match scene.bodies.iter().filter(|b| !matches!(b.motion, Motion::Free { .. })).count() {
            1 => writeln!(out, "  1 body with prescribed motion costs nothing.")?,
            given => writeln!(out, "  {given} bodies with prescribed motion cost nothing.")?,
        }
        for (k, i) in look.islands.iter().enumerate() {
            writeln!(
                out,
                "  island {}, with its own time steps: {}; {} unknowns, {} of {}, {}",
                k + 1,
                i.bodies.join(" + "),
                i.unknowns,
                count(i.constraints, "constraint"),
                count(i.ideal_joints.len(), "ideal joint"),
                count(i.contacts.len(), "contact")
            )?;
        }
        look.arcs.iter().try_for_each(|arc| write_arc(out, arc))?;
        writeln!(out, "  {}.", why(look))?;
        writeln!(
            out,
            "  Expected at `{}`: {} time steps a cycle, {:.1} dynamic and {:.1} quasi-static cycles, about {:.2} s here.\n",
            self.accuracy,
            look.steps_per_cycle,
            look.dynamic_cycles,
            look.quasi_static_cycles,
            look.expected.as_secs_f64()
        )
    }
}

/// The contact arc of a joint against the spacing of its control points, with advice where they are too few.
fn write_arc(out: &mut String, contact: &ContactArc) -> std::fmt::Result {
    let ContactArc { joint, arc, spacing, .. } = contact;
    if *arc <= 0.0 {
        return writeln!(out, "  joint {joint}: no contact in the first cycle");
    }
    let per_arc = arc / spacing;
    write!(
        out,
        "  joint {joint}: contact arc {:.1} deg on unworn surfaces, control points every {:.1} deg, {per_arc:.1} per arc",
        arc.to_degrees(),
        spacing.to_degrees()
    )?;
    if per_arc < ContactArc::ENOUGH {
        write!(out, "; control_points = {} would give {:.1}", contact.enough_points(), ContactArc::ENOUGH)?;
    }
    writeln!(out)
}

/// The chosen tier and the reason.
fn why(look: &FirstLook) -> String {
    match &look.tier {
        _ if !look.wears => "No wear: one cycle represents the whole life".to_owned(),
        Ok(share) if look.asks_for_motion => format!(
            "Quasi-static wear rates are within {:.2} % of the dynamics: the gaps on the ideal motion drive the wear, and \
             dynamic cycles at a few lives give the outputs of the motion",
            share * 100.0
        ),
        Ok(share) => format!(
            "Only wear is requested, and quasi-static wear rates are within {:.2} % of the dynamics: the cycles between the \
             first and the last follow the gaps on the ideal motion",
            share * 100.0
        ),
        Err(reason) => format!("Every cycle is simulated dynamically: {reason}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::scene::SceneSource;

    fn text(scene: &Scene) -> String {
        let mut out = String::new();
        Model::new(scene, &NamedAccuracy::default()).write(&mut out, scene).expect("a text takes everything");
        out
    }

    #[test]
    fn islands_tier_and_reason_are_named() {
        let source = SceneSource::builtin("four-bar").expect("built in");
        let mut scene = source.nominal().clone();
        let all = text(&scene);
        assert!(
            all.contains("coupler + rocker; 6 unknowns, 0 constraints of 0 ideal joints, 3 contacts"),
            "{all}"
        );
        assert!(all.contains("output coupler_joint_speed needs the dynamics"), "{all}");
        scene.outputs.truncate(1);
        let wear = text(&scene);
        assert!(wear.contains("quasi-static wear rates are within"), "{wear}");
        let json = Model::new(&scene, &NamedAccuracy::default()).to_json();
        assert_eq!((&json["tier"], &json["islands"][0]["unknowns"]), (&json!("quasi-static"), &json!(6)));
        assert!(json["expected_s"].as_f64().expect("a number") > 0.0);
    }

    #[test]
    fn a_scene_that_does_not_wear_is_one_cycle() {
        let source = SceneSource::builtin("pendulum").expect("built in");
        let found = text(source.nominal());
        assert!(found.contains("3 unknowns, 2 constraints of 1 ideal joint, 0 contacts"), "{found}");
        assert!(found.contains("No wear"), "{found}");
    }
}
