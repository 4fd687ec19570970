//! Names of accuracies, for command lines, tables and files: a preset, or a preset with changed settings (knobs) such as
//! `draft+step-x0.71` or `jump-4000` (short for `balanced+jump-4000`).
//!
//! Check of the levels of accuracy of a study: one to three, each finer than the one before.

use super::{Accuracy, MOST_POINTS, Tier};
use serde::{Deserialize, Serialize};
use std::str::FromStr;
use thiserror::Error;

/// An accuracy with its name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NamedAccuracy {
    /// Name as written by the user, e.g. `balanced`, `draft+jump-8000`.
    pub name: String,
    /// Settings that the name stands for.
    pub accuracy: Accuracy,
}

impl NamedAccuracy {
    /// True for a preset without knobs.
    pub fn is_preset(&self) -> bool {
        Accuracy::NAMES.contains(&self.name.as_str())
    }

    /// The next finer level, [`Accuracy::halved`]. `None` where a setting has come to the end of its range.
    pub fn finer(&self) -> Option<Self> {
        let times =
            self.name.rsplit_once("+halved-").and_then(|(name, n)| Some((name, n.parse::<u32>().ok()?)));
        let (name, n) = times.unwrap_or((&self.name, 0));
        format!("{name}+halved-{}", n + 1).parse().ok()
    }
}

impl Default for NamedAccuracy {
    fn default() -> Self {
        NamedAccuracy { name: "balanced".into(), accuracy: Accuracy::balanced() }
    }
}

/// Reason why a name is not an accuracy.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum AccuracyNameError {
    /// Neither a preset nor a knob. Holds the unknown part between two `+`.
    #[error("{0:?} is neither a preset (draft, balanced, reference) nor a change of one{near} ({KNOBS})", near = nearest_preset(.0))]
    Unknown(String),
    /// A preset that is not the first part. Holds the name of the preset.
    #[error("the preset {0:?} comes first, changes of it after it")]
    Misplaced(String),
    /// The value of a knob is out of range or not a number. Holds the part of the name with knob and value, the name of the knob, and
    /// the values that are allowed, in words.
    #[error("{0:?}: allowed for {1}: {2}")]
    Value(String, &'static str, &'static str),
    /// The knobs together lead a setting out of its range. Holds the whole name and the name of the setting.
    #[error("{0:?}: the changes together lead {1} out of its range")]
    Together(String, &'static str),
}

/// The preset that was meant, for a message.
fn nearest_preset(part: &str) -> String {
    let near = Accuracy::NAMES.iter().find(|preset| strsim::damerau_levenshtein(part, preset) <= 2);
    near.map_or_else(String::new, |preset| format!(", did you mean {preset:?}?"))
}

/// List of the knobs for messages and help texts.
pub const KNOBS: &str = "step-xF: time steps longer by the factor F; jump-N: wear steps of at most N cycles; \
                         wear-tolerance-T; halved-N: N times half of every length, twice the samples and points; samples-N: of a cycle, for the wear; warm-up-W: cycles; steps-N: most \
                         time steps of a cycle; points-xN: N times the control points; dynamic: no quasi-static tier and no longer time steps where they make no difference";

impl FromStr for NamedAccuracy {
    type Err = AccuracyNameError;

    /// Reads `PRESET`, `PRESET+KNOB+KNOB...` or `KNOB+KNOB...`; knobs are set from left to right.
    fn from_str(name: &str) -> Result<Self, AccuracyNameError> {
        let mut accuracy = Accuracy::balanced();
        for (k, part) in name.split('+').enumerate() {
            accuracy = match Accuracy::by_name(part) {
                Some(preset) if k == 0 => preset,
                Some(_) => return Err(AccuracyNameError::Misplaced(part.to_owned())),
                None => with_knob(accuracy, part)?,
            };
        }
        if let Some(setting) = accuracy.out_of_range() {
            return Err(AccuracyNameError::Together(name.to_owned(), setting));
        }
        Ok(NamedAccuracy { name: name.to_owned(), accuracy })
    }
}

/// `accuracy` with one knob set.
fn with_knob(mut accuracy: Accuracy, part: &str) -> Result<Accuracy, AccuracyNameError> {
    if part == "dynamic" {
        return Ok(Accuracy { tier: Tier::Dynamic, ..accuracy });
    }
    type Knob = (&'static str, &'static str, f64, f64, fn(&mut Accuracy, f64));
    let knobs: [Knob; 8] = [
        ("step-x", "0.05 to 20", 0.05, 20.0, |a, factor| *a = a.refined(1.0 / factor)),
        ("points-x", "whole numbers from 1 to 64", 1.0, f64::from(MOST_POINTS), |a, n| {
            a.points = a.points.saturating_mul(n as u32);
        }),
        ("halved-", "whole numbers from 1 to 6", 1.0, 6.0, |a, n| {
            (0..n as u32).for_each(|_| *a = a.halved())
        }),
        ("jump-", "whole numbers from 1 to 1000000", 1.0, 1e6, |a, n| a.cycle_jump = n as u32),
        ("wear-tolerance-", "1e-9 to 1", 1e-9, 1.0, |a, t| a.wear_tolerance = t),
        ("samples-", "whole numbers from 20 to 100000", 20.0, 1e5, |a, n| a.wear_samples = n as usize),
        ("warm-up-", "0 to 10", 0.0, 10.0, |a, w| a.warm_up = w),
        ("steps-", "whole numbers from 1000 to 100000000", 1e3, 1e8, |a, n| a.steps_bound = n as u64),
    ];
    let (value, (knob, allowed, least, most, turn)) = knobs
        .into_iter()
        .find_map(|knob| Some((part.strip_prefix(knob.0).filter(|value| !names_another_knob(value))?, knob)))
        .ok_or_else(|| AccuracyNameError::Unknown(part.to_owned()))?;
    let whole = allowed.starts_with("whole");
    let number = value
        .parse::<f64>()
        .ok()
        .filter(|x| (least..=most).contains(x) && (!whole || x.fract() == 0.0))
        .ok_or_else(|| AccuracyNameError::Value(part.to_owned(), knob, allowed))?;
    turn(&mut accuracy, number);
    Ok(accuracy)
}

/// True if what follows the name of a knob goes on as a longer name: `jump-` is not the knob of `jump-steps-3`.
fn names_another_knob(value: &str) -> bool {
    value.starts_with(|c: char| c.is_ascii_alphabetic()) && value.contains('-')
}

/// Most levels of a study: the working accuracy, a finer one, and a third for the observed order of convergence.
pub const MOST_LEVELS: usize = 3;

/// Reason why accuracies are no levels of a study.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum LevelsError {
    /// None, or too many. Holds the number of levels.
    #[error("{0} levels; allowed: one to {MOST_LEVELS}")]
    Count(usize),
    /// A level that is not finer than the one before. Holds its name and that of the level before.
    #[error(
        "level {0:?} is not finer than {1:?}: levels go from the coarsest to the finest, and no setting may become coarser"
    )]
    Order(String, String),
}

impl LevelsError {
    /// The first reason why `levels` are none.
    pub fn of(levels: &[NamedAccuracy]) -> Option<Self> {
        if !(1..=MOST_LEVELS).contains(&levels.len()) {
            return Some(Self::Count(levels.len()));
        }
        let wrong = levels.windows(2).find(|pair| !is_finer(&pair[1].accuracy, &pair[0].accuracy))?;
        Some(Self::Order(wrong[1].name.clone(), wrong[0].name.clone()))
    }
}

/// True if steps, blocks, samples and control points of `a` are at least as fine as those of `b`, and one of them is finer.
fn is_finer(a: &Accuracy, b: &Accuracy) -> bool {
    let numbers = |a: &Accuracy| {
        [
            a.step_tolerance.recip(),
            a.largest_step.recip(),
            f64::from(a.cycle_jump).recip(),
            a.wear_tolerance.recip(),
            a.wear_samples as f64,
            f64::from(a.points),
        ]
    };
    let pairs = || numbers(a).into_iter().zip(numbers(b));
    pairs().all(|(a, b)| a >= b) && pairs().any(|(a, b)| a > b)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(name: &str) -> Accuracy {
        name.parse::<NamedAccuracy>().expect(name).accuracy
    }

    #[test]
    fn names_are_presets_with_knobs() {
        for preset in Accuracy::NAMES {
            assert_eq!(Some(read(preset)), Accuracy::by_name(preset));
        }
        assert_eq!(read("jump-4000"), Accuracy { cycle_jump: 4000, ..Accuracy::balanced() });
        let expected = Accuracy { cycle_jump: 250, ..Accuracy::draft().refined(2.0) };
        assert_eq!(read("draft+step-x0.5+jump-250"), expected);
        let all = read("reference+wear-tolerance-1e-3+samples-300+warm-up-0.2+dynamic");
        assert_eq!((all.wear_tolerance, all.wear_samples, all.warm_up), (1e-3, 300, 0.2));
        assert_eq!(read("steps-5000000"), Accuracy { steps_bound: 5_000_000, ..Accuracy::balanced() });
        assert_eq!((all.tier, all.step_tolerance), (Tier::Dynamic, Accuracy::reference().step_tolerance));
    }

    #[test]
    fn a_finer_level_is_named_by_its_changes() {
        let level: NamedAccuracy = "draft+points-x3".parse().unwrap();
        let finer = level.finer().unwrap();
        let expected = Accuracy {
            cycle_jump: 4000,
            wear_samples: 300,
            wear_tolerance: 1e-2,
            points: 6,
            ..level.accuracy.refined(2.0)
        };
        assert_eq!((finer.accuracy, read(&finer.name)), (expected, expected));
        let finest = finer.finer().unwrap();
        assert_eq!(finest.name, "draft+points-x3+halved-2");
        assert_eq!((finest.accuracy, finest.accuracy.points), (expected.halved(), 12));
        assert!(NamedAccuracy::from_str("points-x64").unwrap().finer().is_none());
    }

    #[test]
    fn errors_name_the_part_of_the_name() {
        for (name, said) in [
            ("exact", "\"exact\" is neither"),
            ("", "\"\" is neither"),
            ("draft+", "\"\" is neither"),
            ("jump-100+draft", "\"draft\" comes first"),
            ("draft+jump-0", "allowed for jump-: whole numbers from 1"),
            ("jump-12.5", "whole numbers"),
            ("jump-tolerance-3e-3", "\"jump-tolerance-3e-3\" is neither"),
            ("step-xnan", "allowed for step-x: 0.05 to 20"),
            ("step-x-1", "0.05 to 20"),
            ("steps-10", "allowed for steps-: whole numbers from 1000"),
            ("wear-tolerance-inf", "1e-9 to 1"),
            ("points-x0", "whole numbers from 1 to 64"),
            ("points-x64+points-x2", "lead points out of its range"),
            ("draft+step-x20+step-x20+step-x20", "lead step_tolerance out of its range"),
        ] {
            let error = name.parse::<NamedAccuracy>().unwrap_err().to_string();
            assert!(error.contains(said), "{name}: {error}");
        }
    }

    fn fault(names: &[&str]) -> Option<String> {
        let levels: Vec<NamedAccuracy> = names.iter().map(|name| name.parse().expect(name)).collect();
        LevelsError::of(&levels).map(|error| error.to_string())
    }

    #[test]
    fn levels_become_finer() {
        assert_eq!(fault(&["draft", "balanced+jump-2000", "reference"]), None);
        assert_eq!(fault(&["balanced", "balanced+points-x2"]), None);
        assert_eq!(fault(&["draft"]), None);
        assert!(
            fault(&["reference", "draft"]).unwrap().contains("\"draft\" is not finer than \"reference\"")
        );
        assert!(fault(&["draft", "draft"]).is_some() && fault(&["draft+points-x2", "balanced"]).is_some());
        assert_eq!(fault(&[]).unwrap(), "0 levels; allowed: one to 3");
    }
}
