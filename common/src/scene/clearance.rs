//! Reads joints with clearance: materials, hinges and guides, contact law and damping, friction, wear.

use super::context::Range;
use super::faults::in_first_unit;
use super::joint::{
    Clearance, ContactDamping, ContactLaw, ControlPoints, GuideClearance, GuideWear, Material,
    RestitutionLaw, WearingSurfaces,
};
use super::quantity::*;
use super::section::{Section, record};

/// Range of the number of control points: fewer do not represent a bore.
const CONTROL_POINTS: std::ops::RangeInclusive<i64> = 8..=ControlPoints::MOST as i64;
/// Poisson's ratio of isotropic materials, auxetic ones excluded [1].
const POISSON: Range = Range::Within(0.0, 0.5);
/// Coulomb's coefficient of friction [1].
pub(super) const FRICTION: Range = Range::Within(0.0, 2.0);
/// Default of the lowest approach speed of an impact; slower journals roll on their bores [m/s].
const LEAST_SPEED: f64 = 1e-3;

/// Name of a material with the material; none if it is faulty.
pub(super) struct MaterialRow {
    pub(super) name: String,
    /// Elastic constants; none if they are faulty.
    elastic: Option<Material>,
    /// Density [kg/m^3], if it is given.
    pub(super) density: Option<f64>,
}

/// Reads the tables `[materials.NAME]`.
pub(super) fn materials(file: &mut Section) -> Vec<MaterialRow> {
    let mut materials = Vec::new();
    for (name, mut section) in file.named("materials") {
        let material = record!(Material {
            elastic_modulus: section.quantity("elastic_modulus", PRESSURE, Range::Positive),
            poisson_ratio: section.quantity("poisson_ratio", NUMBER, POISSON),
        });
        let density = section.quantity_if_any("density", DENSITY, Range::Positive).flatten();
        section.finish();
        materials.push(MaterialRow { name: name.to_owned(), elastic: material, density });
    }
    materials
}

/// Reads the fields of a joint with clearance; one that does not wear needs no wear coefficient, and one that another program moves no
/// friction.
pub(super) fn clearance(
    row: &mut Section,
    materials: &[MaterialRow],
    is_worn: bool,
    rubs: bool,
) -> Option<Clearance> {
    record!(Clearance {
        journal_radius: row.quantity("journal_radius", LENGTH, Range::Positive),
        bushing_radius: bushing_radius(row, journal_radius),
        width: row.quantity("width", LENGTH, Range::Positive),
        journal_material: material(row, "journal_material", materials),
        bushing_material: material(row, "bushing_material", materials),
        contact_law: contact_law(row),
        contact_damping: contact_damping(row),
        film_damping: row.quantity_or("film_damping", DAMPING, Range::NonNegative, 0.0),
        friction: row.quantity_unless("friction", NUMBER, FRICTION, (!rubs).then_some(0.0)),
        friction_speed: row.quantity_unless("friction_speed", SPEED, Range::Positive, (!rubs).then_some(1.0)),
        wear_coefficient: row
            .quantity_unless(
                "wear_coefficient",
                INVERSE_PRESSURE,
                Range::NonNegative,
                (!is_worn).then_some(0.0)
            )
            .map(|coefficient| if is_worn { coefficient } else { 0.0 }),
        wears: surfaces(row),
        journal_wear_coefficient: second_coefficient(row, "journal_wear_coefficient", wears)
            .map(|coefficient| coefficient.filter(|_| is_worn)),
        control_points: bore_points(row),
        wall: row.quantity_if_any("wall", LENGTH, Range::Positive),
    })
}

/// Reads the law of the normal contact force.
fn contact_law(row: &mut Section) -> Option<ContactLaw> {
    let names = ContactLaw::ALL.map(ContactLaw::word).join(", ");
    row.choice("contact_law", &format!("one of {names}"), &ContactLaw::WORDS)
}

/// Reads the surfaces that wear.
fn surfaces(row: &mut Section) -> Option<WearingSurfaces> {
    let given = row.if_any("wears", |row, key| {
        row.choice(key, "bushing, journal or both", &WearingSurfaces::OF_HINGE)
    })?;
    Some(given.unwrap_or_default())
}

/// Reads the control points of a bore and its journal.
fn bore_points(row: &mut Section) -> Option<ControlPoints> {
    match row.get("control_points") {
        Some(word) if word.as_str() == Some("auto") => Some(ControlPoints::ByArc),
        Some(word) if word.as_str().is_some() => {
            let (from, to) = (CONTROL_POINTS.start(), CONTROL_POINTS.end());
            let expected = format!("a whole number {from} to {to}, or \"auto\"");
            row.wrong_type("control_points", word, expected).and(None)
        }
        _ => control_points(row).map(ControlPoints::Number),
    }
}

/// Reads the number of control points of a wear profile.
pub(super) fn control_points(row: &mut Section) -> Option<usize> {
    let default = ControlPoints::DEFAULT as i64;
    row.integer("control_points", CONTROL_POINTS, Some(default)).map(|points| points as usize)
}

/// Reads the wear coefficient of the journal or the slider, which is that of the joint unless both surfaces wear; the outer `None` if it
/// is faulty.
pub(super) fn second_coefficient(
    row: &mut Section,
    key: &'static str,
    surfaces: Option<WearingSurfaces>,
) -> Option<Option<f64>> {
    let found = row.quantity_if_any(key, INVERSE_PRESSURE, Range::NonNegative);
    if row.get(key).is_some() && surfaces.is_some_and(|surfaces| surfaces != WearingSurfaces::Both) {
        let message = "needs wears = \"both\"; a single surface that wears has wear_coefficient";
        return row.inconsistent(key, message).and(None);
    }
    found
}

/// The bushing is given by its radius or by the clearance it leaves to its journal.
fn bushing_radius(row: &mut Section, journal_radius: Option<f64>) -> Option<f64> {
    let by_clearance = row.get("radial_clearance").is_some();
    if by_clearance && row.get("bushing_radius").is_some() {
        return row.inconsistent_table("give either bushing_radius or radial_clearance, not both").and(None);
    }
    let key = if by_clearance { "radial_clearance" } else { "bushing_radius" };
    let (given, journal) = (row.quantity(key, LENGTH, Range::Positive)?, journal_radius?);
    let allowed = match by_clearance {
        true if given < journal => return Some(journal + given),
        true => "smaller than",
        false if given > journal && given < 2.0 * journal => return Some(given),
        false => "larger than the journal and below twice that,",
    };
    let allowed = format!("{allowed} journal_radius = {}", in_first_unit(journal, LENGTH));
    row.refuse(key, given, LENGTH, allowed).and(None)
}

/// Reads the name of a material under `key`.
pub(super) fn material(row: &mut Section, key: &'static str, materials: &[MaterialRow]) -> Option<Material> {
    let name = row.text(key, "the name of a material")?;
    let i = row.reference(key, "material", name, materials.iter().map(|material| material.name.as_str()))?;
    materials[i].elastic
}

/// Reads the dissipation of a contact.
pub(super) fn contact_damping(row: &mut Section) -> Option<ContactDamping> {
    const EXPECTED: &str = "\"none\", { hunt_crossley = \"7.5 s/m\" } or { law, restitution, least_speed }";
    match row.get("contact_damping") {
        None => Some(ContactDamping::None),
        Some(toml::Value::String(word)) if !word.starts_with(|letter: char| letter.is_ascii_digit()) => {
            row.choice("contact_damping", EXPECTED, &[("none", ContactDamping::None)])
        }
        Some(toml::Value::Table(_)) => {
            let mut damping = row.section_if_any("contact_damping")?;
            let expected = || format!("{}, or law with restitution", INVERSE_SPEED.in_words());
            let found = match damping.either(["hunt_crossley", "law"], expected) {
                Some("law") => by_restitution(&mut damping),
                Some(key) => record!(ContactDamping::HuntCrossley {
                    factor: damping.quantity(key, INVERSE_SPEED, Range::NonNegative)
                }),
                None if damping.get("law").is_some() => return None,
                None => None,
            };
            damping.finish();
            found
        }
        Some(other) => row.wrong_type("contact_damping", other, EXPECTED.to_owned()).and(None),
    }
}

/// Reads `{ law, restitution, least_speed }`.
fn by_restitution(damping: &mut Section) -> Option<ContactDamping> {
    record!(ContactDamping::Restitution {
        law: damping.word("law", &RestitutionLaw::WORDS),
        coefficient: damping.quantity("restitution", NUMBER, Range::Above(0.0, 1.0)),
        least_speed: damping.quantity_or("least_speed", SPEED, Range::Positive, LEAST_SPEED),
    })
}

/// Keys of the wear of a hinge that a guide does not have, and why.
const KEYS_OF_HINGES: [(&str, &str); 3] = [
    ("wear", "a guide wears where it has wears = \"guide\", \"slider\" or \"both\": leave this key out"),
    ("journal_wear_coefficient", "the second surface of a guide is its slider: see slider_wear_coefficient"),
    ("wall", "a guide is not worn through, as nothing behind its faces is modelled: leave this key out"),
];

/// Reads the fields of a guide with clearance, whose friction may be missing unless it `rubs` here.
pub(super) fn guide(row: &mut Section, materials: &[MaterialRow], rubs: bool) -> Option<GuideClearance> {
    let read = record!(GuideClearance {
        axis: row.quantity_or("axis", ANGLE, Range::Any, 0.0),
        angle: row.quantity_or("angle", ANGLE, Range::Any, 0.0),
        length: row.quantity("length", LENGTH, Range::Positive),
        height: row.quantity("height", LENGTH, Range::Positive),
        width: row.quantity("width", LENGTH, Range::Positive),
        clearance: guide_clearance(row, height),
        reach: reach(row, length),
        slider_material: material(row, "slider_material", materials),
        guide_material: material(row, "guide_material", materials),
        contact_damping: contact_damping(row),
        friction: row.quantity_unless("friction", NUMBER, FRICTION, (!rubs).then_some(0.0)),
        friction_speed: row.quantity_unless("friction_speed", SPEED, Range::Positive, (!rubs).then_some(1.0)),
        wear: wear(row),
    });
    for (key, reason) in KEYS_OF_HINGES {
        // Known only where it is given, so that no message offers it.
        if row.peek(key).is_some() && row.get(key).is_some() {
            row.inconsistent(key, reason);
        }
    }
    read
}

/// Reads the wear of guide and slider; outer none if it is faulty, inner none without the key wears.
fn wear(row: &mut Section) -> Option<Option<GuideWear>> {
    let keys = ["wear_coefficient", "slider_wear_coefficient", "control_points"];
    let given: Vec<&str> = keys.into_iter().filter(|key| row.get(key).is_some()).collect();
    if row.get("wears").is_none() {
        let needs = "needs wears = \"guide\", \"slider\" or \"both\": without it a guide does not wear";
        for key in &given {
            row.inconsistent(key, needs);
        }
        return given.is_empty().then_some(None);
    }
    let wear = record!(GuideWear {
        wears: row.choice("wears", "guide, slider or both", &WearingSurfaces::OF_GUIDE),
        coefficient: row.quantity("wear_coefficient", INVERSE_PRESSURE, Range::NonNegative),
        slider_coefficient: second_coefficient(row, "slider_wear_coefficient", wears),
        control_points: control_points(row),
    });
    wear.map(Some)
}

/// The clearance on each side, which is below the slider's height.
fn guide_clearance(row: &mut Section, height: Option<f64>) -> Option<f64> {
    let clearance = row.quantity("clearance", LENGTH, Range::Positive)?;
    let height = height?;
    if clearance < height {
        return Some(clearance);
    }
    let allowed = format!("smaller than height = {}", in_first_unit(height, LENGTH));
    row.refuse("clearance", clearance, LENGTH, allowed).and(None)
}

/// The ends of the guide, between which there is room for the slider.
fn reach(row: &mut Section, length: Option<f64>) -> Option<[f64; 2]> {
    let start = row.quantity("guide_start", LENGTH, Range::Any);
    let end = row.quantity("guide_end", LENGTH, Range::Any);
    let (start, end, length) = (start?, end?, length?);
    if end - start > length {
        return Some([start, end]);
    }
    let least = in_first_unit(length, LENGTH);
    row.inconsistent("guide_end", format!("leaves no room for the slider, whose length is {least}")).and(None)
}
