//! Tables of the guides with clearance of a mechanism, and of their wear.

use super::exact::ExactTexts;
use super::mechanism_tables::{damping, stated};
use crate::presentation::report::written::WrittenScene;
use common::scene::{GuideClearance, JointKind, Scene, WearingSurfaces};
use maud::Markup;

/// Guides with clearance, with what is modelled of them; nothing without any.
pub(super) fn guides(scene: &Scene, written: &WrittenScene) -> Markup {
    let texts = ExactTexts(written);
    let rows = scene.joints.iter().filter_map(|joint| {
        let JointKind::Guide(guide) = &joint.kind else { return None };
        let key = |last: &str| format!("joints.{}.{last}", joint.name);
        let length = |last: &str, value: f64| texts.value(&key(last), value, "mm");
        Some([
            ("guide", joint.name.clone()),
            ("direction", texts.value(&key("axis"), guide.axis, "deg")),
            ("turned by", texts.value(&key("angle"), guide.angle, "deg")),
            ("length", length("length", guide.length)),
            ("height", length("height", guide.height)),
            ("width", length("width", guide.width)),
            ("clearance", length("clearance", guide.clearance)),
            (
                "from end to end",
                format!(
                    "{} to {}",
                    length("guide_start", guide.reach[0]),
                    length("guide_end", guide.reach[1])
                ),
            ),
            ("friction", texts.number(&key("friction"), guide.friction)),
            ("friction speed", texts.value(&key("friction_speed"), guide.friction_speed, "mm/s")),
            ("damping of the contact", damping(&guide.contact_damping, &texts, &key("contact_damping"))),
        ])
    });
    stated(
        "guides",
        "Guides with clearance: length and height of the slider, width of the contact, clearance on each side; ends of the guide from its \
         place",
        rows,
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
        Some([
            ("guide", joint.name.clone()),
            ("coefficient of the guide", guide),
            ("coefficient of the slider", slider),
            ("control points of a face", wear.control_points.to_string()),
        ])
    });
    stated(
        "guide-wear",
        "Wear of these guides and of their sliders by Archard's law, with the control points of each face",
        rows,
    )
}
