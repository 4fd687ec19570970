//! Table of the guides of the nominal mechanism that wear: largest depths at the end of life.

use crate::presentation::report::format::fixed;
use crate::presentation::report::input::ReportInput;
use crate::presentation::report::page::captioned;
use crate::presentation::report::tables::table_of;
use common::outputs::JointSummary;
use common::scene::JointKind;
use maud::{Markup, html};

/// Largest depths of both faces of each guide that wears and of its slider; nothing without any.
pub(super) fn worn_guides(input: &ReportInput) -> Markup {
    let joints = input.nominal.iter().flat_map(|nominal| &nominal.joints).zip(&input.scene.joints);
    let worn: Vec<&JointSummary> = joints
        .filter(|(summary, joint)| {
            matches!(joint.kind, JointKind::Guide(_)) && !summary.wear_depth.is_empty()
        })
        .map(|(summary, _)| summary)
        .collect();
    if worn.is_empty() {
        return html! {};
    }
    let deepest = |depths: &[f64], face: usize| {
        let (left, right) = depths.split_at(depths.len() / 2);
        fixed(1e6 * [left, right][face].iter().copied().fold(0.0, f64::max), 2)
    };
    let table = table_of::<&JointSummary>(
        &[
            ("guide", &|guide| guide.name.clone()),
            ("left face [µm]", &|guide| deepest(&guide.wear_depth, 0)),
            ("right face [µm]", &|guide| deepest(&guide.wear_depth, 1)),
            ("slider, left [µm]", &|guide| deepest(&guide.journal_wear_depth, 0)),
            ("slider, right [µm]", &|guide| deepest(&guide.journal_wear_depth, 1)),
            ("peak force [N]", &|guide| fixed(guide.peak_force, 2)),
        ],
        worn,
    );
    captioned(
        "worn-guides",
        "Guides that wear: largest depth of each face of the guide and of its slider, seen along the axis of the guide, nominal mechanism at the \
         end of life; peak force of the first cycle",
        table,
    )
}
