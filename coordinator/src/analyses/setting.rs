//! Reader of one setting as typed: `KEY=VALUE` with a quantity of the scene (`parameters.clearance=25 um`), `VARIABLE=MEAN`,
//! `VARIABLE.KEY=VALUE`, `LIMIT_STATE.threshold=VALUE` (or `.lower`, `.upper`), `correlation(A,B)=VALUE` or
//! `rank_correlation(A,B)=VALUE`, with the keys and values of a scene file.

use common::random::RandomVariable;
use common::scene::{Fault, FaultKind, Faults, SceneSource};
use toml::{Table, Value};

/// Keys of a random variable that can be set.
const VARIABLE_KEYS: [&str; 7] = ["distribution", "mean", "std", "lower", "upper", "mode", "truncation"];

/// Beginnings of the keys that only quantities of a scene have.
const SCENE_KEYS: [&str; 5] = ["parameters.", "bodies.", "joints.", "loads.", "materials."];

/// What may be set.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Allowed {
    /// Everything, before a study.
    Everything,
    /// Distributions, correlations and thresholds.
    Distributions,
    /// Distributions, correlations and thresholds of a finished study, whose simulations do not show the influence of its constants.
    Studied,
}

/// What a setting changes.
#[derive(Debug, Clone, PartialEq)]
pub enum Place {
    /// A quantity of the scene, by the path of its key.
    Quantity(String),
    /// A key of the random variable of this index.
    Variable(usize, &'static str),
    /// A threshold of a limit state, by the path of its key.
    Threshold(String),
    /// The correlation of the two random variables of these indices, the smaller one first.
    Correlation([usize; 2]),
}

/// A value given to one quantity or distribution: what it changes, and its value as in a scene file; of a correlation the whole row.
pub type Setting = (Place, Value);

/// Reads settings, each of another place: those without a fault, and the faults.
pub fn parse_all(source: &SceneSource, settings: &[String], allowed: Allowed) -> (Vec<Setting>, Vec<Fault>) {
    let (mut read, mut faults) = (Vec::<Setting>::new(), Vec::new());
    for setting in settings {
        match parse(source, setting, allowed) {
            Ok(found) if read.iter().any(|(place, _)| *place == found.0) => {
                faults.push(Fault::new("--set", setting, "this is set twice"));
            }
            Ok(found) => read.push(found),
            Err(kind) => faults.push(Fault::new("--set", setting, kind)),
        }
    }
    (read, faults)
}

/// Whether a key is a quantity of the scene itself: no random variable, distribution, threshold or correlation.
pub fn is_scene_quantity(source: &SceneSource, key: &str) -> bool {
    let others = ["variables.", "limit_states.", "correlations"];
    source.variable(key).is_none()
        && source.quantities.contains_key(key)
        && !others.iter().any(|start| key.starts_with(start))
}

fn parse(source: &SceneSource, setting: &str, allowed: Allowed) -> Result<Setting, FaultKind> {
    let Some((key, text)) = setting.split_once('=') else {
        return refuse("expected KEY=VALUE, e.g. rod_length.std='0.1 mm'");
    };
    let (key, text) = (key.trim(), text.trim());
    if text.is_empty() {
        return refuse("expected a value after =");
    }
    let value = read_value(text);
    if let Some((word, names)) = key.strip_suffix(')').and_then(|key| key.split_once('(')) {
        let of = match word.trim_end() {
            "correlation" => "coefficient",
            "rank_correlation" => "rank",
            _ => return refuse(&usage()),
        };
        return correlation(source, names, of, value);
    }
    let everything = allowed == Allowed::Everything;
    let place = match source.variable(key) {
        Some(k) if everything => Place::Variable(k, "mean"),
        // A key that can only be that of a quantity of the scene: an unknown one is answered with the nearest quantity.
        _ if everything && SCENE_KEYS.iter().any(|start| key.starts_with(start)) => {
            quantity(source, setting, key)?
        }
        _ if !is_scene_quantity(source, key) => distribution(source, key)?,
        _ if everything => quantity(source, setting, key)?,
        _ => {
            return refuse(
                "this key changes what is simulated, so the results of the study say nothing of it; start a study of the changed \
                 scene with `coordinator run --set`",
            );
        }
    };
    if let (Place::Variable(k, _), Allowed::Studied) = (&place, allowed)
        && let variable = &source.variables()[*k]
        && variable.distribution.is_constant()
    {
        return refuse(&format!(
            "\"{}\" was constant in all simulations of the study, which therefore do not show its influence; start a study in \
             which it varies with `coordinator run`",
            variable.name
        ));
    }
    Ok((place, value))
}

fn refuse<T>(message: &str) -> Result<T, FaultKind> {
    Err(message.into())
}

fn usage() -> String {
    format!(
        "expected VARIABLE.KEY with one of the keys {}, LIMIT_STATE.threshold (of two, .lower and .upper), \
         correlation(VARIABLE,VARIABLE) or rank_correlation(VARIABLE,VARIABLE)",
        VARIABLE_KEYS.join(", ")
    )
}

/// A number, or the text without its quotes.
fn read_value(text: &str) -> Value {
    let bare = text.strip_prefix('"').and_then(|text| text.strip_suffix('"')).unwrap_or(text);
    bare.parse::<f64>().map_or_else(|_| Value::String(bare.to_owned()), Value::Float)
}

/// A quantity of the scene that no random variable changes.
fn quantity(source: &SceneSource, setting: &str, key: &str) -> Result<Place, FaultKind> {
    source.parse_setting(setting).map_err(|Faults(mut faults)| faults.remove(0).kind)?;
    let owner = source.variables().iter().find(|variable| variable.changes.iter().any(|own| own == key));
    let Some(RandomVariable { name, .. }) = owner else { return Ok(Place::Quantity(key.to_owned())) };
    let what = format!("the random variable \"{name}\" changes this key in every simulation");
    refuse(&format!("{what}; set {name} or {name}.mean instead"))
}

/// A key of a random variable or a threshold.
fn distribution(source: &SceneSource, key: &str) -> Result<Place, FaultKind> {
    if source.variable(key).is_some() {
        return refuse(&format!(
            "a random variable has no single value; change its distribution, e.g. {key}.mean=... or {key}.std=..."
        ));
    }
    let Some((name, last)) = key.rsplit_once('.') else { return Err(source.unknown_setting(key)) };
    let name = name.strip_prefix("variables.").or_else(|| name.strip_prefix("limit_states.")).unwrap_or(name);
    let variable = source.variable(name);
    let states = &source.nominal().limit_states;
    let state = states.iter().find(|state| state.name == name);
    let is_bound = ["lower", "upper"].contains(&last);
    if let Some(state) = state.filter(|_| last == "threshold" || (is_bound && variable.is_none())) {
        if state.middle().is_some() == is_bound {
            return Ok(Place::Threshold(format!("limit_states.{name}.{last}")));
        }
        let keys = if is_bound { "a threshold" } else { "lower and upper" };
        return refuse(&format!("limit state \"{name}\" has {keys}, no \"{last}\""));
    }
    if last == "threshold" {
        let known = states.iter().map(|state| state.name.as_str());
        return Err(FaultKind::unknown_reference("limit state", name, known));
    }
    let allowed = VARIABLE_KEYS.join(", ");
    match (variable, VARIABLE_KEYS.into_iter().find(|known| *known == last)) {
        (Some(k), Some(key)) => Ok(Place::Variable(k, key)),
        (Some(_), None) => refuse(&format!("\"{last}\" is no key of a random variable; allowed: {allowed}")),
        (None, Some(_)) => Err(source.unknown_setting(name)),
        (None, None) => refuse(&usage()),
    }
}

fn correlation(source: &SceneSource, names: &str, key: &str, value: Value) -> Result<Setting, FaultKind> {
    let pair = pair_of(source, names)?;
    let names = pair.map(|k| source.variables()[k].name.as_str());
    let [i, k] = pair;
    Ok((Place::Correlation([i.min(k), i.max(k)]), correlation_row(names, key, value)))
}

/// Indices of two random variables named as `A,B` or `A B`.
///
/// # Errors
/// What is allowed.
pub fn pair_of(source: &SceneSource, names: &str) -> Result<[usize; 2], FaultKind> {
    let names: Vec<&str> = names.split([',', ' ']).filter(|name| !name.is_empty()).collect();
    let [first, second] = names[..] else {
        return refuse("expected two random variables, e.g. correlation(rod_length,friction)");
    };
    if first == second {
        return refuse("expected two different random variables");
    }
    let index = |name: &str| source.variable(name).ok_or_else(|| source.unknown_setting(name));
    Ok([index(first)?, index(second)?])
}

/// A row of the list of correlations, with its value at the key `coefficient` or `rank`.
pub fn correlation_row(names: [&str; 2], key: &str, value: Value) -> Value {
    let row = [("variables", Value::from(names.to_vec())), (key, value)];
    Table::from_iter(row.map(|(key, value)| (key.to_owned(), value))).into()
}
