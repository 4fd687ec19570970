//! Table of the materials of a mechanism, with the parts of joints that are made of them.

use super::exact::ExactTexts;
use crate::presentation::report::format::UNKNOWN;
use crate::presentation::report::page::captioned;
use crate::presentation::report::tables::table;
use crate::presentation::report::written::WrittenScene;
use common::scene::{Joint, JointKind, Material, Scene};
use maud::{Markup, html};

/// Parts of joints with a material: the word of its key, and that of the column of its joints.
const PARTS: [(&str, &str); 4] = [
    ("journal", "journals of"),
    ("bushing", "bushings of"),
    ("slider", "sliders of"),
    ("guide", "guides of"),
];

/// A material: its name where that is known, its values, and the joints of each of [`PARTS`] that are made of it.
struct MaterialUse {
    name: String,
    material: Material,
    joints: [Vec<String>; PARTS.len()],
}

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
            let place = used.iter().position(|one| one.name == name && one.material == material);
            let place = place.unwrap_or_else(|| {
                used.push(MaterialUse { name, material, joints: Default::default() });
                used.len() - 1
            });
            used[place].joints[part].push(joint.name.clone());
        }
    }
    if used.is_empty() {
        return html! {};
    }
    let texts = ExactTexts(written);
    let shown: Vec<usize> =
        (0..PARTS.len()).filter(|part| used.iter().any(|one| !one.joints[*part].is_empty())).collect();
    let rows = used.iter().map(|one| {
        let key = |last: &str| format!("materials.{}.{last}", one.name);
        let or_dash = |text: String| if text.is_empty() { UNKNOWN.to_owned() } else { text };
        let mut row = vec![
            or_dash(one.name.clone()),
            texts.value(&key("elastic_modulus"), one.material.elastic_modulus, "GPa"),
            texts.number(&key("poisson_ratio"), one.material.poisson_ratio),
        ];
        row.extend(shown.iter().map(|part| or_dash(one.joints[*part].join(", "))));
        row
    });
    let mut head = vec!["material", "elastic modulus", "Poisson's ratio"];
    head.extend(shown.iter().map(|part| PARTS[*part].1));
    captioned("materials", "Materials of the joints", table(&head, rows))
}
