//! Reads what makes a joint with clearance: materials, radii, contact law and damping, friction, wear.

use super::faults::{FaultKind, in_first_unit};
use super::joint::{Clearance, ContactDamping, ContactLaw, Material, RestitutionLaw};
use super::quantity::*;
use super::read::{Context, Range};
use super::section::Section;

/// Fewer points cannot carry a spline of a bore, more are finer than any contact arc needs.
const CONTROL_POINTS: std::ops::RangeInclusive<i64> = 8..=360;
/// Control points of the wear profile unless the joint says otherwise.
const CONTROL_POINTS_DEFAULT: i64 = 36;
/// Poisson's ratio of an isotropic material that does not shrink sideways under pressure.
const POISSON: Range = Range::Within(0.0, 0.5);
/// A slower approach is no impact but a journal that rolls on its bore, unless the scene says otherwise [m/s].
const LEAST_SPEED: f64 = 1e-3;

/// Name of a material and, unless faulty, the material itself.
pub(super) type MaterialRow = (String, Option<Material>);

/// Reads `[materials.NAME]`.
pub(super) fn materials(cx: &mut Context, file: &mut Section) -> Vec<MaterialRow> {
    let mut materials = Vec::new();
    for (name, mut section) in file.named(cx, "materials") {
        let elastic_modulus = section.quantity(cx, "elastic_modulus", PRESSURE, Range::Positive);
        let poisson_ratio = section.quantity(cx, "poisson_ratio", NUMBER, POISSON);
        section.finish(cx);
        let material = elastic_modulus.zip(poisson_ratio);
        let material =
            material.map(|(elastic_modulus, poisson_ratio)| Material { elastic_modulus, poisson_ratio });
        materials.push((name.to_owned(), material));
    }
    materials
}

/// Reads the fields of a joint with clearance; one that does not wear needs no wear coefficient.
pub(super) fn clearance(
    cx: &mut Context,
    row: &mut Section,
    materials: &[MaterialRow],
    wears: bool,
) -> Option<Clearance> {
    let journal_radius = row.quantity(cx, "journal_radius", LENGTH, Range::Positive);
    let bushing_radius = bushing_radius(cx, row, journal_radius);
    let width = row.quantity(cx, "width", LENGTH, Range::Positive);
    let journal_material = material(cx, row, "journal_material", materials);
    let bushing_material = material(cx, row, "bushing_material", materials);
    let laws = [("local-hertz", ContactLaw::LocalHertz), ("foundation", ContactLaw::Foundation)];
    let law = row.text(cx, "contact_law", "one of local-hertz, foundation");
    let contact_law = law.and_then(|law| cx.word(&row.key("contact_law"), law, &laws));
    let contact_damping = contact_damping(cx, row);
    let film_damping = row.quantity_or(cx, "film_damping", DAMPING, Range::NonNegative, 0.0);
    let friction = row.quantity(cx, "friction", NUMBER, Range::Within(0.0, 2.0));
    let friction_speed = row.quantity(cx, "friction_speed", SPEED, Range::Positive);
    let wear_coefficient = match row.get("wear_coefficient") {
        None if !wears => Some(0.0),
        _ => row
            .quantity(cx, "wear_coefficient", INVERSE_PRESSURE, Range::NonNegative)
            .map(|coefficient| if wears { coefficient } else { 0.0 }),
    };
    let control_points = row.integer(cx, "control_points", CONTROL_POINTS, Some(CONTROL_POINTS_DEFAULT));
    let wall = match row.get("wall") {
        Some(_) => row.quantity(cx, "wall", LENGTH, Range::Positive).map(Some),
        None => Some(None),
    };
    Some(Clearance {
        journal_radius: journal_radius?,
        bushing_radius: bushing_radius?,
        width: width?,
        journal_material: journal_material?,
        bushing_material: bushing_material?,
        contact_law: contact_law?,
        contact_damping: contact_damping?,
        film_damping: film_damping?,
        friction: friction?,
        friction_speed: friction_speed?,
        wear_coefficient: wear_coefficient?,
        control_points: control_points? as usize,
        wall: wall?,
    })
}

/// The bushing is given by its radius or by the clearance it leaves to its journal.
fn bushing_radius(cx: &mut Context, row: &mut Section, journal_radius: Option<f64>) -> Option<f64> {
    if let Some(written) = row.get("radial_clearance") {
        if row.get("bushing_radius").is_some() {
            cx.inconsistent(&row.path, "give either bushing_radius or radial_clearance, not both");
            return None;
        }
        let clearance = cx.quantity(&row.key("radial_clearance"), written, LENGTH, Range::Positive)?;
        let journal_radius = journal_radius?;
        if clearance < journal_radius {
            return Some(journal_radius + clearance);
        }
        let key = row.key("radial_clearance");
        let value = cx.shown(&key, written, clearance, LENGTH);
        let allowed = format!("smaller than journal_radius = {}", in_first_unit(journal_radius, LENGTH));
        cx.fault(key, FaultKind::OutOfRange { value, allowed });
        return None;
    }
    let radius = row.quantity(cx, "bushing_radius", LENGTH, Range::Positive)?;
    let journal_radius = journal_radius?;
    if radius > journal_radius && radius < 2.0 * journal_radius {
        return Some(radius);
    }
    let key = row.key("bushing_radius");
    let written = row.get("bushing_radius");
    let value = written.map(|written| cx.shown(&key, written, radius, LENGTH)).unwrap_or_default();
    let allowed = format!(
        "larger than the journal and below twice that, journal_radius = {}",
        in_first_unit(journal_radius, LENGTH)
    );
    cx.fault(key, FaultKind::OutOfRange { value, allowed });
    None
}

fn material(
    cx: &mut Context,
    row: &mut Section,
    key: &'static str,
    materials: &[MaterialRow],
) -> Option<Material> {
    let name = row.text(cx, key, "the name of a material")?;
    let i = cx.reference(&row.key(key), "material", name, materials.iter().map(|(name, _)| name.as_str()))?;
    materials[i].1
}

fn contact_damping(cx: &mut Context, row: &mut Section) -> Option<ContactDamping> {
    const EXPECTED: &str = "\"none\", { hunt_crossley = \"7.5 s/m\" } or { law, restitution, least_speed }";
    match row.get("contact_damping") {
        None => Some(ContactDamping::None),
        Some(toml::Value::String(word)) => {
            cx.word(&row.key("contact_damping"), word, &[("none", ContactDamping::None)])
        }
        Some(toml::Value::Table(_)) => {
            let mut damping = row.section_if_any(cx, "contact_damping")?;
            let found = match (damping.get("hunt_crossley"), damping.get("law")) {
                (Some(_), None) => {
                    let factor = damping.quantity(cx, "hunt_crossley", INVERSE_SPEED, Range::NonNegative);
                    factor.map(|factor| ContactDamping::HuntCrossley { factor })
                }
                (None, Some(_)) => by_restitution(cx, &mut damping),
                (Some(_), Some(_)) => {
                    cx.inconsistent(&damping.path, "give either hunt_crossley or law, not both");
                    return None;
                }
                (None, None) => {
                    let expected = format!("{}, or law with restitution", INVERSE_SPEED.in_words());
                    cx.fault(damping.key("hunt_crossley"), FaultKind::Missing { expected });
                    None
                }
            };
            damping.finish(cx);
            found
        }
        Some(other) => {
            cx.wrong_type(&row.key("contact_damping"), other, EXPECTED.to_owned());
            None
        }
    }
}

/// Reads `{ law, restitution, least_speed }`.
fn by_restitution(cx: &mut Context, damping: &mut Section) -> Option<ContactDamping> {
    let laws = [
        ("lankarani-nikravesh", RestitutionLaw::LankaraniNikravesh),
        ("hunt-crossley", RestitutionLaw::HuntCrossley),
        ("flores", RestitutionLaw::Flores),
    ];
    let law = damping.word(cx, "law", &laws);
    let coefficient = damping.quantity(cx, "restitution", NUMBER, Range::Above(0.0, 1.0));
    let least_speed = damping.quantity_or(cx, "least_speed", SPEED, Range::Positive, LEAST_SPEED);
    Some(ContactDamping::Restitution { law: law?, coefficient: coefficient?, least_speed: least_speed? })
}
