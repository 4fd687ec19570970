//! Reads the loads, the outputs and the limit states of a scene.

use super::body_row::BodyRow;
use super::context::Range;
use super::faults::FaultKind;
use super::joints::JointRow;
use super::key_reading::values;
use super::key_table::{ElementKind, Form, Key, Value};
use super::load::Load;
use super::output::{Fails, LimitState, Output, OutputKind};
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
    /// An output that an external simulator returns in this unit; `single` if it has a single value.
    pub(super) fn declared(name: &str, unit: Option<&str>, single: Option<bool>) -> Self {
        let read = unit.zip(single);
        let kind = read.map(|(unit, single)| OutputKind::External { unit: unit.to_owned(), single });
        OutputRow {
            name: name.to_owned(),
            kind: Some(Kind::from_dimension(NUMBER.dimension)),
            output: kind.map(|kind| Output { name: name.to_owned(), kind }),
            declared: true,
        }
    }
}

/// Reads `[[outputs]]`; a faulty output keeps its row.
pub(super) fn outputs(file: &mut Section, bodies: &[BodyRow], joints: &[JointRow]) -> Vec<OutputRow> {
    let words: Vec<_> = OutputKind::KINDS.iter().flat_map(typed_words).collect();
    file.each_row("outputs", |name, row| typed_output(name, row, &words, bodies, joints))
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
    bodies: &[BodyRow],
    joints: &[JointRow],
) -> OutputRow {
    let (kind, unit) = row.word("type", words).unzip();
    let read = kind.and_then(|kind| {
        let values = values(row, kind.keys, bodies, joints);
        OutputKind::from_values(kind.name, values.into_iter().collect::<Option<_>>()?)
    });
    OutputRow {
        name: name.to_owned(),
        kind: unit.map(|unit| unit.kind()),
        output: read.map(|kind| Output { name: name.to_owned(), kind }),
        declared: false,
    }
}

/// Reads `[[loads]]`; faulty ones are left out.
pub(super) fn loads(file: &mut Section, bodies: &[BodyRow]) -> Vec<Load> {
    let words: Vec<_> = Load::KINDS.iter().map(|kind| (kind.words[0].0, kind)).collect();
    let loads = file.each_row("loads", |_, row| {
        let kind = row.word("type", &words)?;
        let read = values(row, kind.keys, bodies, &[]);
        check(row, kind.keys, &read)?;
        Load::from_values(kind.name, read.into_iter().collect::<Option<_>>()?)
    });
    loads.into_iter().flatten().collect()
}

/// Checks the values of a load against each other.
fn check(row: &Section, keys: &[Key], values: &[Option<Value>]) -> Option<()> {
    let value = |name: &str| keys.iter().zip(values).find(|(key, _)| key.name == name)?.1.as_ref();
    let number = |name: &str| value(name).map_or(0.0, |value| f64::from(value.clone()));
    let contradiction = match (value("a"), value("b")) {
        (Some(Value::Place(a)), Some(Value::Place(b))) if a.body == b.body => "a and b are on the same body",
        (Some(Value::Body(a)), Some(Value::Body(b))) if a == b => "a and b are the same body",
        _ if value("upper").is_some() && value("lower").is_some() && number("lower") >= number("upper") => {
            "lower is not below upper"
        }
        _ if number("stall_torque") * number("no_load_speed") < 0.0 => {
            "stall_torque and no_load_speed have opposite signs: the torque would grow with the speed"
        }
        _ => return check_drag(row, keys),
    };
    row.inconsistent_table(contradiction).and(None)
}

/// Checks that a drag has at least one of its coefficients.
fn check_drag(row: &Section, keys: &[Key]) -> Option<()> {
    let in_words = |name: &str| match keys.iter().find(|key| key.name == name)?.form {
        Form::NumberOr(kind, ..) => Some(kind.in_words()),
        _ => None,
    };
    let (Some(linear), Some(quadratic)) = (in_words("linear"), in_words("quadratic")) else {
        return Some(());
    };
    if row.peek("linear").is_none() && row.peek("quadratic").is_none() {
        return row.missing("quadratic", format!("{quadratic}, or linear, {linear}")).and(None);
    }
    Some(())
}

/// Columns that result files have besides one for each limit state.
const COLUMNS: [&str; 4] = ["cycles", "total", "standard_error", "numerical"];

/// Reads `[[limit_states]]`; a threshold is of the kind of its output.
pub(super) fn limit_states(file: &mut Section, outputs: &[OutputRow]) -> Vec<Option<LimitState>> {
    file.each_row("limit_states", |name, row| {
        if COLUMNS.contains(&name) {
            row.fault("name", FaultKind::BadName(name.to_owned(), "it is a column of result files"));
        }
        let known = outputs.iter().map(|output| output.name.as_str());
        let declared = outputs.iter().any(|output| output.declared);
        let output = row.text("output", "the name of an output");
        let output = output.and_then(|output| row.reference("output", "output", output, known));
        let kind = output.and_then(|output| outputs[output].kind);
        // The outputs of a mechanism are sizes.
        let range = if declared { Range::Any } else { Range::Positive };
        let sides = sides(row, kind, range);
        let state =
            |(output, (threshold, fails))| LimitState { name: name.to_owned(), output, threshold, fails };
        output.zip(sides).map(state)
    })
}

/// Reads threshold and side of a limit state: `threshold` with `fails`, or `lower` and `upper`, outside of which it fails. A threshold
/// of an unknown kind is left unread.
fn sides(row: &mut Section, kind: Option<Kind>, range: Range) -> Option<(f64, Fails)> {
    let outside = Fails::Outside { lower: 0.0 };
    let words = [("above", Fails::Above), ("below", Fails::Below), ("outside", outside)];
    let [one, lower, upper] = ["threshold", "lower", "upper"].map(|key| row.get(key).map(|_| key));
    let two = lower.or(upper);
    let default = if two.is_some() { outside } else { Fails::Above };
    let fails = row.word_or("fails", &words, default)?;
    let one_sided = fails != outside;
    if let Some(surplus) = if one_sided { two } else { one } {
        let expected = "expected threshold, or lower and upper with fails = \"outside\", not some of both";
        return row.inconsistent(surplus, expected).and(None);
    }
    let mut threshold = |key| row.quantity(key, kind?, range);
    if one_sided {
        return Some((threshold("threshold")?, fails));
    }
    let (lower, upper) = (threshold("lower"), threshold("upper"));
    let (lower, upper) = (lower?, upper?);
    if lower >= upper {
        return row.inconsistent("lower", "expected lower < upper").and(None);
    }
    Some((upper, Fails::Outside { lower }))
}
