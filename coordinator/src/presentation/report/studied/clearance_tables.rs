//! Tables of the hinges and guides with clearance of a mechanism, of their materials and of their wear.

use super::exact::ExactTexts;
use super::mechanism_tables::stated;
use crate::presentation::report::format::UNKNOWN;
use crate::presentation::report::{WrittenScene, captioned, table};
use common::scene::{
    Clearance, ContactDamping, ControlPoints, GuideClearance, Joint, JointKind, Material, Scene,
    WearingSurfaces,
};
use maud::{Markup, html};

/// What the built-in mechanics have of a joint, which is not known of a program.
fn own(scene: &Scene, text: String) -> String {
    if scene.simulator.is_none() { text } else { UNKNOWN.to_owned() }
}

/// Guides with clearance, with what is modelled of them; nothing without any.
pub(super) fn guides(scene: &Scene, written: &WrittenScene) -> Markup {
    let rows = scene.joints.iter().filter_map(|joint| {
        let JointKind::Guide(guide) = &joint.kind else { return None };
        let texts = ExactTexts::below(written, format!("joints.{}", joint.name));
        let length = |last: &str, value: f64| texts.value(last, value, "mm");
        let [start, end] = guide.reach;
        Some([
            ("guide", joint.name.clone()),
            ("direction", texts.value("axis", guide.axis, "deg")),
            ("turned by", texts.value("angle", guide.angle, "deg")),
            ("length", length("length", guide.length)),
            ("height", length("height", guide.height)),
            ("width", length("width", guide.width)),
            ("clearance", length("clearance", guide.clearance)),
            ("from end to end", format!("{} to {}", length("guide_start", start), length("guide_end", end))),
            ("friction", own(scene, texts.number("friction", guide.friction))),
            ("friction speed", own(scene, texts.value("friction_speed", guide.friction_speed, "mm/s"))),
            ("damping of the contact", own(scene, damping(&guide.contact_damping, &texts))),
        ])
    });
    let title = "Guides with clearance: length and height of the slider, width of the contact, clearance on each side; ends of the guide from its \
         place";
    stated("guides", title, rows)
}

/// Wear coefficients of the guides with clearance that wear and of their sliders, and their control points; nothing without any.
pub(super) fn guide_wear(scene: &Scene, written: &WrittenScene) -> Markup {
    let rows = scene.joints.iter().filter_map(|joint| {
        let JointKind::Guide(GuideClearance { wear: Some(wear), .. }) = &joint.kind else { return None };
        let texts = ExactTexts::below(written, format!("joints.{}", joint.name));
        let value = |last: &str, value: f64| texts.value(last, value, "1/Pa");
        let own = value("wear_coefficient", wear.coefficient);
        let of_slider = wear.slider_coefficient.map(|of_slider| value("slider_wear_coefficient", of_slider));
        let [guide, slider] = match wear.wears {
            WearingSurfaces::Bushing => [own, "does not wear".to_owned()],
            WearingSurfaces::Journal => ["does not wear".to_owned(), own],
            WearingSurfaces::Both => [own.clone(), of_slider.unwrap_or(own)],
        };
        Some([
            ("guide", joint.name.clone()),
            ("coefficient of the guide", guide),
            ("coefficient of the slider", slider),
            ("control points of a face", wear.control_points.to_string()),
        ])
    });
    let title =
        "Wear of these guides and of their sliders by Archard's law, with the control points of each face";
    stated("guide-wear", title, rows)
}

/// Hinges with clearance, with what is modelled of them.
pub(super) fn hinges(scene: &Scene, written: &WrittenScene) -> Markup {
    let rows = scene.joints.iter().filter_map(|joint| {
        let JointKind::Clearance(clearance) = &joint.kind else { return None };
        let texts = ExactTexts::below(written, format!("joints.{}", joint.name));
        let length = |last: &str, value: f64| texts.value(last, value, "mm");
        let coefficient = |last: &str, value: f64| texts.value(last, value, "1/Pa");
        // One of the two follows from the other and the radius of the journal.
        let (radial, radius) = if written.quantity(&texts.key("radial_clearance")).is_some() {
            let radial = nominal_clearance(scene, &texts, clearance);
            let radius = format!("({})", texts.rounded(clearance.bushing_radius, "mm"));
            (texts.value("radial_clearance", radial, "um").replace("um", "µm"), radius)
        } else {
            let radial = texts.rounded(clearance.radial_clearance(), "µm").replace("um", "µm");
            (format!("({radial})"), length("bushing_radius", clearance.bushing_radius))
        };
        let wall = clearance.wall.map_or(String::new(), |wall| format!("; wall {}", length("wall", wall)));
        let wear = coefficient("wear_coefficient", clearance.wear_coefficient);
        let wear = match (clearance.wears, clearance.journal_wear_coefficient) {
            (WearingSurfaces::Bushing, _) => wear,
            (WearingSurfaces::Journal, _) => format!("{wear} (journal)"),
            (WearingSurfaces::Both, None) => format!("{wear} (both surfaces)"),
            (WearingSurfaces::Both, Some(journal)) => {
                format!("{wear}; journal {}", coefficient("journal_wear_coefficient", journal))
            }
        };
        let control_points = match clearance.control_points {
            ControlPoints::Number(number) => number.to_string(),
            ControlPoints::ByArc => "by the contact arc".to_owned(),
        };
        let law = clearance.contact_law.word();
        let damping = own(scene, damping(&clearance.contact_damping, &texts));
        Some([
            ("hinge", joint.name.clone()),
            ("journal radius", length("journal_radius", clearance.journal_radius)),
            ("radial clearance", radial),
            ("bushing radius", radius),
            ("width", length("width", clearance.width)),
            ("wear coefficient", wear),
            ("friction", own(scene, texts.number("friction", clearance.friction))),
            ("friction speed", own(scene, texts.value("friction_speed", clearance.friction_speed, "mm/s"))),
            ("film damping", own(scene, texts.value("film_damping", clearance.film_damping, "N s/m"))),
            ("control points", control_points),
            ("law and damping of the contact", format!("{law}; {damping}{wall}")),
        ])
    });
    let title = "Hinges with clearance; values in parentheses follow from the others; friction is regularised at the friction speed; a hinge \
         with the wear coefficient 0 does not wear";
    stated("hinges", title, rows)
}

/// The radial clearance of a hinge that states one: the mean of a variable that sets it, else what is written.
fn nominal_clearance(scene: &Scene, texts: &ExactTexts<'_>, clearance: &Clearance) -> f64 {
    let key = texts.key("radial_clearance");
    let variable = scene.variables.iter().find(|variable| variable.changes.contains(&key));
    let mean = variable.map(|variable| variable.distribution.parent_mean());
    mean.or(texts.written.quantity(&key)).unwrap_or(clearance.radial_clearance())
}

fn damping(damping: &ContactDamping, texts: &ExactTexts<'_>) -> String {
    match damping {
        ContactDamping::None => "none".to_owned(),
        ContactDamping::HuntCrossley { factor } => {
            format!("hunt-crossley, {}", texts.value("contact_damping.hunt_crossley", *factor, "s/m"))
        }
        ContactDamping::Restitution { law, coefficient, least_speed } => {
            let e = texts.number("contact_damping.restitution", *coefficient);
            let least = texts.value("contact_damping.least_speed", *least_speed, "mm/s");
            format!("{}, e = {e}, approach at least {least}", law.word())
        }
    }
}

/// Parts of joints with a material: the word of its key, and that of the column of its joints.
const PARTS: [(&str, &str); 4] = [
    ("journal", "journals of"),
    ("bushing", "bushings of"),
    ("slider", "sliders of"),
    ("guide", "guides of"),
];

/// A material: its name where that is known, its values, and the joints of each of [`PARTS`] that are made of it.
type MaterialUse = (String, Material, [Vec<String>; PARTS.len()]);

/// The materials of a joint, each with the number of its part in [`PARTS`].
fn of_joint(joint: &Joint) -> Vec<(usize, Material)> {
    match &joint.kind {
        JointKind::Clearance(hinge) => vec![(0, hinge.journal_material), (1, hinge.bushing_material)],
        JointKind::Guide(guide) => vec![(2, guide.slider_material), (3, guide.guide_material)],
        _ => vec![],
    }
}

/// Materials of all joints that have one; nothing without any.
pub(super) fn materials(scene: &Scene, written: &WrittenScene) -> Markup {
    let mut used: Vec<MaterialUse> = Vec::new();
    for joint in &scene.joints {
        for (part, material) in of_joint(joint) {
            let key = format!("joints.{}.{}_material", joint.name, PARTS[part].0);
            let name = written.name(&key).unwrap_or_default().to_owned();
            let place = used.iter().position(|(known, values, _)| *known == name && *values == material);
            let place = place.unwrap_or_else(|| {
                used.push((name, material, Default::default()));
                used.len() - 1
            });
            used[place].2[part].push(joint.name.clone());
        }
    }
    if used.is_empty() {
        return html! {};
    }
    let shown: Vec<usize> =
        (0..PARTS.len()).filter(|part| used.iter().any(|(.., joints)| !joints[*part].is_empty())).collect();
    let rows = used.iter().map(|(name, material, joints)| {
        let texts = ExactTexts::below(written, format!("materials.{name}"));
        let or_dash = |text: String| if text.is_empty() { UNKNOWN.to_owned() } else { text };
        let mut row = vec![
            or_dash(name.clone()),
            texts.value("elastic_modulus", material.elastic_modulus, "GPa"),
            texts.number("poisson_ratio", material.poisson_ratio),
        ];
        row.extend(shown.iter().map(|part| or_dash(joints[*part].join(", "))));
        row
    });
    let mut head = vec!["material", "elastic modulus", "Poisson's ratio"];
    head.extend(shown.iter().map(|part| PARTS[*part].1));
    captioned("materials", "Materials of the joints", table(&head, rows))
}
