//! Reads the outputs of a scene.

use super::body_row::BodyRow;
use super::joints::JointRow;
use super::key_reading::{Named, values};
use super::key_table::ElementKind;
use super::output::{Output, OutputKind};
use super::output_unit::OutputUnit;
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
    let words: Vec<_> = OutputKind::KINDS.iter().flat_map(typed_words).collect();
    let rows = file.rows("outputs").into_iter();
    let read = rows.map(|(name, mut row)| {
        let output = typed_output(name, &mut row, &words, Named { bodies, joints });
        row.finish();
        output
    });
    read.collect()
}

/// A kind of outputs, and what depends on its word.
type OfWord = (&'static ElementKind<OutputUnit>, &'static OutputUnit);

/// The words of a kind of outputs.
pub(super) fn typed_words(
    kind: &'static ElementKind<OutputUnit>,
) -> impl Iterator<Item = (&'static str, OfWord)> {
    kind.words.iter().map(move |(word, unit)| (*word, (kind, unit)))
}

/// Reads an output with a `type` of these words.
pub(super) fn typed_output(
    name: &str,
    row: &mut Section,
    words: &[(&str, OfWord)],
    named: Named,
) -> OutputRow {
    let (kind, unit) = row.word("type", words).unzip();
    let read = kind.and_then(|kind| {
        let values = values(row, kind.keys, named);
        OutputKind::from_values(kind.name, values.into_iter().collect::<Option<_>>()?)
    });
    OutputRow {
        name: name.to_owned(),
        kind: unit.map(|unit| unit.kind()),
        output: read.map(|kind| Output { name: name.to_owned(), kind }),
        declared: false,
    }
}
