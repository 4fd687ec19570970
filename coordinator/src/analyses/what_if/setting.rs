//! Reader of one change as typed: `VARIABLE.KEY=VALUE`, `LIMIT_STATE.threshold=VALUE` (or `.lower`, `.upper`) or `correlation(A,B)=VALUE`, with the
//! keys and values of a scene file.

use common::scene::{Fault, FaultKind, Faults, SceneSource};
use toml::Value;

/// Keys of a random variable that can be changed.
pub const VARIABLE_KEYS: [&str; 7] = ["distribution", "mean", "std", "lower", "upper", "mode", "truncation"];

/// One change, its value as in a scene file.
#[derive(Debug, Clone, PartialEq)]
pub enum Setting {
    /// A key of a random variable.
    Variable {
        /// Index of the variable.
        variable: usize,
        /// One of [`VARIABLE_KEYS`].
        key: &'static str,
        /// Its value as in a scene file.
        value: Value,
    },
    /// A threshold of a limit state.
    Threshold {
        /// Index of the limit state.
        limit_state: usize,
        /// `threshold`, or `lower` or `upper` of two.
        key: &'static str,
        /// Its value as in a scene file.
        value: Value,
    },
    /// The correlation of two random variables.
    Correlation {
        /// Indices of the variables.
        pair: [usize; 2],
        /// `coefficient` or `rank`.
        key: &'static str,
        /// Its value as in a scene file.
        value: Value,
    },
}

impl Setting {
    /// True if both change the same thing.
    pub fn coincides(&self, other: &Self) -> bool {
        match (self, other) {
            (
                Self::Variable { variable, key, .. },
                Self::Variable { variable: other_variable, key: other_key, .. },
            ) => (variable, key) == (other_variable, other_key),
            (
                Self::Threshold { limit_state, key, .. },
                Self::Threshold { limit_state: other, key: other_key, .. },
            ) => (limit_state, key) == (other, other_key),
            (Self::Correlation { pair: [a, b], .. }, Self::Correlation { pair: other, .. }) => {
                *other == [*a, *b] || *other == [*b, *a]
            }
            _ => false,
        }
    }
}

/// The fault of a setting.
pub fn fault(setting: &str, message: impl Into<String>) -> Fault {
    let kind = FaultKind::Inconsistent { message: message.into() };
    Fault::new("--set", setting, kind)
}

fn refused(setting: &str, message: impl Into<String>) -> Faults {
    Faults(vec![fault(setting, message)])
}

/// Reads a setting.
///
/// # Errors
/// The fault of the setting: an unknown name or key, or a key that changes what is simulated.
pub fn parse(source: &SceneSource, setting: &str) -> Result<Setting, Faults> {
    let Some((key, value)) = setting.split_once('=') else {
        return Err(refused(setting, "expected KEY=VALUE, e.g. rod_length.std='0.1 mm'"));
    };
    let (key, value) = (key.trim(), value.trim());
    if value.is_empty() {
        return Err(refused(setting, "expected a value after ="));
    }
    let value = read_value(value);
    for (word, of) in [("correlation", "coefficient"), ("rank_correlation", "rank")] {
        let pair = key.strip_prefix(word).map(str::trim_start).and_then(|rest| rest.strip_prefix('('));
        if let Some(names) = pair.and_then(|rest| rest.strip_suffix(')')) {
            return correlation(source, setting, names, of, value);
        }
    }
    let Some((name, last)) = key.rsplit_once('.') else {
        return Err(not_a_key(source, setting, key));
    };
    let name = name.strip_prefix("variables.").or_else(|| name.strip_prefix("limit_states.")).unwrap_or(name);
    let known = source.variables().iter().position(|variable| variable.name == name);
    if let Some((limit_state, key)) = threshold(source, setting, (name, last), known.is_some())? {
        return Ok(Setting::Threshold { limit_state, key, value });
    }
    match (known, VARIABLE_KEYS.iter().find(|key| **key == last)) {
        (Some(variable), Some(key)) => Ok(Setting::Variable { variable, key, value }),
        (Some(_), None) => {
            let message =
                format!("\"{last}\" is no key of a random variable; allowed: {}", VARIABLE_KEYS.join(", "));
            Err(refused(setting, message))
        }
        (None, Some(_)) => {
            // A quantity of the scene may have the same last word.
            if is_quantity(source, key) {
                Err(simulated(setting))
            } else {
                Err(unknown_variable(source, setting, name))
            }
        }
        (None, None) => Err(not_a_key(source, setting, key)),
    }
}

/// Limit state and key of a threshold, if NAME.KEY is one; `is_variable` is true if NAME is a random variable, which has the keys
/// `lower` and `upper` too.
fn threshold(
    source: &SceneSource,
    setting: &str,
    (name, last): (&str, &str),
    is_variable: bool,
) -> Result<Option<(usize, &'static str)>, Faults> {
    let Some(key) = ["threshold", "lower", "upper"].into_iter().find(|key| *key == last) else {
        return Ok(None);
    };
    let states = &source.nominal().limit_states;
    let is_limit_state = states.iter().any(|state| state.name == name);
    if key != "threshold" && (is_variable || !is_limit_state) {
        return Ok(None);
    }
    let found = limit_state(source, setting, name)?;
    let two = states[found].middle().is_some();
    if two == (key == "threshold") {
        let has = if two { "lower and upper" } else { "a threshold" };
        return Err(refused(setting, format!("limit state \"{name}\" has {has}, no \"{key}\"")));
    }
    Ok(Some((found, key)))
}

/// A number, or the text without its quotes.
fn read_value(text: &str) -> Value {
    let bare = text.strip_prefix('"').and_then(|text| text.strip_suffix('"')).unwrap_or(text);
    bare.parse::<f64>().map_or_else(|_| Value::String(bare.to_owned()), Value::Float)
}

fn limit_state(source: &SceneSource, setting: &str, name: &str) -> Result<usize, Faults> {
    let states = &source.nominal().limit_states;
    states.iter().position(|state| state.name == name).ok_or_else(|| {
        let known = states.iter().map(|state| state.name.clone()).collect();
        let kind =
            FaultKind::UnknownReference { what: "limit state", value: name.to_owned(), nearest: None, known };
        Faults::one("--set", setting, kind)
    })
}

fn correlation(
    source: &SceneSource,
    setting: &str,
    names: &str,
    key: &'static str,
    value: Value,
) -> Result<Setting, Faults> {
    let names: Vec<&str> = names.split(',').map(str::trim).collect();
    let [first, second] = names[..] else {
        return Err(refused(
            setting,
            "expected two random variables, e.g. correlation(rod_length,friction)=0.5",
        ));
    };
    if first == second {
        return Err(refused(setting, "expected two different random variables"));
    }
    let index = |name: &str| {
        let known = source.variables().iter().position(|variable| variable.name == name);
        known.ok_or_else(|| unknown_variable(source, setting, name))
    };
    Ok(Setting::Correlation { pair: [index(first)?, index(second)?], key, value })
}

/// The fault of an unknown name, with the nearest one.
fn unknown_variable(source: &SceneSource, setting: &str, name: &str) -> Faults {
    let found = source.parse_setting(&format!("{name}=1")).err().map(|Faults(faults)| faults);
    match found.and_then(|faults| faults.into_iter().next()) {
        Some(Fault { kind: kind @ FaultKind::UnknownReference { .. }, .. }) => {
            Faults::one("--set", setting, kind)
        }
        _ => refused(setting, format!("\"{name}\" is no random variable")),
    }
}

/// The fault of a key without a form of a change.
fn not_a_key(source: &SceneSource, setting: &str, key: &str) -> Faults {
    let is_variable = source.variables().iter().any(|variable| variable.name == key);
    if is_variable {
        return refused(
            setting,
            format!(
                "a random variable has no single value; change its distribution, e.g. {key}.mean=... or {key}.std=..."
            ),
        );
    }
    if is_quantity(source, key) {
        return simulated(setting);
    }
    if !key.contains(['.', '(']) {
        return unknown_variable(source, setting, key);
    }
    refused(
        setting,
        format!(
            "expected VARIABLE.KEY with one of the keys {}, LIMIT_STATE.threshold (of two, .lower and .upper), \
             correlation(VARIABLE,VARIABLE) or rank_correlation(VARIABLE,VARIABLE)",
            VARIABLE_KEYS.join(", ")
        ),
    )
}

/// Whether a key is a quantity of the scene.
fn is_quantity(source: &SceneSource, key: &str) -> bool {
    let unknown = |fault: &Fault| matches!(fault.kind, FaultKind::UnknownReference { .. });
    !source.parse_setting(&format!("{key}=1")).is_err_and(|Faults(faults)| faults.iter().any(unknown))
}

fn simulated(setting: &str) -> Faults {
    refused(
        setting,
        "this key changes what is simulated, so the results of the study say nothing of it; start a study of the changed \
         scene with `coordinator run --set`",
    )
}
