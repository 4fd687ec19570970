//! Samples and outcomes as bytes and back, exact to the last bit.

use crate::farm::evaluate::EvaluationResult;
use ring::digest::{SHA256, digest};
use thiserror::Error;

/// Length of the checksum of an outcome [bytes].
const CHECKSUM: usize = 8;

/// Bytes that are no outcome.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum OutcomeFault {
    /// They are not those that were written.
    #[error("its checksum is that of other bytes: the file was damaged")]
    Damaged,
    /// This program cannot decode them: message of the decoder.
    #[error("{0}")]
    Unreadable(String),
}

/// Little-endian f64, one after another.
pub fn sample_to_bytes(sample: &[f64]) -> Vec<u8> {
    sample.iter().flat_map(|value| value.to_le_bytes()).collect()
}

/// The inverse of [`sample_to_bytes`]; `None` if the length is no multiple of eight.
pub fn sample_from_bytes(bytes: &[u8]) -> Option<Vec<f64>> {
    let (values, rest) = bytes.as_chunks::<8>();
    rest.is_empty().then(|| values.iter().map(|value| f64::from_le_bytes(*value)).collect())
}

/// Encodes an outcome as CBOR, followed by the first eight bytes of its SHA-256.
///
/// # Errors
/// Message of the encoder.
pub fn outcome_to_bytes(outcome: &EvaluationResult) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    ciborium::into_writer(outcome, &mut bytes).map_err(|error| error.to_string())?;
    bytes.extend_from_slice(&checksum(&bytes));
    Ok(bytes)
}

fn checksum(bytes: &[u8]) -> [u8; CHECKSUM] {
    let digest = digest(&SHA256, bytes);
    std::array::from_fn(|k| digest.as_ref()[k])
}

/// The inverse of [`outcome_to_bytes`]; files of earlier programs have no checksum.
///
/// # Errors
/// [`OutcomeFault`].
pub fn outcome_from_bytes(bytes: &[u8]) -> Result<EvaluationResult, OutcomeFault> {
    let mut rest = bytes;
    let outcome = ciborium::from_reader(&mut rest);
    let outcome = outcome.map_err(|error| OutcomeFault::Unreadable(error.to_string()))?;
    let (written, sum) = bytes.split_at(bytes.len() - rest.len());
    if sum.is_empty() || sum == checksum(written) { Ok(outcome) } else { Err(OutcomeFault::Damaged) }
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

    /// Whichever bit of an outcome changes, it is not taken for another outcome.
    #[test]
    fn no_changed_bit_of_an_outcome_goes_unnoticed() {
        let outcome = crate::results::store::tests::finished(1).outcome;
        let bytes = outcome_to_bytes(&outcome).unwrap();
        assert_eq!(outcome_from_bytes(&bytes), Ok(outcome));
        for bit in 0..8 * bytes.len() {
            let mut changed = bytes.clone();
            changed[bit / 8] ^= 1 << (bit % 8);
            assert!(outcome_from_bytes(&changed).is_err(), "bit {bit}");
        }
        assert!(outcome_from_bytes(&bytes[..bytes.len() - 1]).is_err());
    }
}
