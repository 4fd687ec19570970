//! Tables of the parameters of a scene and of the quantities that depend on them, which random variables may change.

use crate::presentation::report::page::captioned;
use crate::presentation::report::tables::table_of_text;
use crate::presentation::report::written::WrittenScene;
use maud::{Markup, Render, html};

/// Parameters, and formulas of the keys that depend on them; nothing for a scene without parameters.
pub fn tables(written: &WrittenScene) -> Markup {
    let rows = |all: &[(String, String)]| {
        let cells = |(name, text): &(String, String)| vec![name.render(), html! { code { (text) } }];
        all.iter().map(cells).collect::<Vec<_>>().into_iter()
    };
    html! {
        @if !written.parameters.is_empty() {
            (captioned("parameters", "Parameters of the scene", table_of_text(&["parameter", "value"], rows(&written.parameters))))
        }
        @if !written.formulas.is_empty() {
            (captioned(
                "formulas",
                "Quantities that follow from parameters, with the values above where all variables are at their means",
                table_of_text(&["quantity", "formula"], rows(&written.formulas)),
            ))
        }
    }
}
