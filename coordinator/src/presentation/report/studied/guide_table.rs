//! Table of the guides with clearance of a mechanism.

use super::exact::ExactTexts;
use super::mechanism_tables::damping;
use crate::presentation::report::page::captioned;
use crate::presentation::report::tables::table_of_text;
use crate::presentation::report::written::WrittenScene;
use common::scene::{JointKind, Scene};
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
    ];
    let rows = rows.into_iter().map(super::mechanism_tables::cells);
    captioned(
        "guides",
        "Guides with clearance: length and height of the slider, width of the contact, clearance on each side; ends of the guide from its \
         place; they do not wear",
        table_of_text(&head, rows),
    )
}
