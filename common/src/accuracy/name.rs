//! Names of accuracies, for command lines, tables and files: a preset, or a preset with knobs turned, such as
//! `draft+step-x0.71` or `jump-4000` (of `balanced`, which need not be said).

use super::{Accuracy, Tier};
use serde::{Deserialize, Serialize};
use std::str::FromStr;
use thiserror::Error;

/// Accuracy with the name it was asked for by.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NamedAccuracy {
    /// Name as typed, e.g. `balanced`, `draft+jump-8000`.
    pub name: String,
    /// What it stands for.
    pub accuracy: Accuracy,
}

impl NamedAccuracy {
    /// Whether it is a preset, without a knob turned.
    pub fn is_preset(&self) -> bool {
        Accuracy::NAMES.contains(&self.name.as_str())
    }
}

impl Default for NamedAccuracy {
    fn default() -> Self {
        NamedAccuracy { name: "balanced".into(), accuracy: Accuracy::balanced() }
    }
}

/// A name that stands for no accuracy.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum AccuracyNameError {
    /// Neither a preset nor a knob.
    #[error("{part:?} is neither a preset (draft, balanced, reference) nor a knob ({KNOBS})")]
    Unknown {
        /// The part between `+` that was not understood.
        part: String,
    },
    /// A preset somewhere else than in front.
    #[error("the preset {part:?} stands in front, knobs after it")]
    Misplaced {
        /// Preset.
        part: String,
    },
    /// A knob turned too far, or to what is no number.
    #[error("{part:?}: allowed for {knob}: {allowed}")]
    Value {
        /// The part.
        part: String,
        /// Knob.
        knob: &'static str,
        /// What is allowed.
        allowed: &'static str,
    },
}

/// The knobs, as messages and helps list them.
pub const KNOBS: &str = "step-xF: time steps longer by the factor F; jump-N: wear steps of at most N cycles; \
                         jump-tolerance-T: fewer where their error asks for it, 0 nowhere; wear-tolerance-T; samples-N: \
                         of a cycle, for the wear; warm-up-W: cycles; dynamic: no quasi-static tier";

impl FromStr for NamedAccuracy {
    type Err = AccuracyNameError;

    /// Reads `PRESET`, `PRESET+KNOB+KNOB...` or `KNOB+KNOB...`; knobs are turned from left to right.
    fn from_str(name: &str) -> Result<Self, AccuracyNameError> {
        let mut accuracy = Accuracy::balanced();
        for (k, part) in name.split('+').enumerate() {
            accuracy = match Accuracy::by_name(part) {
                Some(preset) if k == 0 => preset,
                Some(_) => return Err(AccuracyNameError::Misplaced { part: part.to_owned() }),
                None => turned(accuracy, part)?,
            };
        }
        Ok(NamedAccuracy { name: name.to_owned(), accuracy })
    }
}

/// `accuracy` with one knob turned.
fn turned(accuracy: Accuracy, part: &str) -> Result<Accuracy, AccuracyNameError> {
    if part == "dynamic" {
        return Ok(Accuracy { tier: Tier::Dynamic, ..accuracy });
    }
    // A knob with a longer name first where one begins like another.
    type Turn = fn(Accuracy, f64) -> Accuracy;
    type Knob = (&'static str, &'static str, f64, f64, Turn);
    let knobs: [Knob; 6] = [
        ("step-x", "0.05 to 20", 0.05, 20.0, |a, factor| a.refined(1.0 / factor)),
        ("jump-tolerance-", "0 to 1", 0.0, 1.0, |a, t| Accuracy { jump_tolerance: t, ..a }),
        ("jump-", "whole numbers from 1 to 1000000", 1.0, 1e6, |a, n| Accuracy { cycle_jump: n as u32, ..a }),
        ("wear-tolerance-", "1e-9 to 1", 1e-9, 1.0, |a, t| Accuracy { wear_tolerance: t, ..a }),
        ("samples-", "whole numbers from 20 to 100000", 20.0, 1e5, |a, n| Accuracy {
            wear_samples: n as usize,
            ..a
        }),
        ("warm-up-", "0 to 10", 0.0, 10.0, |a, w| Accuracy { warm_up: w, ..a }),
    ];
    let (value, (knob, allowed, least, most, turn)) = knobs
        .into_iter()
        .find_map(|knob| Some((part.strip_prefix(knob.0)?, knob)))
        .ok_or_else(|| AccuracyNameError::Unknown { part: part.to_owned() })?;
    let whole = allowed.starts_with("whole");
    let number = value
        .parse::<f64>()
        .ok()
        .filter(|x| (least..=most).contains(x) && (!whole || x.fract() == 0.0))
        .ok_or_else(|| AccuracyNameError::Value { part: part.to_owned(), knob, allowed })?;
    Ok(turn(accuracy, number))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(name: &str) -> Accuracy {
        name.parse::<NamedAccuracy>().expect(name).accuracy
    }

    #[test]
    fn names_are_presets_with_knobs_turned() {
        for preset in Accuracy::NAMES {
            assert_eq!(Some(read(preset)), Accuracy::by_name(preset));
        }
        assert_eq!(read("jump-4000"), Accuracy { cycle_jump: 4000, ..Accuracy::balanced() });
        let expected = Accuracy { cycle_jump: 250, ..Accuracy::draft().refined(2.0) };
        assert_eq!(read("draft+step-x0.5+jump-250"), expected);
        let all = read("reference+wear-tolerance-1e-3+samples-300+warm-up-0.2+dynamic");
        assert_eq!((all.wear_tolerance, all.wear_samples, all.warm_up), (1e-3, 300, 0.2));
        assert_eq!((all.tier, all.step_tolerance), (Tier::Dynamic, Accuracy::reference().step_tolerance));
    }

    #[test]
    fn slips_are_named() {
        for (name, said) in [
            ("exact", "\"exact\" is neither"),
            ("", "\"\" is neither"),
            ("draft+", "\"\" is neither"),
            ("jump-100+draft", "\"draft\" stands in front"),
            ("draft+jump-0", "allowed for jump-: whole numbers from 1"),
            ("jump-12.5", "whole numbers"),
            ("step-xnan", "allowed for step-x: 0.05 to 20"),
            ("step-x-1", "0.05 to 20"),
            ("wear-tolerance-inf", "1e-9 to 1"),
        ] {
            let error = name.parse::<NamedAccuracy>().unwrap_err().to_string();
            assert!(error.contains(said), "{name}: {error}");
        }
    }
}
