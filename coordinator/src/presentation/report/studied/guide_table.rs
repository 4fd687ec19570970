//! Tables of the guides with clearance of a mechanism, and of their wear.

use super::exact::ExactTexts;
use super::mechanism_tables::damping;
use crate::presentation::report::page::captioned;
use crate::presentation::report::tables::{cells, table_of_text};
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
    let rows = rows.into_iter().map(cells);
    captioned(
        "guides",
        "Guides with clearance: length and height of the slider, width of the contact, clearance on each side; ends of the guide from its \
         place",
        table_of_text(&head, rows),
    )
}

/// Wear coefficients of the guides with clearance that wear and of their sliders, and their control points; nothing without any.
pub(super) fn guide_wear(scene: &Scene, written: &WrittenScene) -> Markup {
    let texts = ExactTexts(written);
    let rows = scene.joints.iter().filter_map(|joint| {
        let JointKind::Guide(GuideClearance { wear: Some(wear), .. }) = &joint.kind else { return None };
        let value =
            |last: &str, value: f64| texts.value(&format!("joints.{}.{last}", joint.name), value, "1/Pa");
        let own = value("wear_coefficient", wear.coefficient);
        let of_slider = wear.slider_coefficient.map(|of_slider| value("slider_wear_coefficient", of_slider));
        let [guide, slider] = match wear.wears {
            WearingSurfaces::Bushing => [own, "does not wear".to_owned()],
            WearingSurfaces::Journal => ["does not wear".to_owned(), own],
            WearingSurfaces::Both => [own.clone(), of_slider.unwrap_or(own)],
        };
        Some([joint.name.clone(), guide, slider, wear.control_points.to_string()])
    });
    let rows: Vec<_> = rows.collect();
    if rows.is_empty() {
        return html! {};
    }
    let head = ["guide", "coefficient of the guide", "coefficient of the slider", "control points of a face"];
    captioned(
        "guide-wear",
        "Wear of these guides and of their sliders by Archard's law, with the control points of each face",
        table_of_text(&head, rows.into_iter().map(cells)),
    )
}
