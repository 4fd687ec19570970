//! One table of a scene file while it is read: fields by name, and at the end the keys nobody asked for.

use super::faults::{FaultKind, nearest};
use super::quantity::Kind;
use super::read::{Context, Range};
use std::ops::RangeInclusive;
use toml::{Table, Value};

/// A table and the path that leads to it.
pub(super) struct Section<'s> {
    /// Path of the table, e.g. `joints.1`; empty for the whole file.
    pub(super) path: String,
    table: &'s Table,
    asked: Vec<&'static str>,
    given_up: bool,
}

impl<'s> Section<'s> {
    pub(super) fn new(path: impl Into<String>, table: &'s Table) -> Self {
        Section { path: path.into(), table, asked: Vec::new(), given_up: false }
    }

    /// Path of a key of this table.
    pub(super) fn key(&self, key: &str) -> String {
        if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) }
    }

    /// The value of a key, if it is there.
    pub(super) fn get(&mut self, key: &'static str) -> Option<&'s Value> {
        if !self.asked.contains(&key) {
            self.asked.push(key);
        }
        self.table.get(key)
    }

    fn require(
        &mut self,
        cx: &mut Context,
        key: &'static str,
        expected: impl FnOnce() -> String,
    ) -> Option<&'s Value> {
        let value = self.get(key);
        if value.is_none() {
            cx.fault(self.key(key), FaultKind::Missing { expected: expected() });
        }
        value
    }

    /// A quantity that must be there.
    pub(super) fn quantity(
        &mut self,
        cx: &mut Context,
        key: &'static str,
        kind: Kind,
        range: Range,
    ) -> Option<f64> {
        let value = self.require(cx, key, || kind.in_words())?;
        cx.quantity(&self.key(key), value, kind, range)
    }

    /// A quantity with a default.
    pub(super) fn quantity_or(
        &mut self,
        cx: &mut Context,
        key: &'static str,
        kind: Kind,
        range: Range,
        default: f64,
    ) -> Option<f64> {
        match self.get(key) {
            Some(value) => cx.quantity(&self.key(key), value, kind, range),
            None => Some(default),
        }
    }

    /// A pair `[x, y]` of quantities; the keys of its components end in `.x` and `.y`.
    pub(super) fn pair(&mut self, cx: &mut Context, key: &'static str, kind: Kind) -> Option<[f64; 2]> {
        let value = self.require(cx, key, || format!("a pair [x, y], each {}", kind.name))?;
        pair(cx, &self.key(key), value, kind)
    }

    /// A pair with a default.
    pub(super) fn pair_or(
        &mut self,
        cx: &mut Context,
        key: &'static str,
        kind: Kind,
        default: [f64; 2],
    ) -> Option<[f64; 2]> {
        match self.get(key) {
            Some(value) => pair(cx, &self.key(key), value, kind),
            None => Some(default),
        }
    }

    /// A list of quantities `(n,)`; the keys of its entries end in `.1`, `.2`, ...
    pub(super) fn quantities(&mut self, cx: &mut Context, key: &'static str, kind: Kind) -> Option<Vec<f64>> {
        let expected = || format!("a list, each {}", kind.in_words());
        let value = self.require(cx, key, expected)?;
        let path = self.key(key);
        let Some(list) = value.as_array() else {
            cx.wrong_type(&path, value, expected());
            return None;
        };
        let read = |(i, value)| cx.quantity(&format!("{path}.{}", i + 1), value, kind, Range::Any);
        let found: Vec<_> = list.iter().enumerate().map(read).collect();
        found.into_iter().collect()
    }

    /// `true` or `false`, with a default.
    pub(super) fn boolean_or(&mut self, cx: &mut Context, key: &'static str, default: bool) -> Option<bool> {
        let Some(value) = self.get(key) else { return Some(default) };
        if value.as_bool().is_none() {
            cx.wrong_type(&self.key(key), value, "true or false".to_owned());
        }
        value.as_bool()
    }

    /// A text that must be there.
    pub(super) fn text(&mut self, cx: &mut Context, key: &'static str, expected: &str) -> Option<&'s str> {
        let value = self.require(cx, key, || expected.to_owned())?;
        self.as_text(cx, key, value, expected)
    }

    /// A text with a default.
    pub(super) fn text_or<'a>(
        &mut self,
        cx: &mut Context,
        key: &'static str,
        expected: &str,
        default: &'a str,
    ) -> Option<&'a str>
    where
        's: 'a,
    {
        match self.get(key) {
            Some(value) => self.as_text(cx, key, value, expected),
            None => Some(default),
        }
    }

    /// The word that decides what kind of thing this table is; if it is none of `words`, the table is given up.
    pub(super) fn word<T: Copy>(
        &mut self,
        cx: &mut Context,
        key: &'static str,
        words: &[(&str, T)],
    ) -> Option<T> {
        let expected = || {
            let names: Vec<_> = words.iter().map(|(name, _)| *name).collect();
            format!("one of {}", names.join(", "))
        };
        let value = self.require(cx, key, expected);
        let text = value.and_then(|value| self.as_text(cx, key, value, "a word"));
        let word = text.and_then(|word| cx.word(&self.key(key), word, words));
        self.given_up |= word.is_none();
        word
    }

    /// [`Section::word`], or a default if the key is not there.
    pub(super) fn word_or<T: Copy>(
        &mut self,
        cx: &mut Context,
        key: &'static str,
        words: &[(&str, T)],
        default: T,
    ) -> Option<T> {
        if self.get(key).is_some() { self.word(cx, key, words) } else { Some(default) }
    }

    fn as_text(&self, cx: &mut Context, key: &str, value: &'s Value, expected: &str) -> Option<&'s str> {
        let text = value.as_str();
        if text.is_none() {
            cx.wrong_type(&self.key(key), value, expected.to_owned());
        }
        text
    }

    /// A whole number within a range.
    pub(super) fn integer(
        &mut self,
        cx: &mut Context,
        key: &'static str,
        range: RangeInclusive<i64>,
        default: Option<i64>,
    ) -> Option<i64> {
        let allowed = if *range.end() == i64::MAX {
            format!(">= {}", range.start())
        } else {
            format!("{} to {}", range.start(), range.end())
        };
        let value = match (self.get(key), default) {
            (Some(value), _) => value,
            (None, Some(default)) => return Some(default),
            (None, None) => return self.require(cx, key, || format!("a whole number {allowed}")).and(None),
        };
        match value.as_integer() {
            Some(n) if range.contains(&n) => Some(n),
            Some(n) => {
                cx.fault(self.key(key), FaultKind::OutOfRange { value: n.to_string(), allowed });
                None
            }
            None => {
                cx.wrong_type(&self.key(key), value, format!("a whole number {allowed}"));
                None
            }
        }
    }

    /// A list of texts.
    pub(super) fn texts(
        &mut self,
        cx: &mut Context,
        key: &'static str,
        expected: &str,
    ) -> Option<Vec<&'s str>> {
        let value = self.require(cx, key, || expected.to_owned())?;
        let texts = value.as_array().and_then(|all| all.iter().map(Value::as_str).collect());
        if texts.is_none() {
            cx.wrong_type(&self.key(key), value, expected.to_owned());
        }
        texts
    }

    /// A table that must be there.
    pub(super) fn section(
        &mut self,
        cx: &mut Context,
        key: &'static str,
        expected: &str,
    ) -> Option<Section<'s>> {
        self.require(cx, key, || expected.to_owned())?;
        self.section_if_any(cx, key)
    }

    /// A table that may be there.
    pub(super) fn section_if_any(&mut self, cx: &mut Context, key: &'static str) -> Option<Section<'s>> {
        let value = self.get(key)?;
        let path = self.key(key);
        match value {
            Value::Table(table) => Some(Section::new(path, table)),
            other => {
                cx.wrong_type(&path, other, "a table".to_owned());
                None
            }
        }
    }

    /// The sub-tables of a table, by name.
    pub(super) fn named(&mut self, cx: &mut Context, key: &'static str) -> Vec<(&'s str, Section<'s>)> {
        let Some(section) = self.section_if_any(cx, key) else { return Vec::new() };
        let mut all = Vec::new();
        for (name, value) in section.table {
            let path = section.key(name);
            match value {
                Value::Table(table) => all.push((name.as_str(), Section::new(path, table))),
                other => cx.wrong_type(&path, other, "a table".to_owned()),
            }
        }
        all
    }

    /// The rows of a list of tables, each with its unique name; `what` the list holds, in the plural.
    pub(super) fn rows(&mut self, cx: &mut Context, key: &'static str) -> Vec<(&'s str, Section<'s>)> {
        let Some(value) = self.get(key) else { return Vec::new() };
        let path = self.key(key);
        let Some(list) = value.as_array() else {
            cx.wrong_type(&path, value, format!("a list of tables [[{key}]]"));
            return Vec::new();
        };
        let mut rows: Vec<(&str, Section)> = Vec::new();
        for (i, value) in list.iter().enumerate() {
            let place = format!("{path}[{}]", i + 1);
            let Some(table) = value.as_table() else {
                cx.wrong_type(&place, value, "a table".to_owned());
                continue;
            };
            let mut row = Section::new(place, table);
            let Some(name) = row.text(cx, "name", "a name") else { continue };
            let key = row.key("name");
            if rows.iter().any(|(taken, _)| *taken == name) {
                cx.fault(key, FaultKind::Duplicate { what: path.clone(), value: name.to_owned() });
                continue;
            }
            if name.is_empty() || name.contains('.') || name.contains(char::is_control) {
                let reason = "names are not empty and have no dots or control characters".to_owned();
                cx.fault(key, FaultKind::BadName { value: name.to_owned(), reason });
                continue;
            }
            row.path = format!("{path}.{name}");
            rows.push((name, row));
        }
        rows
    }

    /// The rows of a list of tables that have no names; their paths have their numbers, from 1.
    pub(super) fn unnamed_rows(&mut self, cx: &mut Context, key: &'static str) -> Vec<Section<'s>> {
        let Some(value) = self.get(key) else { return Vec::new() };
        let path = self.key(key);
        let Some(list) = value.as_array() else {
            cx.wrong_type(&path, value, format!("a list of tables [[{key}]]"));
            return Vec::new();
        };
        let mut rows = Vec::new();
        for (i, value) in list.iter().enumerate() {
            let place = format!("{path}[{}]", i + 1);
            match value.as_table() {
                Some(table) => rows.push(Section::new(place, table)),
                None => cx.wrong_type(&place, value, "a table".to_owned()),
            }
        }
        rows
    }

    /// Every key of this table with its value, as known keys.
    pub(super) fn entries(&self) -> impl Iterator<Item = (&'s String, &'s Value)> + use<'s> {
        self.table.iter()
    }

    /// Keys that nobody asked for become faults.
    pub(super) fn finish(self, cx: &mut Context) {
        if self.given_up {
            return;
        }
        for key in self.table.keys().filter(|key| !self.asked.contains(&key.as_str())) {
            let nearest = nearest(key, self.asked.iter().copied());
            let known = self.asked.iter().map(|key| (*key).to_owned()).collect();
            cx.fault(self.key(key), FaultKind::UnknownKey { nearest, known });
        }
    }
}

/// Reads `[x, y]`.
pub(super) fn pair(cx: &mut Context, key: &str, value: &Value, kind: Kind) -> Option<[f64; 2]> {
    match value.as_array().map(Vec::as_slice) {
        Some([x, y]) => {
            let x = cx.quantity(&format!("{key}.x"), x, kind, Range::Any);
            let y = cx.quantity(&format!("{key}.y"), y, kind, Range::Any);
            Some([x?, y?])
        }
        _ => {
            cx.wrong_type(key, value, format!("a pair [x, y], each {}", kind.name));
            None
        }
    }
}
