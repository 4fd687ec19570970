//! Table of the guides with clearance of a mechanism.

use super::exact::ExactTexts;
use super::mechanism_tables::damping;
use crate::presentation::report::page::captioned;
use crate::presentation::report::tables::table_of_text;
use crate::presentation::report::written::WrittenScene;
use common::scene::{GuideClearance, JointKind, Scene, WearingSurfaces};
use maud::{Markup, html};

/// Guides with clearance, with what is modelled of them; nothing without any.
pub(super) fn guides(scene: &Scene, written: &WrittenScene) -> Markup {
    let texts = ExactTexts(written);
    let rows = scene.joints.iter().filter_map(|joint| {
        let JointKind::Guide(guide) = &joint.kind else { return None };
        let key = |last: &str| format!("joints.{}.{last}", joint.name);
        let length = |last: &str, value: f64| texts.value(&key(last), value, "mm");
        Some([
            joint.name.clone(),
            texts.value(&key("axis"), guide.axis, "deg"),
            texts.value(&key("angle"), guide.angle, "deg"),
            length("length", guide.length),
            length("height", guide.height),
            length("width", guide.width),
            length("clearance", guide.clearance),
            format!("{} to {}", length("guide_start", guide.reach[0]), length("guide_end", guide.reach[1])),
            texts.number(&key("friction"), guide.friction),
            texts.value(&key("friction_speed"), guide.friction_speed, "mm/s"),
            damping(&guide.contact_damping, &texts, &key("contact_damping")),
            wear(guide, &texts, &key),
        ])
    });
    let rows: Vec<_> = rows.collect();
    if rows.is_empty() {
        return html! {};
    }
    let head = [
        "guide",
        "direction",
        "turned by",
        "length",
        "height",
        "width",
        "clearance",
        "from end to end",
        "friction",
        "friction speed",
        "damping of the contact",
        "wear coefficient",
    ];
    let rows = rows.into_iter().map(super::mechanism_tables::cells);
    captioned(
        "guides",
        "Guides with clearance: length and height of the slider, width of the contact, clearance on each side; ends of the guide from its \
         place; Archard's coefficient of the surfaces that wear, with the number of control points",
        table_of_text(&head, rows),
    )
}

/// Wear coefficients of guide and slider, and the number of control points.
fn wear(guide: &GuideClearance, texts: &ExactTexts, key: &dyn Fn(&str) -> String) -> String {
    let Some(wear) = &guide.wear else { return "does not wear".to_owned() };
    let own = texts.value(&key("wear_coefficient"), wear.coefficient, "1/Pa");
    let slider = |value: f64| texts.value(&key("slider_wear_coefficient"), value, "1/Pa");
    let surfaces = match (wear.wears, wear.slider_coefficient) {
        (WearingSurfaces::Bushing, _) => format!("guide {own}"),
        (WearingSurfaces::Journal, _) => format!("slider {own}"),
        (WearingSurfaces::Both, None) => format!("guide and slider {own}"),
        (WearingSurfaces::Both, Some(value)) => format!("guide {own}; slider {}", slider(value)),
    };
    format!("{surfaces}; {} points", wear.control_points)
}
