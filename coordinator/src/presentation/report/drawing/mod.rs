//! The drawing of a mechanism, made before any simulation: bodies, joints, drives and loads in one position of the cycle, as
//! SVG for the report and for `draw`, as DXF, and as letters for the terminal.
//!
//! | file | content |
//! |---|---|
//! | `geometry` | what is shown, as data in SI |
//! | `words` | drives and loads in words |
//! | `labels` | places of labels that do not overlap |
//! | `symbols` | links, supports, sliders, arrows and springs as SVG |
//! | `sheet` | the whole drawing as SVG |
//! | `sketch` | the drawing in letters |
//! | `dxf` | the drawing for CAD |

mod dxf;
mod geometry;
pub mod labels;
mod sheet;
mod sketch;
pub mod symbols;
#[cfg(test)]
mod tests;

pub use dxf::dxf;
pub use geometry::{DrawnBody, DrawnDrive, DrawnJoint, DrawnLoad, DrawnMechanism, LoadSymbol};
pub use sheet::{MechanismSheet, sheet};
pub use sketch::sketch;

use super::format::joined;
use super::{Figure, csv};
use crate::results::csv_table::number;
use common::scene::Scene;

/// Name of the figure and of its files.
pub const NAME: &str = "drawing";

/// Share of the cycle at which mechanisms are drawn: at its start many are stretched out, with bodies on top of each other.
pub const SHARE_OF_CYCLE: f64 = 0.125;

/// Number of the instant at a share of a cycle of `n` instants.
pub fn instant(n: usize, share: f64) -> usize {
    (share * n.saturating_sub(1) as f64).round() as usize
}

/// The drawing with caption and coordinates.
pub fn figure(drawn: &DrawnMechanism, scene: &Scene) -> Figure {
    let rows = drawn
        .bodies
        .iter()
        .flat_map(|body| body.outline_m.iter().map(|point| ("body", body.name.clone(), *point)));
    let joints = drawn.joints.iter().map(|joint| (joint.kind, joint.name.clone(), joint.at_m));
    let rows = rows
        .chain(joints)
        .map(|(kind, name, [x, y])| vec![kind.to_owned(), name, number(1e3 * x), number(1e3 * y)]);
    Figure {
        name: NAME.into(),
        title: "The mechanism".into(),
        caption: caption(drawn, scene),
        drawing: sheet(drawn).drawing,
        csv: csv(&["kind", "name", "x [mm]", "y [mm]"], rows),
    }
}

/// The meaning of the symbols that appear.
fn caption(drawn: &DrawnMechanism, scene: &Scene) -> String {
    let shown = geometry::SYMBOLS.into_iter().filter(|(kind, ..)| drawn.has(kind));
    let on_ground = drawn.has_supports() || drawn.joints.iter().any(|joint| joint.on_ground);
    let others = [
        (on_ground, "hatched: frame"),
        (!drawn.loads.is_empty(), "red: loads, with their size"),
        (!drawn.drives.is_empty(), "curved arrow at a pivot: drive, with its angle in this position"),
    ];
    let others = others.into_iter().filter(|(is_drawn, _)| *is_drawn).map(|(_, what)| what.to_owned());
    let parts = shown.map(|(_, symbol, _, meaning)| format!("{symbol}: {meaning}")).chain(others);
    let clearances = scene.joints.iter().any(|joint| joint.kind.has_clearance());
    let proportions =
        if clearances { "True proportions, clearances too small to be seen" } else { "True proportions" };
    format!("{proportions}. In italics: bodies; {}.", joined(parts, "; "))
}
