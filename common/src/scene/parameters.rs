//! `[parameters]` while a scene is read: which are defined, evaluated or under evaluation, and which of them
//! something depends on.

use super::expression::RESERVED;
use super::faults::nearest;
use super::quantity::{Quantity, unit};
use std::collections::{BTreeMap, BTreeSet};
use toml::{Table, Value};

/// Longest chain of parameters, each defined by the next one.
const CHAIN_LIMIT: usize = 64;

/// The parameters of a scene: each is evaluated once, on its first use.
#[derive(Default)]
pub(super) struct Parameters<'s> {
    /// The table `[parameters]`.
    pub(super) definitions: Option<&'s Table>,
    /// Values of those evaluated so far; none for a faulty one.
    values: BTreeMap<String, Option<Quantity>>,
    /// Names of those under evaluation, each used in the definition of the one before it.
    open: Vec<String>,
    /// Names that other parts of the scene use.
    used_directly: BTreeSet<String>,
    /// Names that the definition of each parameter uses.
    uses: BTreeMap<String, BTreeSet<String>>,
}

/// What is known of a parameter when its value is needed.
pub(super) enum Lookup<'s> {
    /// It has been evaluated; none if it is faulty.
    Known(Option<Quantity>),
    /// It has not: its definition is to be evaluated, and the result passed to [`Parameters::close`].
    Open(&'s Value),
    /// Its definition depends on itself, or on a chain that is too long: `a -> b -> c`.
    Circular(String),
    /// It has no definition; the nearest name that has one.
    Undefined(Option<String>),
}

impl<'s> Parameters<'s> {
    /// Records that `name` is used, by the parameter under evaluation or else by the rest of the scene.
    pub(super) fn record_use(&mut self, name: &str) {
        match self.open.last() {
            Some(user) => self.uses.entry(user.clone()).or_default().insert(name.to_owned()),
            None => self.used_directly.insert(name.to_owned()),
        };
    }

    /// Looks up a parameter, and marks it as under evaluation if it has no value yet.
    pub(super) fn look_up(&mut self, name: &str) -> Lookup<'s> {
        if let Some(known) = self.values.get(name) {
            return Lookup::Known(*known);
        }
        let Some(definition) = self.definitions.and_then(|table| table.get(name)) else {
            let names = self.definitions.into_iter().flat_map(Table::keys).map(String::as_str);
            return Lookup::Undefined(nearest(name, names));
        };
        if self.open.iter().any(|open| open == name) || self.open.len() >= CHAIN_LIMIT {
            return Lookup::Circular(self.open.join(" -> "));
        }
        self.open.push(name.to_owned());
        Lookup::Open(definition)
    }

    /// Stores the value of the parameter last marked as under evaluation; none if it is faulty.
    pub(super) fn close(&mut self, value: Option<Quantity>) {
        if let Some(name) = self.open.pop() {
            self.values.insert(name, value);
        }
    }

    /// Parameters that the rest of the scene depends on, directly or through others.
    pub(super) fn used(&self) -> BTreeSet<String> {
        let mut used = BTreeSet::new();
        let mut left: Vec<&String> = self.used_directly.iter().collect();
        while let Some(name) = left.pop() {
            if used.insert(name.clone()) {
                left.extend(self.uses.get(name).into_iter().flatten());
            }
        }
        used
    }
}

/// Why a name cannot be that of a parameter; none if it can.
pub(super) fn why_not_a_name(name: &str) -> Option<&'static str> {
    let plain = name.chars().all(|c| c.is_alphanumeric() || c == '_')
        && name.chars().next().is_some_and(|c| !c.is_ascii_digit());
    if unit(name).is_some() {
        Some("it is a unit")
    } else if RESERVED.contains(&name) {
        Some("it is a function or constant of expressions")
    } else if !plain {
        Some("names of parameters have letters, digits and `_`, and start with a letter")
    } else {
        None
    }
}
