//! Table of the guides of the nominal mechanism that wear: largest depths at the end of life.

use super::parts::captioned;
use crate::presentation::report::format::fixed;
use crate::presentation::report::input::ReportInput;
use crate::presentation::report::tables::table;
use common::outputs::JointSummary;
use common::scene::JointKind;
use maud::{Markup, html};

/// Largest depths of both faces of each guide that wears and of its slider; nothing without any.
pub(super) fn worn_guides(input: &ReportInput) -> Markup {
    let joints = input.nominal.iter().flat_map(|nominal| &nominal.joints).zip(&input.scene.joints);
    let rows: Vec<Vec<Markup>> = joints
        .filter(|(summary, joint)| {
            matches!(joint.kind, JointKind::Guide(_)) && !summary.wear_depth.is_empty()
        })
        .map(|(summary, _)| row(summary))
        .collect();
    if rows.is_empty() {
        return html! {};
    }
    let head = [
        "guide",
        "left face [µm]",
        "right face [µm]",
        "slider, left [µm]",
        "slider, right [µm]",
        "peak force [N]",
    ];
    captioned(
        "worn-guides",
        "Guides that wear: largest depth of each face of the guide and of its slider, seen along the axis of the guide, nominal mechanism at the \
         end of life; peak force of the first cycle",
        table(&head, rows.into_iter()),
    )
}

fn row(summary: &JointSummary) -> Vec<Markup> {
    let faces = |depths: &[f64]| -> [String; 2] {
        let (left, right) = depths.split_at(depths.len() / 2);
        [left, right].map(|face| fixed(1e6 * face.iter().copied().fold(0.0, f64::max), 2))
    };
    let ([left, right], slider) = (faces(&summary.wear_depth), faces(&summary.journal_wear_depth));
    let [of_slider, further] = slider;
    [summary.name.clone(), left, right, of_slider, further, fixed(summary.peak_force, 2)]
        .map(|text| html! { (text) })
        .to_vec()
}
