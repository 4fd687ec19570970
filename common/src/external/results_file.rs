//! Reads the results file of an evaluation: a JSON object as a reply line has it, or plain numbers.
//!
//! Plain numbers are those of the first output at all checkpoints, then those of the next one. They are separated by
//! white space or line breaks; on each line, what follows the last number is a comment, e.g. the name of the value. A file
//! whose first word begins with `fail` states that the sample has no result. These are the conventions of Dakota.

use super::reply::{Expected, NoResult, by_name, object, shown};
use crate::outputs::Evaluation;
use serde_json::{Map, Value};

/// Result stated by the text of a file.
///
/// # Errors
/// [`NoResult`].
pub fn read(expected: &Expected, text: &str) -> Result<Evaluation, NoResult> {
    let text = text.trim_start_matches('\u{feff}').trim();
    if let Some(reply) = object(text)? {
        return of_object(expected, &reply);
    }
    let values = numbers(text)?;
    let needed: usize = expected.lengths().iter().sum();
    if values.len() != needed {
        return Err(format!("it has {} values, expected {needed}: {}", values.len(), expected.sizes()).into());
    }
    expected.evaluation(&expected.by_name(values), None, None)
}

/// Result stated by an object with `outputs` or `failure`.
///
/// # Errors
/// [`NoResult`].
pub fn of_object(expected: &Expected, reply: &Map<String, Value>) -> Result<Evaluation, NoResult> {
    let neither = || "it has neither \"outputs\" nor \"failure\"".to_owned();
    let outputs = by_name(reply, "outputs")?.ok_or_else(neither)?;
    expected.evaluation(outputs, by_name(reply, "errors")?, by_name(reply, "start")?)
}

/// All numbers of a text, as JSON; those that are not finite as strings.
fn numbers(text: &str) -> Result<Vec<Value>, String> {
    let mut values = Vec::new();
    for (k, line) in text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
        let before = values.len();
        values.extend(line.split_whitespace().map_while(number));
        if values.len() == before {
            return Err(format!("line {}: \"{}\" does not begin with a number", k + 1, shown(line.trim())));
        }
    }
    Ok(values)
}

/// A number with an exponent of C (`1e-3`) or Fortran (`1.0D-03`).
fn number(word: &str) -> Option<Value> {
    let value: f64 = word.parse().ok().or_else(|| {
        let plain = word.bytes().all(|byte| byte.is_ascii_digit() || b"+-.dD".contains(&byte));
        plain.then(|| word.replace(['d', 'D'], "e").parse().ok())?
    })?;
    Some(serde_json::Number::from_f64(value).map_or_else(|| Value::from(word), Value::Number))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn expected() -> Expected {
        Expected {
            inputs: vec!["x".into()],
            outputs: vec![("g".into(), false), ("h".into(), true)],
            cycles: vec![100, 200],
        }
    }

    fn histories(text: &str) -> Result<Vec<Vec<f64>>, String> {
        match read(&expected(), text) {
            Ok(evaluation) => Ok(evaluation.histories),
            Err(NoResult::Fault(fault)) => Err(fault),
            Err(NoResult::Failure(failure)) => panic!("{failure}"),
        }
    }

    #[test]
    fn numbers_come_in_the_order_of_the_outputs() {
        let both = Ok(vec![vec![1.5, -2e-3], vec![3.0, 3.0]]);
        for text in [
            "1.5 -2e-3\n3\n",
            "  1.5 deflection at 100\r\n-2.0D-03 200\n\n3.0 h\n",
            "{\"outputs\": {\"g\": [1.5, -2e-3], \"h\": 3}}",
        ] {
            let text = text.replace(" 200", " later").replace(" at 100", "");
            assert_eq!(histories(&text), both, "{text}");
        }
    }

    #[test]
    fn what_is_no_result_is_named() {
        assert_eq!(histories("1 2"), Err("it has 2 values, expected 3: g 2, h 1".into()));
        assert_eq!(histories("1 2\nh = 3"), Err("line 2: \"h = 3\" does not begin with a number".into()));
        assert!(histories("{\"outputs\": ").unwrap_err().contains("is no JSON"));
        assert_eq!(histories(""), Err("it has 0 values, expected 3: g 2, h 1".into()));
        let failed = |text: &str| match read(&expected(), text) {
            Err(NoResult::Failure(failure)) => failure.to_string(),
            other => panic!("{other:?}"),
        };
        assert_eq!(failed("FAIL no\nmesh"), "the simulator reports: FAIL no mesh");
        assert_eq!(failed("{\"failure\": \"no mesh\"}"), "the simulator reports: no mesh");
        assert_eq!(failed("1 nan 3"), "the simulator returned nan for output g at cycle 200");
    }
}
