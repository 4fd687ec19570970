//! Reads the outputs of a scene.

use super::body_row::BodyRow;
use super::joints::JointRow;
use super::key_reading::{Named, values};
use super::output::{Output, OutputKind};
use super::quantity::{Kind, NUMBER};
use super::section::Section;

/// An output while its scene is read; a faulty one keeps its name, so that references to it are found.
pub(super) struct OutputRow {
    pub(super) name: String,
    /// Kind of its values; none if its type is unknown.
    pub(super) kind: Option<Kind>,
    /// The output, unless faulty.
    pub(super) output: Option<Output>,
    /// True if an external simulator returns it: its values are then plain numbers of any sign.
    pub(super) declared: bool,
}

impl OutputRow {
    /// An output that an external simulator returns.
    pub(super) fn declared(name: &str, output: Option<Output>) -> Self {
        OutputRow {
            name: name.to_owned(),
            kind: Some(Kind::from_dimension(NUMBER.dimension)),
            output,
            declared: true,
        }
    }
}

/// Reads `[[outputs]]`; a faulty output keeps its row.
pub(super) fn outputs(file: &mut Section, bodies: &[BodyRow], joints: &[JointRow]) -> Vec<OutputRow> {
    let of_kind =
        OutputKind::KINDS.iter().map(|kind| kind.words.iter().map(move |(word, unit)| (*word, (kind, unit))));
    let words: Vec<_> = of_kind.flatten().collect();
    let mut outputs = Vec::new();
    for (name, mut row) in file.rows("outputs") {
        let (kind, unit) = row.word("type", &words).unzip();
        let read = kind.and_then(|kind| {
            let values = values(&mut row, kind.keys, Named { bodies, joints });
            OutputKind::from_values(kind.name, values.into_iter().collect::<Option<_>>()?)
        });
        row.finish();
        outputs.push(OutputRow {
            name: name.to_owned(),
            kind: unit.map(|unit| unit.kind()),
            output: read.map(|kind| Output { name: name.to_owned(), kind }),
            declared: false,
        });
    }
    outputs
}
