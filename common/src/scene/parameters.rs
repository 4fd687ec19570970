//! The named parameters of a scene: each evaluated once, when somebody asks for it, and who asked.

use super::expression::{ExpressionError, RESERVED};
use super::faults::{FaultKind, nearest};
use super::quantity::{Quantity, unit};
use super::read::Context;
use std::collections::{BTreeMap, BTreeSet};
use toml::Table;

/// Parameters may refer to each other through this many steps.
const PARAMETER_DEPTH: usize = 64;

/// `[parameters]` while a scene is read.
#[derive(Default)]
pub(super) struct Parameters<'s> {
    definitions: Option<&'s Table>,
    values: BTreeMap<String, Option<Quantity>>,
    /// Those under evaluation, each asked for by the one before it.
    open: Vec<String>,
    /// Those that some other part of the scene asked for.
    asked: BTreeSet<String>,
    /// What each parameter asked for.
    reads: BTreeMap<String, BTreeSet<String>>,
}

impl Parameters<'_> {
    /// Parameters that the rest of the scene depends on, directly or through others.
    pub(super) fn used(&self) -> BTreeSet<String> {
        let mut used = BTreeSet::new();
        let mut left: Vec<&String> = self.asked.iter().collect();
        while let Some(name) = left.pop() {
            if used.insert(name.clone()) {
                left.extend(self.reads.get(name).into_iter().flatten());
            }
        }
        used
    }
}

impl<'s> Context<'s> {
    /// Evaluates every parameter, and notes names that cannot be one.
    pub(super) fn read_parameters(&mut self, table: &'s Table) {
        self.parameters.definitions = Some(table);
        for name in table.keys() {
            let plain = name.chars().all(|c| c.is_alphanumeric() || c == '_')
                && name.chars().next().is_some_and(|c| !c.is_ascii_digit());
            let reason = if unit(name).is_some() {
                Some("it is a unit")
            } else if RESERVED.contains(&name.as_str()) {
                Some("it is a function or constant of expressions")
            } else if !plain {
                Some("names of parameters have letters, digits and `_`, and start with a letter")
            } else {
                None
            };
            match reason {
                Some(reason) => {
                    let (value, reason) = (name.clone(), reason.to_owned());
                    self.fault(format!("parameters.{name}"), FaultKind::BadName { value, reason });
                }
                None => {
                    let _ = self.evaluated(name);
                }
            }
        }
    }

    /// The value of a parameter for the expression that names it.
    pub(super) fn parameter(&mut self, name: &str) -> Result<Quantity, ExpressionError> {
        let all = &mut self.parameters;
        match all.open.last() {
            Some(reader) => all.reads.entry(reader.clone()).or_default().insert(name.to_owned()),
            None => all.asked.insert(name.to_owned()),
        };
        self.evaluated(name)
    }

    fn evaluated(&mut self, name: &str) -> Result<Quantity, ExpressionError> {
        let all = &mut self.parameters;
        let broken = || ExpressionError::Broken(name.to_owned());
        if let Some(known) = all.values.get(name) {
            return known.ok_or_else(broken);
        }
        let definition = all.definitions.and_then(|table| table.get(name));
        let Some(definition) = definition else {
            let names = all.definitions.into_iter().flat_map(Table::keys).map(String::as_str);
            let nearest = nearest(name, names);
            return Err(ExpressionError::UnknownName { name: name.to_owned(), nearest });
        };
        let key = format!("parameters.{name}");
        if all.open.iter().any(|open| open == name) || all.open.len() >= PARAMETER_DEPTH {
            let chain = all.open.join(" -> ");
            self.inconsistent(key, format!("depends on itself, or through too many others: {chain}"));
            return Err(broken());
        }
        all.open.push(name.to_owned());
        let value = self.value(&key, definition, None);
        self.parameters.open.pop();
        self.parameters.values.insert(name.to_owned(), value);
        value.ok_or_else(broken)
    }
}
