//! Samples and outcomes as bytes and back, exact to the last bit.

use crate::farm::evaluate::EvaluationResult;

/// Little-endian f64, one after another.
pub fn sample_to_bytes(sample: &[f64]) -> Vec<u8> {
    sample.iter().flat_map(|value| value.to_le_bytes()).collect()
}

/// The inverse of [`sample_to_bytes`]; `None` if the length is no multiple of eight.
pub fn sample_from_bytes(bytes: &[u8]) -> Option<Vec<f64>> {
    let (values, rest) = bytes.as_chunks::<8>();
    rest.is_empty().then(|| values.iter().map(|value| f64::from_le_bytes(*value)).collect())
}

/// Encodes an outcome as CBOR.
///
/// # Errors
/// Message of the encoder.
pub fn outcome_to_bytes(outcome: &EvaluationResult) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    ciborium::into_writer(outcome, &mut bytes).map_err(|error| error.to_string())?;
    Ok(bytes)
}

/// The inverse of [`outcome_to_bytes`].
///
/// # Errors
/// Message of the decoder.
pub fn outcome_from_bytes(bytes: &[u8]) -> Result<EvaluationResult, String> {
    ciborium::from_reader(bytes).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use ciborium::Value;

    /// Campaigns by earlier versions, without the worn profiles, are still read.
    #[test]
    fn an_outcome_without_its_worn_life_is_read() {
        let entry = |name: &str, value| (Value::Text(name.into()), value);
        let diagnostics = Value::serialized(&common::outputs::Diagnostics::default()).unwrap();
        let evaluation = Value::Map(vec![
            entry("cycles", Value::Array(vec![1000.into()])),
            entry("histories", Value::Array(vec![Value::Array(vec![0.5.into()])])),
            entry("errors", Value::Array(vec![])),
            entry("joints", Value::Array(vec![])),
            entry("first_cycle", Value::Null),
            entry("diagnostics", diagnostics),
        ]);
        let mut bytes = Vec::new();
        ciborium::into_writer(&Value::Map(vec![entry("Ok", evaluation)]), &mut bytes).unwrap();
        let outcome = outcome_from_bytes(&bytes).unwrap().unwrap();
        assert_eq!((outcome.histories, outcome.worn), (vec![vec![0.5]], None));
    }
}
