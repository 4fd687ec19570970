//! Converts the reply of an external simulator into an evaluation; checks names, shapes and numbers against the scene.

use super::slot::{SimulatorError, SlotError};
use crate::evaluation_shape::LARGEST;
use crate::failure::SimulationFailure;
use crate::outputs::Evaluation;
use crate::scene::{Condition, OutputKind, Scene};
use serde_json::{Map, Value};

/// Inputs and outputs of a simulator as declared by the scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Expected {
    /// Names of the inputs `(d,)`: the random variables, and further parameters that conditions of the scene change.
    pub inputs: Vec<String>,
    /// Names of the outputs, and whether each has a single value.
    pub outputs: Vec<(String, bool)>,
    /// Checkpoints `(m,)` [cycles].
    pub cycles: Vec<u32>,
}

impl Expected {
    /// Inputs, outputs and checkpoints of a scene.
    pub fn from_scene(scene: &Scene) -> Self {
        let single = |kind: &OutputKind| matches!(kind, OutputKind::External { single: true, .. });
        let mut inputs: Vec<String> = scene.variables.iter().map(|variable| variable.name.clone()).collect();
        let parameters = scene.conditions.first().into_iter().flat_map(|first| first.parameters.keys());
        inputs.extend(parameters.filter(|name| scene.variables.iter().all(|v| v.name != **name)).cloned());
        Self {
            inputs,
            outputs: scene.outputs.iter().map(|o| (o.name.clone(), single(&o.kind))).collect(),
            cycles: scene.life.checkpoints(),
        }
    }

    /// Values of the inputs `(d,)`: those of a sample of the random variables, and those of the parameters under a condition [SI].
    pub fn values(&self, sample: &[f64], condition: Option<&Condition>) -> Vec<f64> {
        let under = |name| condition.and_then(|condition| condition.parameters.get(name).copied());
        self.inputs.iter().enumerate().map(|(k, name)| under(name).unwrap_or_else(|| sample[k])).collect()
    }

    /// Number of values of each output.
    pub fn lengths(&self) -> Vec<usize> {
        self.outputs.iter().map(|(_, single)| if *single { 1 } else { self.cycles.len() }).collect()
    }

    /// Names of the outputs with their numbers of values, for messages.
    pub fn sizes(&self) -> String {
        let sizes = self.outputs.iter().zip(self.lengths());
        sizes.map(|((name, _), length)| format!("{name} {length}")).collect::<Vec<_>>().join(", ")
    }

    /// Values by the names of the outputs, from as many values as the outputs have, in their order.
    pub fn by_name(&self, values: impl IntoIterator<Item = Value>) -> Map<String, Value> {
        let mut values = values.into_iter();
        let mut cut = |length| Value::Array(values.by_ref().take(length).collect());
        let sizes = self.outputs.iter().zip(self.lengths());
        sizes.map(|((name, _), length)| (name.clone(), cut(length))).collect()
    }

    /// Builds an evaluation from values by name and, if given, numerical errors of the same shape and values at the start of
    /// life. An output with a single value has it from the start.
    ///
    /// # Errors
    /// [`NoResult`]: a fault if a name or shape does not fit the scene, a failure if a value is not a finite number.
    pub fn evaluation(
        &self,
        values: &Map<String, Value>,
        errors: Option<&Map<String, Value>>,
        start: Option<&Map<String, Value>>,
    ) -> Result<Evaluation, NoResult> {
        let mut histories = Vec::new();
        for (name, single) in &self.outputs {
            let value = values.get(name).ok_or_else(|| {
                let found: Vec<&str> = values.keys().map(String::as_str).collect();
                let found = if found.is_empty() { "none".to_owned() } else { found.join(", ") };
                format!("output \"{name}\" is missing; found: {found}")
            })?;
            histories.push(self.history(name, &format!("output \"{name}\""), value, *single)?);
        }
        let errors = errors.map(|errors| self.errors(errors)).transpose()?.unwrap_or_default();
        let start = self.start(&histories, start)?;
        Ok(Evaluation { start, errors, ..Evaluation::from_histories(self.cycles.clone(), histories) })
    }

    /// Values of the outputs at the start of life `(outputs,)`; empty if none is known.
    fn start(
        &self,
        histories: &[Vec<f64>],
        given: Option<&Map<String, Value>>,
    ) -> Result<Vec<Option<f64>>, String> {
        let start_of_output = |((name, single), history): (&(String, bool), &Vec<f64>)| {
            let Some(value) = given.and_then(|given| given.get(name)) else {
                return Ok(single.then(|| history[0]));
            };
            let number = value.as_f64().filter(|number| number.abs() <= LARGEST);
            let fault = || format!("the start of output \"{name}\" is {value} instead of a number");
            number.map(Some).ok_or_else(fault)
        };
        let found: Vec<_> =
            self.outputs.iter().zip(histories).map(start_of_output).collect::<Result<_, _>>()?;
        Ok(if found.iter().any(Option::is_some) { found } else { vec![] })
    }

    /// Stated errors of all outputs `(outputs, m)`; zero for an output without stated errors.
    fn errors(&self, errors: &Map<String, Value>) -> Result<Vec<Vec<f64>>, NoResult> {
        let of_output = |(name, single): &(String, bool)| {
            let Some(value) = errors.get(name) else { return Ok(vec![0.0; self.cycles.len()]) };
            let what = format!("the error of output \"{name}\"");
            let errors = self.history(&format!("{name} (its error)"), &what, value, *single)?;
            let is_right = errors.iter().all(|error| *error >= 0.0);
            is_right.then_some(errors).ok_or_else(|| format!("{what} is below 0").into())
        };
        self.outputs.iter().map(of_output).collect()
    }

    /// Values `(m,)` of an output.
    fn history(&self, output: &str, what: &str, value: &Value, single: bool) -> Result<Vec<f64>, NoResult> {
        let list = match value {
            Value::Array(list) => list.as_slice(),
            one => std::slice::from_ref(one),
        };
        let expected = if single { 1 } else { self.cycles.len() };
        if list.len() != expected {
            return Err(format!("{what} has {} values, expected {expected}", list.len()).into());
        }
        let of_cycle = |(value, cycles): (&Value, &u32)| {
            number(value, output, *cycles, || format!("{what} has {value} instead of a number"))
        };
        let mut values = list.iter().zip(&self.cycles).map(of_cycle).collect::<Result<Vec<f64>, _>>()?;
        if single {
            values.resize(self.cycles.len(), values[0]);
        }
        Ok(values)
    }
}

/// Why a reply has no result.
#[derive(Debug, Clone, PartialEq)]
pub enum NoResult {
    /// The reply does not fit the scene, in words.
    Fault(String),
    /// The sample has no result.
    Failure(SimulationFailure),
}

impl From<String> for NoResult {
    fn from(fault: String) -> Self {
        NoResult::Fault(fault)
    }
}

impl NoResult {
    /// A failure that the simulator reports.
    pub fn reported(message: String) -> Self {
        NoResult::Failure(SimulationFailure::Reported { message })
    }

    /// This reason, a fault with the `place` of the reply.
    pub fn of(self, place: &str) -> Self {
        match self {
            NoResult::Fault(fault) => NoResult::Fault(format!("{place}: {fault}")),
            failure => failure,
        }
    }
}

/// The outcome of a sample by what was read; a fault is the error that `broken` makes of it.
///
/// # Errors
/// That error.
pub fn outcome<T>(
    read: Result<T, NoResult>,
    broken: impl FnOnce(String) -> SimulatorError,
) -> Result<Result<T, SimulationFailure>, SlotError> {
    match read {
        Ok(found) => Ok(Ok(found)),
        Err(NoResult::Failure(failure)) => Ok(Err(failure)),
        Err(NoResult::Fault(fault)) => Err(broken(fault).into()),
    }
}

/// The object of a text of JSON in braces; `None` for any other text.
///
/// # Errors
/// [`NoResult`]: a failure if the first word begins with `fail`.
pub fn object(text: &str) -> Result<Option<Map<String, Value>>, NoResult> {
    if text.get(..4).is_some_and(|word| word.eq_ignore_ascii_case("fail")) {
        return Err(NoResult::reported(shown(text).replace('\n', " ")));
    }
    if !text.starts_with('{') {
        return Ok(None);
    }
    let reply = parse(text).map_err(|error| format!("\"{}\" is no JSON: {error}", shown(text)))?;
    Ok(reply.as_object().cloned())
}

/// The object at a key of a reply, if there is one.
///
/// # Errors
/// [`NoResult`]: a fault if it is no object, a failure if the reply states one.
pub fn by_name<'r>(
    reply: &'r Map<String, Value>,
    key: &str,
) -> Result<Option<&'r Map<String, Value>>, NoResult> {
    match (reply.get("failure"), reply.get(key)) {
        (Some(failure), _) => Err(NoResult::reported(plain(failure))),
        (None, None) => Ok(None),
        (None, Some(Value::Object(values))) => Ok(Some(values)),
        (None, Some(other)) => {
            Err(format!("\"{key}\" is {}, expected values by name", shown(&other.to_string())).into())
        }
    }
}

/// The number of an output after `cycles`, up to [`LARGEST`].
///
/// # Errors
/// [`NoResult`]: a failure if it is not finite or larger, the `fault` if it is no number.
pub fn number(
    value: &Value,
    output: &str,
    cycles: u32,
    fault: impl FnOnce() -> String,
) -> Result<f64, NoResult> {
    let value = match value.as_f64() {
        Some(number) if number.abs() <= LARGEST => return Ok(number),
        Some(number) => format!("{number:e}"),
        None if value.is_null() || value.as_str().is_some_and(is_non_finite_word) => plain(value),
        None => return Err(fault().into()),
    };
    Err(NoResult::Failure(SimulationFailure::NoNumber { output: output.to_owned(), cycles, value }))
}

/// Parses JSON as simulators write it; the words `NaN`, `Infinity` and `inf`, which JSON lacks, become strings.
///
/// # Errors
/// The message of the JSON parser.
pub fn parse(text: &str) -> Result<Value, String> {
    serde_json::from_str(text)
        .or_else(|error| serde_json::from_str(&quote_non_finite(text)).map_err(|_| error.to_string()))
}

/// The first 120 characters of a text, for messages.
pub fn shown(text: &str) -> String {
    const SHOWN: usize = 120;
    match text.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_owned(),
    }
}

/// True for `NaN`, `inf` and `infinity` in any case, with or without sign.
pub fn is_non_finite_word(word: &str) -> bool {
    let bare = word.trim_start_matches(['-', '+']);
    ["nan", "inf", "infinity"].iter().any(|word| bare.eq_ignore_ascii_case(word))
}

/// A text without its quotes, any other value as JSON.
fn plain(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

fn quote_non_finite(text: &str) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let length = match c {
            '"' => quoted_length(rest),
            '-' | '+' | 'a'..='z' | 'A'..='Z' => {
                let sign = usize::from(!c.is_ascii_alphabetic());
                sign + rest[sign..].find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(rest.len() - sign)
            }
            other => other.len_utf8(),
        };
        let (word, after) = rest.split_at(length);
        if is_non_finite_word(word) {
            out.extend(["\"", word, "\""]);
        } else {
            out.push_str(word);
        }
        rest = after;
    }
    out
}

/// Length of the JSON string at the start of `text` [bytes].
fn quoted_length(text: &str) -> usize {
    let mut escaped = false;
    for (at, c) in text.char_indices().skip(1) {
        match c {
            '"' if !escaped => return at + 1,
            '\\' => escaped = !escaped,
            _ => escaped = false,
        }
    }
    text.len()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn expected() -> Expected {
        Expected {
            inputs: vec!["x".into()],
            outputs: vec![("g".into(), false), ("h".into(), true)],
            cycles: vec![100, 200],
        }
    }

    fn evaluation(outputs: Value, errors: Option<Value>) -> Result<Evaluation, NoResult> {
        let errors = errors.as_ref().map(|errors| errors.as_object().unwrap());
        expected().evaluation(outputs.as_object().unwrap(), errors, None)
    }

    #[test]
    fn the_start_of_life_is_taken_by_name() {
        let with = |start: Value| {
            let outputs = json!({ "g": [1, 2], "h": 3 });
            let found = expected().evaluation(outputs.as_object().unwrap(), None, start.as_object());
            found.map(|evaluation| evaluation.start)
        };
        assert_eq!(with(Value::Null), Ok(vec![None, Some(3.0)]));
        assert_eq!(with(json!({ "g": 0.5 })), Ok(vec![Some(0.5), Some(3.0)]));
        assert_eq!(
            with(json!({ "g": [0.5] })).unwrap_err(),
            NoResult::Fault("the start of output \"g\" is [0.5] instead of a number".into())
        );
    }

    #[test]
    fn values_and_errors_have_the_scenes_shape() {
        let found = evaluation(json!({ "h": [3], "g": [1.5, -2], "more": [] }), None).unwrap();
        assert_eq!(found.histories, [[1.5, -2.0], [3.0, 3.0]]);
        assert!(found.errors.is_empty());
        let found = evaluation(json!({ "g": [1, 2], "h": 3.0 }), Some(json!({ "g": [0.1, 0] }))).unwrap();
        assert_eq!(found.errors, [[0.1, 0.0], [0.0, 0.0]]);
    }

    #[test]
    fn what_does_not_fit_is_named() {
        for (outputs, errors, said) in [
            (json!({}), None, "output \"g\" is missing; found: none"),
            (json!({ "G": 1, "h": 1 }), None, "output \"g\" is missing; found: G, h"),
            (json!({ "g": [1], "h": 1 }), None, "output \"g\" has 1 values, expected 2"),
            (json!({ "g": [1, 2], "h": [1, 2] }), None, "output \"h\" has 2 values, expected 1"),
            (json!({ "g": [1, "two"], "h": 1 }), None, "output \"g\" has \"two\" instead of a number"),
            (json!({ "g": [1, [2]], "h": 1 }), None, "output \"g\" has [2] instead of a number"),
            (
                json!({ "g": [1, 2], "h": 1 }),
                Some(json!({ "g": [0, -1] })),
                "the error of output \"g\" is below 0",
            ),
        ] {
            assert_eq!(evaluation(outputs, errors), Err(NoResult::Fault(said.to_owned())));
        }
        // Of one sample only, as a value that is no number.
        for error in ["NaN", "1e200"] {
            let errors = parse(&format!("{{\"h\": {error}}}")).unwrap();
            let found = evaluation(json!({ "g": [1, 2], "h": 1 }), Some(errors));
            let Err(NoResult::Failure(failure)) = found else { panic!("{found:?}") };
            let said = failure.to_string();
            assert_eq!(said, format!("the simulator returned {error} for output h (its error) at cycle 100"));
        }
    }

    #[test]
    fn a_value_that_is_no_number_is_a_failed_simulation() {
        let text = r#"{"g": [1.0, -Infinity], "h": NaN, "note": "NaN is \" no\\"}"#;
        let found = parse(text).unwrap();
        assert_eq!(found["note"], "NaN is \" no\\");
        let failure = |output: &str, cycles, value: &str| {
            let (output, value) = (output.into(), value.into());
            Err(NoResult::Failure(SimulationFailure::NoNumber { output, cycles, value }))
        };
        assert_eq!(evaluation(found, None), failure("g", 200, "-Infinity"));
        assert_eq!(evaluation(parse("{\"g\": [1, 2], \"h\": nan}").unwrap(), None), failure("h", 100, "nan"));
        assert_eq!(evaluation(json!({ "g": [null, 2], "h": 1 }), None), failure("g", 100, "null"));
        assert!(parse("{\"g\": nano}").is_err() && parse("iteration 3").is_err());
    }
}
