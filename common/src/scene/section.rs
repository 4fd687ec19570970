//! One table of a file while it is read: its values by key, and at the end a fault for every key that was not
//! read. What is wrong is recorded in the context of the pass; a method then returns `None` and reading continues. What records a
//! fault returns `None` too, so that a reader gives `.and(None)` of it in the place of its value.

use super::context::{Context, Range};
use super::faults::{Fault, FaultKind, Faults, nearest};
use super::quantity::Kind;
use std::fmt::Display;
use std::ops::RangeInclusive;
use toml::{Table, Value};

/// Keys of which a table has one.
const EITHER: [&str; 2] = ["radial_clearance", "bushing_radius"];

/// A table with its path, and the context of the pass that reads it.
pub struct Section<'s> {
    /// State of the pass.
    pub(super) cx: &'s Context<'s>,
    /// Path of the table, e.g. `joints.1`; empty for the whole file.
    pub(super) path: String,
    table: &'s Table,
    /// Table with the values of keys that this one does not have.
    pub(super) defaults: Option<&'s Table>,
    /// Keys that this table may have, as far as they were read.
    pub(super) known: Vec<&'static str>,
    /// True if a fault has left open which keys the table may have: they are not checked.
    pub(super) given_up: bool,
}

/// Keys and faults.
impl<'s> Section<'s> {
    pub(super) fn new(cx: &'s Context<'s>, path: impl Into<String>, table: &'s Table) -> Self {
        Section { cx, path: path.into(), table, defaults: None, known: Vec::new(), given_up: false }
    }

    /// Path of a key of this table.
    pub(super) fn key(&self, key: &str) -> String {
        if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) }
    }

    /// Records a fault at a key.
    pub fn fault(&self, key: &str, kind: FaultKind) -> Option<()> {
        self.cx.fault(self.key(key), kind)
    }

    /// Number of faults of the file so far.
    pub fn fault_count(&self) -> usize {
        self.cx.fault_count()
    }

    /// Records faults of another file, which have their places.
    pub fn faults_elsewhere(&self, faults: Faults) {
        self.cx.faults.borrow_mut().extend(faults.0);
    }

    /// Records that the value of a key contradicts something.
    pub fn inconsistent(&self, key: &str, message: impl Into<String>) -> Option<()> {
        self.cx.inconsistent(self.key(key), message)
    }

    /// Records that keys of this table contradict each other.
    pub(super) fn inconsistent_table(&self, message: impl Into<String>) -> Option<()> {
        self.cx.inconsistent(&self.path, message)
    }

    /// Records that a value is not in its range.
    pub fn out_of_range(&self, key: &str, value: impl Display, allowed: impl Display) -> Option<()> {
        self.fault(key, FaultKind::out_of_range(value, allowed))
    }

    /// Records that a key is missing, unless it or a part of it has a fault already.
    pub fn missing(&self, key: &str, expected: impl Into<String>) -> Option<()> {
        let path = self.key(key);
        let is_of_it = |fault: &Fault| {
            fault.key.strip_prefix(&path).is_some_and(|rest| rest.is_empty() || rest.starts_with(['[', '.']))
        };
        let has_one = self.cx.faults.borrow().iter().any(is_of_it);
        if has_one { None } else { self.cx.fault(path, FaultKind::Missing(expected.into())) }
    }

    /// Records that a value has another type of TOML value.
    pub fn wrong_type(&self, key: &str, value: &Value, expected: impl Into<String>) -> Option<()> {
        self.cx.wrong_type(&self.key(key), value, expected.into())
    }

    /// Records that a quantity is not in the range that another one sets.
    pub(super) fn refuse(&self, key: &str, value: f64, kind: Kind, allowed: String) -> Option<()> {
        let written = self.peek(key).expect("the value was read");
        self.out_of_range(key, self.cx.shown(&self.key(key), written, value, kind), allowed)
    }

    /// Index of `name` among `known`, or a fault at `key` with the nearest of them.
    pub fn reference<'n>(
        &self,
        key: &str,
        what: &'static str,
        name: &str,
        known: impl Iterator<Item = &'n str> + Clone,
    ) -> Option<usize> {
        let found = known.clone().position(|candidate| candidate == name);
        found.or_else(|| self.fault(key, FaultKind::unknown_reference(what, name, known)).and(None))
    }

    /// [`Section::reference`]; after a fault the index of the nearest name, with which what depends on it is read on.
    pub fn meant<'n>(
        &self,
        key: &str,
        what: &'static str,
        name: &str,
        known: impl Iterator<Item = &'n str> + Clone,
    ) -> Option<usize> {
        self.reference(key, what, name, known.clone()).or_else(|| {
            let meant = nearest(name, known.clone())?;
            known.clone().position(|other| other == meant)
        })
    }

    /// The value of a key, if it is present; the key becomes a known one.
    pub fn get(&mut self, key: &'static str) -> Option<&'s Value> {
        if !self.known.contains(&key) {
            self.known.push(key);
        }
        self.peek(key)
    }

    /// The value of a key that need not become a known one.
    pub(super) fn peek(&self, key: &str) -> Option<&'s Value> {
        self.table.get(key).or_else(|| self.defaults?.get(key).filter(|_| !self.excludes(key)))
    }

    /// True if the table has the other key of two of which a row has one, so that there is no default for this one.
    fn excludes(&self, key: &str) -> bool {
        EITHER.contains(&key) && EITHER.iter().any(|other| *other != key && self.table.contains_key(*other))
    }

    pub(super) fn require(
        &mut self,
        key: &'static str,
        expected: impl FnOnce() -> String,
    ) -> Option<&'s Value> {
        self.get(key).or_else(|| self.missing(key, expected()).and(None))
    }

    /// Every key of this table with its value, where the keys are names.
    pub(super) fn entries(&self) -> impl Iterator<Item = (&'s String, &'s Value)> + use<'s> {
        self.table.iter()
    }

    /// Records a fault for every key of the table that is not a known one. That a key is missing for which it is likely meant is no further fault.
    pub fn finish(&self) {
        let unknown = |table: &'s Table| table.keys().filter(|key| !self.known.contains(&key.as_str()));
        for key in self.defaults.into_iter().flat_map(unknown) {
            self.withdraw_missing(key);
        }
        for key in unknown(self.table) {
            if self.withdraw_missing(key) || !self.given_up {
                self.fault(key, FaultKind::unknown_key(key, self.known.iter().copied()));
            }
        }
    }

    /// Withdraws the fault that the key is missing, or the one that may take its place, for which this unknown one is likely meant; false without one.
    fn withdraw_missing(&self, unknown: &str) -> bool {
        let Some(meant) = nearest(unknown, self.known.iter().copied()) else { return false };
        let either = if EITHER.contains(&&*meant) { EITHER } else { [&*meant; 2] };
        let keys = either.map(|key| self.key(key));
        let mut faults = self.cx.faults.borrow_mut();
        let before = faults.len();
        faults.retain(|fault| !(matches!(fault.kind, FaultKind::Missing(_)) && keys.contains(&fault.key)));
        faults.len() < before
    }
}

/// Quantities, numbers and switches.
impl<'s> Section<'s> {
    /// A required quantity.
    pub fn quantity(&mut self, key: &'static str, kind: Kind, range: Range) -> Option<f64> {
        let value = self.require(key, || kind.in_words())?;
        self.cx.quantity(&self.key(key), value, kind, range)
    }

    /// A quantity with a default.
    pub fn quantity_or(&mut self, key: &'static str, kind: Kind, range: Range, default: f64) -> Option<f64> {
        Some(self.quantity_if_any(key, kind, range)?.unwrap_or(default))
    }

    /// A quantity with a default, required without one.
    pub(super) fn quantity_unless(
        &mut self,
        key: &'static str,
        kind: Kind,
        range: Range,
        default: Option<f64>,
    ) -> Option<f64> {
        match default {
            Some(default) => self.quantity_or(key, kind, range, default),
            None => self.quantity(key, kind, range),
        }
    }

    /// The one of two keys that the table has; a fault with what is `expected` if it has neither.
    pub(super) fn either(
        &mut self,
        keys: [&'static str; 2],
        expected: impl FnOnce() -> String,
    ) -> Option<&'static str> {
        let [first, second] = keys;
        match keys.map(|key| self.get(key).is_some()) {
            [true, true] => {
                self.inconsistent_table(format!("give either {first} or {second}, not both")).and(None)
            }
            [false, false] => self.missing(first, expected()).and(None),
            [is_first, _] => Some(if is_first { first } else { second }),
        }
    }

    /// What `read` makes of an optional key; the outer `None` if it is faulty.
    pub(super) fn if_any<T>(
        &mut self,
        key: &'static str,
        read: impl FnOnce(&mut Self, &'static str) -> Option<T>,
    ) -> Option<Option<T>> {
        if self.get(key).is_some() { read(self, key).map(Some) } else { Some(None) }
    }

    /// An optional quantity; the outer `None` if it is faulty.
    pub fn quantity_if_any(&mut self, key: &'static str, kind: Kind, range: Range) -> Option<Option<f64>> {
        self.if_any(key, |section, key| section.quantity(key, kind, range))
    }

    /// The value of any key, or of a part of it, as a quantity.
    pub fn as_quantity(&self, key: &str, value: &Value, kind: Kind, range: Range) -> Option<f64> {
        self.cx.quantity(&self.key(key), value, kind, range)
    }

    /// A required quantity, or a share of `whole` such as `"2 %"`.
    pub fn quantity_or_share(&mut self, key: &'static str, kind: Kind, whole: f64) -> Option<f64> {
        let value = self.require(key, || kind.in_words())?;
        self.cx.quantity_or_share(&self.key(key), value, kind, whole)
    }

    /// A required pair `[x, y]` of quantities; the paths of its components end in `.x` and `.y`.
    pub(super) fn pair(&mut self, key: &'static str, kind: Kind) -> Option<[f64; 2]> {
        let value = self.require(key, || format!("a pair [x, y], each {}", kind.name))?;
        self.as_pair(key, value, kind)
    }

    /// A pair with a default.
    pub(super) fn pair_or(&mut self, key: &'static str, kind: Kind, default: [f64; 2]) -> Option<[f64; 2]> {
        Some(self.if_any(key, |section, key| section.pair(key, kind))?.unwrap_or(default))
    }

    /// The value of any key as a pair `[x, y]`.
    pub(super) fn as_pair(&self, key: &str, value: &Value, kind: Kind) -> Option<[f64; 2]> {
        let list = value.as_array().map(Vec::as_slice);
        if let Some(entries) = list.filter(|entries| entries.len() != 2) {
            let (count, are) = (entries.len(), if entries.len() == 1 { "entry" } else { "entries" });
            let message = format!("has {count} {are}, expected a pair [x, y]: everything is planar");
            return self.inconsistent(key, message).and(None);
        }
        let Some([x, y]) = list else {
            return self.wrong_type(key, value, format!("a pair [x, y], each {}", kind.name)).and(None);
        };
        let path = self.key(key);
        let x = self.cx.quantity(&format!("{path}.x"), x, kind, Range::Any);
        let y = self.cx.quantity(&format!("{path}.y"), y, kind, Range::Any);
        Some([x?, y?])
    }

    /// `true` or `false`, with a default.
    pub(super) fn boolean_or(&mut self, key: &'static str, default: bool) -> Option<bool> {
        let Some(value) = self.get(key) else { return Some(default) };
        value.as_bool().or_else(|| self.wrong_type(key, value, "true or false").and(None))
    }

    /// A whole number within a range, required without a default.
    pub fn integer(
        &mut self,
        key: &'static str,
        range: RangeInclusive<i64>,
        default: Option<i64>,
    ) -> Option<i64> {
        let allowed = match (range.start(), range.end()) {
            (least, &i64::MAX) => format!(">= {least}"),
            (least, most) => format!("{least} to {most}"),
        };
        let value = match (self.get(key), default) {
            (Some(value), _) => value,
            (None, Some(default)) => return Some(default),
            (None, None) => return self.require(key, || format!("a whole number {allowed}")).and(None),
        };
        match value.as_integer() {
            Some(n) if range.contains(&n) => Some(n),
            Some(n) => self.out_of_range(key, n, allowed).and(None),
            None => {
                let float = value.as_float().filter(|x| x.fract() == 0.0);
                let instead = float.map(|x| format!(": {x} is written without point and exponent"));
                let expected = format!("a whole number {allowed}{}", instead.unwrap_or_default());
                self.wrong_type(key, value, expected).and(None)
            }
        }
    }
}

/// Texts and words.
impl<'s> Section<'s> {
    /// A required text.
    pub fn text(&mut self, key: &'static str, expected: &str) -> Option<&'s str> {
        let value = self.require(key, || expected.to_owned())?;
        self.as_text(key, value, expected)
    }

    /// A text with a default.
    pub fn text_or<'a>(&mut self, key: &'static str, expected: &str, default: &'a str) -> Option<&'a str>
    where
        's: 'a,
    {
        match self.get(key) {
            Some(value) => self.as_text(key, value, expected),
            None => Some(default),
        }
    }

    /// A required list of texts.
    pub fn texts(&mut self, key: &'static str, expected: &str) -> Option<Vec<&'s str>> {
        let value = self.require(key, || expected.to_owned())?;
        let texts = value.as_array().and_then(|all| all.iter().map(Value::as_str).collect());
        texts.or_else(|| self.wrong_type(key, value, expected).and(None))
    }

    /// A required text, or a list of texts.
    pub fn text_or_texts(&mut self, key: &'static str, expected: &str) -> Option<Vec<&'s str>> {
        match self.get(key).and_then(Value::as_str) {
            Some(text) => Some(vec![text]),
            None => self.texts(key, expected),
        }
    }

    fn as_text(&self, key: &str, value: &'s Value, expected: &str) -> Option<&'s str> {
        value.as_str().or_else(|| self.wrong_type(key, value, expected).and(None))
    }

    /// The meaning of a required word.
    pub(super) fn choice<T: Copy>(
        &mut self,
        key: &'static str,
        expected: &str,
        words: &[(&str, T)],
    ) -> Option<T> {
        let word = self.text(key, expected)?;
        self.cx.word(&self.key(key), word, words)
    }

    /// The meaning of the required word that decides which keys this table has; if it is unknown, no key is checked.
    pub fn word<T: Copy>(&mut self, key: &'static str, words: &[(&str, T)]) -> Option<T> {
        let names = || words.iter().map(|(name, _)| *name).collect::<Vec<_>>();
        let value = self.require(key, || format!("one of {}", names().join(", ")));
        let text = value.and_then(|value| self.as_text(key, value, "a word"));
        let word = text.and_then(|word| self.cx.word(&self.key(key), word, words));
        self.given_up |= word.is_none();
        word
    }

    /// [`Section::word`] with a default.
    pub fn word_or<T: Copy>(&mut self, key: &'static str, words: &[(&str, T)], default: T) -> Option<T> {
        if self.get(key).is_some() { self.word(key, words) } else { Some(default) }
    }
}

/// The type with these fields; `None` if one of them is. All are read, so that every fault is recorded; a field may depend on those
/// before it, as options.
macro_rules! record {
    ($($Type:ident)::+ { $($field:ident: $read:expr),* $(,)? }) => {{
        $(let $field = $read;)*
        (|| Some($($Type)::+ { $($field: $field?,)* }))()
    }};
}
pub(super) use record;

/// Largest count or life [cycles] that a scene may request: beyond it a typing error is more likely than intent.
pub(super) const COUNT_LIMIT: i64 = 100_000_000;
/// Most checkpoints of a life; each has a surrogate per output.
pub(super) const CHECKPOINT_LIMIT: u32 = 100_000;
/// Most values of all outputs at all checkpoints: with its stated error each takes 16 bytes of a worker's message of at most 4 MiB.
pub const VALUE_LIMIT: usize = 200_000;
