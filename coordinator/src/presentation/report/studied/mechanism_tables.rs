//! Tables of a mechanism: bodies, joints, hinges with clearance, materials and loads.

use crate::presentation::report::format::seven_digits;
use crate::presentation::report::page::captioned;
use crate::presentation::report::tables::{table, table_of_text};
use common::scene::{
    Clearance, ContactDamping, Drive, JointKind, Material, Motion, OutputUnit, RestitutionLaw, Scene,
};
use maud::{Markup, Render, html};
use std::collections::BTreeMap;

/// A value with its unit.
fn with_unit(value: f64, unit: &str) -> String {
    format!("{}\u{a0}{unit}", seven_digits(value))
}

/// A pair of lengths in mm.
fn pair([x, y]: [f64; 2]) -> String {
    format!("({}, {})", seven_digits(1e3 * x), seven_digits(1e3 * y))
}

fn cells<const N: usize>(texts: [String; N]) -> Vec<Markup> {
    texts.map(|text| text.render()).to_vec()
}

/// All tables of a mechanism.
pub fn tables(scene: &Scene) -> Markup {
    html! {
        (bodies(scene))
        (joints(scene))
        (hinges(scene))
        (materials(scene))
        (loads(scene))
    }
}

fn bodies(scene: &Scene) -> Markup {
    let dash = || "–".to_owned();
    let rows = scene.bodies.iter().map(|body| {
        let (motion, mass, inertia, centre) = match &body.motion {
            Motion::Fixed => ("fixed".to_owned(), dash(), dash(), dash()),
            Motion::Driven { position, drive, inertia } => (
                format!("driven about {}, {}", pair(*position), how(drive)),
                inertia.as_ref().map_or_else(dash, |of| with_unit(1e3 * of.mass, "g")),
                inertia.as_ref().map_or_else(dash, |of| with_unit(of.inertia, "kg m²")),
                inertia.as_ref().map_or_else(dash, |of| pair(of.centre_of_mass)),
            ),
            Motion::Free { mass, inertia, centre_of_mass, .. } => (
                "free".to_owned(),
                with_unit(1e3 * mass, "g"),
                with_unit(*inertia, "kg m²"),
                pair(*centre_of_mass),
            ),
        };
        let points: Vec<String> =
            body.points.iter().map(|point| format!("{} {}", point.name, pair(point.position))).collect();
        cells([body.name.clone(), motion, mass, inertia, centre, points.join("; ")])
    });
    let head = ["body", "motion", "mass", "inertia", "centre of mass [mm]", "points [mm]"];
    captioned(
        "bodies",
        "Bodies; inertia about the centre of mass; points in the frame of the body",
        table_of_text(&head, rows),
    )
}

fn how(drive: &Drive) -> String {
    let unit = OutputUnit::AngularVelocity;
    match drive {
        Drive::ConstantSpeed { start_angle, speed } => format!(
            "{}, from {} deg",
            unit.after(&seven_digits(unit.to_shown(*speed))),
            seven_digits(start_angle.to_degrees())
        ),
        Drive::Angle(_) => "angle by a table over time".to_owned(),
        Drive::Speed { start_angle, .. } => {
            format!("speed by a table over time, from {} deg", seven_digits(start_angle.to_degrees()))
        }
    }
}

fn joints(scene: &Scene) -> Markup {
    let rows = scene.joints.iter().map(|joint| {
        let kind = match &joint.kind {
            JointKind::Revolute => "revolute, ideal".to_owned(),
            JointKind::Prismatic { axis, angle } => format!(
                "prismatic along {} deg, turned by {} deg",
                seven_digits(axis.to_degrees()),
                seven_digits(angle.to_degrees())
            ),
            JointKind::Fixed { angle } => {
                format!("rigid, turned by {} deg", seven_digits(angle.to_degrees()))
            }
            JointKind::Clearance(_) => "hinge with clearance".to_owned(),
        };
        let end =
            |at: &common::scene::Attachment| format!("{} {}", scene.bodies[at.body].name, pair(at.position));
        cells([joint.name.clone(), kind, end(&joint.journal), end(&joint.bushing)])
    });
    let head = ["joint", "kind", "journal, or first body [mm]", "bushing, or second body [mm]"];
    captioned("joints", "Joints, with their places in the frames of the bodies", table_of_text(&head, rows))
}

/// Joints with clearance, with what is modelled of them.
fn clearances(scene: &Scene) -> Vec<(&str, &Clearance)> {
    let joints = scene.joints.iter().filter_map(|joint| match &joint.kind {
        JointKind::Clearance(clearance) => Some((joint.name.as_str(), clearance)),
        _ => None,
    });
    joints.collect()
}

fn hinges(scene: &Scene) -> Markup {
    let clearances = clearances(scene);
    if clearances.is_empty() {
        return html! {};
    }
    let head = [
        "hinge",
        "journal radius",
        "radial clearance",
        "width",
        "wear coefficient",
        "friction",
        "film damping",
        "law and damping of the contact",
    ];
    let rows = clearances.into_iter().map(|(name, clearance)| {
        let friction = format!(
            "{}, regularised at {} mm/s",
            seven_digits(clearance.friction),
            seven_digits(1e3 * clearance.friction_speed)
        );
        let wall =
            clearance.wall.map_or(String::new(), |wall| format!("; wall {} mm", seven_digits(1e3 * wall)));
        cells([
            name.to_owned(),
            with_unit(1e3 * clearance.journal_radius, "mm"),
            with_unit(1e6 * clearance.radial_clearance(), "µm"),
            with_unit(1e3 * clearance.width, "mm"),
            with_unit(clearance.wear_coefficient, "1/Pa"),
            friction,
            with_unit(clearance.film_damping, "N s/m"),
            format!("{}; {}{wall}", clearance.contact_law.name(), damping(&clearance.contact_damping)),
        ])
    });
    captioned("hinges", "Hinges with clearance", table_of_text(&head, rows))
}

fn damping(damping: &ContactDamping) -> String {
    match damping {
        ContactDamping::None => "none".to_owned(),
        ContactDamping::HuntCrossley { factor } => format!("Hunt-Crossley, {} s/m", seven_digits(*factor)),
        ContactDamping::Restitution { law, coefficient, least_speed } => {
            let law = match law {
                RestitutionLaw::LankaraniNikravesh => "Lankarani-Nikravesh",
                RestitutionLaw::HuntCrossley => "Hunt-Crossley",
                RestitutionLaw::Flores => "Flores",
            };
            let (e, least) = (seven_digits(*coefficient), seven_digits(1e3 * least_speed));
            format!("{law}, e = {e}, approach at least {least} mm/s")
        }
    }
}

/// Names in a row, or a dash for none.
fn listed(names: &[String]) -> String {
    if names.is_empty() { "–".to_owned() } else { names.join(", ") }
}

/// A material with the names of the hinges whose journals and whose bushings are made of it.
type MaterialUse = (Material, Vec<String>, Vec<String>);

/// Materials that differ, with the journals and bushings made of them.
fn materials(scene: &Scene) -> Markup {
    let mut used: BTreeMap<[u64; 2], MaterialUse> = BTreeMap::new();
    for (name, clearance) in clearances(scene) {
        for (material, is_journal) in
            [(clearance.journal_material, true), (clearance.bushing_material, false)]
        {
            let key = [material.elastic_modulus.to_bits(), material.poisson_ratio.to_bits()];
            let entry = used.entry(key).or_insert_with(|| (material, vec![], vec![]));
            if is_journal { &mut entry.1 } else { &mut entry.2 }.push(name.to_owned());
        }
    }
    if used.is_empty() {
        return html! {};
    }
    let rows = used.into_values().map(|(material, journals, bushings)| {
        cells([
            with_unit(1e-9 * material.elastic_modulus, "GPa"),
            seven_digits(material.poisson_ratio),
            listed(&journals),
            listed(&bushings),
        ])
    });
    let head = ["elastic modulus", "Poisson's ratio", "journals of", "bushings of"];
    captioned("materials", "Materials of the hinges", table(&head, rows))
}

fn loads(scene: &Scene) -> Markup {
    let bodies: Vec<&str> = scene.bodies.iter().map(|body| body.name.as_str()).collect();
    let mut rows: Vec<Vec<Markup>> = scene
        .loads
        .iter()
        .map(|load| {
            let line = load.explanation(&bodies);
            let (name, what) = line.split_once(": ").unwrap_or(("", &line));
            cells([name.to_owned(), what.to_owned()])
        })
        .collect();
    if scene.gravity != [0.0; 2] {
        let [x, y] = scene.gravity.map(seven_digits);
        rows.push(cells(["gravity".to_owned(), format!("({x}, {y}) m/s² on every body")]));
    }
    if rows.is_empty() {
        return html! { p { "There are no loads but those of the joints." } };
    }
    captioned("loads", "Loads", table_of_text(&["load", "law"], rows.into_iter()))
}
