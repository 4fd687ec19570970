//! One mechanism against the limits of its scene: value at the end of life, limit, margin and expected life, per limit state.

use crate::presentation::format::{count, joined, whole, with_unit};
use common::outputs::Evaluation;
use common::scene::{LimitState, OutputUnit, Scene};
use serde_json::{Value, json};

/// When one mechanism reaches a limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Reached {
    /// In its first cycle, unworn.
    FromTheStart,
    /// After this many cycles, by a straight line between two checkpoints.
    After(f64),
    /// Not within the life studied; if the output grows, after this many cycles at the rate of the last interval.
    Beyond(Option<f64>),
}

impl Reached {
    /// Expected life within the life studied [cycles].
    pub fn life(self) -> Option<f64> {
        match self {
            Self::FromTheStart => Some(0.0),
            Self::After(cycles) => Some(cycles),
            Self::Beyond(_) => None,
        }
    }

    /// Cycles to the limit; infinite if nothing leads to it.
    pub fn expected(self) -> f64 {
        match self {
            Self::Beyond(cycles) => cycles.unwrap_or(f64::INFINITY),
            within => within.life().unwrap_or(0.0),
        }
    }
}

/// A limit state of one mechanism.
#[derive(Debug, Clone, PartialEq)]
pub struct NominalLife<'s> {
    /// The limit state.
    pub limit: &'s LimitState,
    /// Unit of its output.
    pub unit: OutputUnit,
    /// Value in the first cycle, unworn [SI], if it is known.
    pub unworn: Option<f64>,
    /// Value at the first checkpoint [SI].
    pub first: f64,
    /// Largest value over the checkpoints [SI]: failure is absorbing.
    pub largest: f64,
    /// Value at the last checkpoint [SI].
    pub last: f64,
    /// When the limit is reached.
    pub reached: Reached,
    /// Stated numerical errors of the values at the first and at the last checkpoint [SI]; zero if none is stated.
    pub errors: [f64; 2],
}

/// The limit states of a mechanism whose values are those of `evaluation`.
pub fn nominal_lives<'s>(scene: &'s Scene, evaluation: &Evaluation) -> Vec<NominalLife<'s>> {
    let life = |limit: &'s LimitState| {
        let history = &evaluation.histories[limit.output];
        let unworn = evaluation.start.get(limit.output).copied().flatten();
        let errors = evaluation.errors.get(limit.output).map_or(&[][..], Vec::as_slice);
        NominalLife {
            errors: [errors.first(), errors.last()].map(|error| error.copied().unwrap_or(0.0)),
            limit,
            unit: scene.unit_of(&scene.outputs[limit.output]),
            unworn,
            first: history[0],
            largest: history.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            last: history[history.len() - 1],
            reached: reached(
                &evaluation.cycles,
                &history.iter().map(|value| limit.response(*value)).collect::<Vec<_>>(),
                unworn.map(|value| limit.response(value)),
                limit.response_threshold(),
            ),
        }
    };
    scene.limit_states.iter().map(life).collect()
}

/// When the history `(m,)` of a response at checkpoints `(m,)` [cycles], which begins at `unworn`, first reaches its threshold.
fn reached(cycles: &[u32], history: &[f64], unworn: Option<f64>, threshold: f64) -> Reached {
    if unworn.is_some_and(|unworn| unworn >= threshold) {
        return Reached::FromTheStart;
    }
    // Without a value of the unworn mechanism the first interval has no line.
    let start = unworn.map(|unworn| (0.0, unworn));
    let points: Vec<(f64, f64)> =
        start.into_iter().chain(cycles.iter().map(|n| f64::from(*n)).zip(history.iter().copied())).collect();
    let crossing =
        |[(from, low), (to, high)]: [(f64, f64); 2]| from + (to - from) * (threshold - low) / (high - low);
    match (points.iter().position(|(_, value)| *value >= threshold), points.as_slice()) {
        (Some(0), _) => Reached::After(points[0].0),
        (Some(k), _) => Reached::After(crossing([points[k - 1], points[k]])),
        (None, [.., before, last]) if last.1 > before.1 => Reached::Beyond(Some(crossing([*before, *last]))),
        (None, _) => Reached::Beyond(None),
    }
}

impl NominalLife<'_> {
    /// A value of the output with its unit, to three digits.
    pub fn shown(&self, value: f64) -> String {
        with_unit(&self.unit, value).replace('\u{a0}', " ")
    }

    /// The threshold with its unit, or both, e.g. `20 N to 90 N`.
    pub fn thresholds(&self) -> String {
        joined(self.limit.thresholds().into_iter().map(|value| self.shown(value)), " to ")
    }

    /// Distance of the last value from failure over the size of the threshold, or over half the distance between two [1]; negative
    /// beyond.
    pub fn margin(&self) -> f64 {
        let (threshold, response) = (self.limit.response_threshold(), self.limit.response(self.last));
        (threshold - response) / self.limit.scale()
    }

    /// The margin in per cent; `None` for a threshold of zero, of which it is no share.
    pub fn margin_in_words(&self) -> Option<String> {
        Some(self.margin())
            .filter(|margin| margin.is_finite())
            .map(|margin| format!("{:.0} %", 100.0 * margin))
    }

    /// What is to be added to a statement about the limit from a `value` with this stated `error` [SI]: nothing if the error is smaller than the
    /// distance from the threshold, or none is stated.
    pub fn doubt(&self, value: f64, error: f64) -> String {
        if error <= 0.0 || error < (self.limit.response(value) - self.limit.response_threshold()).abs() {
            return String::new();
        }
        format!(
            "; its numerical error of {} leaves that open: choose another accuracy with --accuracy",
            self.shown(error)
        )
    }

    /// The line about this limit state, e.g. `wear: 10.0 µm after 8 000 cycles, limit 8.00 µm, margin -25 %; reached after about 5 930
    /// cycles`.
    pub fn line(&self, cycles: u32) -> String {
        let margin = self.margin_in_words().map_or(String::new(), |margin| format!(", margin {margin}"));
        let name = &self.limit.name;
        let when = match self.reached {
            Reached::FromTheStart => "reached in the first cycle, unworn".to_owned(),
            Reached::After(life) => format!("reached after about {} cycles", whole(life)),
            Reached::Beyond(Some(life)) if life < 1e9 => {
                format!("not reached; at the last rate after about {} cycles", whole(life))
            }
            Reached::Beyond(_) => "not reached".to_owned(),
        };
        let (value, limit) = (self.shown(self.last), self.thresholds());
        let (cycles, doubt) = (count(cycles.into()), self.doubt(self.last, self.errors[1]));
        format!("{name}: {value} after {cycles} cycles, limit {limit}{margin}; {when}{doubt}\n")
            .replace('\u{a0}', " ")
    }

    /// This limit state as JSON, values in SI units: the `threshold`, the upper one of two with the `lower` one beside it; the expected
    /// `life` [cycles] is null beyond the life studied.
    pub fn to_json(&self) -> Value {
        let mut found = json!({ "limit_state": self.limit.name, "threshold": self.limit.threshold,
                                "value_at_end": self.last, "life": self.reached.life() });
        if self.limit.middle().is_some() {
            found["lower"] = self.limit.thresholds()[0].into();
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::scene::{Fails, SceneSource};

    #[test]
    fn a_limit_is_reached_between_checkpoints_or_later_or_never() {
        let cycles = [100, 200, 300];
        let at = |history: &[f64; 3], unworn, threshold| reached(&cycles, history, unworn, threshold);
        assert_eq!(at(&[1.0, 2.0, 4.0], Some(0.0), 3.0), Reached::After(250.0));
        assert_eq!(at(&[1.0, 2.0, 4.0], Some(0.0), 0.5), Reached::After(50.0));
        assert_eq!(at(&[1.0, 2.0, 4.0], None, 0.5), Reached::After(100.0));
        assert_eq!(at(&[1.0, 2.0, 4.0], Some(3.0), 3.0), Reached::FromTheStart);
        assert_eq!(at(&[1.0, 2.0, 4.0], Some(0.0), 6.0), Reached::Beyond(Some(400.0)));
        // Failure is absorbing, and what falls is not reached later.
        assert_eq!(at(&[1.0, 5.0, 2.0], Some(0.0), 3.0), Reached::After(150.0));
        assert_eq!(at(&[1.0, 2.0, 1.0], Some(0.0), 3.0), Reached::Beyond(None));
    }

    #[test]
    fn the_line_has_value_limit_margin_and_life() {
        let scene = SceneSource::builtin("four-bar").expect("built in").nominal().clone();
        let depths = (1..=8).map(|k| 1.25e-6 * f64::from(k)).collect();
        let mut evaluation =
            Evaluation::from_histories((1..=8).map(|k| 1000 * k).collect(), vec![depths, vec![40.0; 8]]);
        evaluation.start = vec![Some(0.0), None];
        let lives = nominal_lives(&scene, &evaluation);
        assert_eq!(
            lives[0].line(8000),
            "wear: 10.0 µm after 8 000 cycles, limit 8.00 µm, margin -25 %; reached after about 6 400 cycles\n"
        );
        let mut two = scene.clone();
        two.limit_states[0].fails = Fails::Outside { lower: 2e-6 };
        two.limit_states.push(LimitState {
            name: "force".into(),
            output: 1,
            threshold: 50.0,
            fails: Fails::Below,
        });
        evaluation.start = vec![Some(5e-6), Some(60.0)];
        evaluation.histories[1] = (0..8).map(|k| 56.0 - 4.0 * f64::from(k)).collect();
        let lives = nominal_lives(&two, &evaluation);
        // The depth begins at the middle; the response falls below at the first checkpoint: 3.75 um of 3 um, after 800 cycles.
        assert_eq!(lives[0].reached, Reached::After(800.0), "{lives:?}");
        assert!(
            lives[0].line(8000).contains("limit 2.00 µm to 8.00 µm, margin -67 %"),
            "{}",
            lives[0].line(8000)
        );
        assert_eq!(lives[1].reached, Reached::After(2500.0));
        // 50 rad/s.
        assert!(lives[1].line(8000).contains("limit 477 r/min"), "{}", lives[1].line(8000));
        let mut zero = two.clone();
        zero.limit_states[1].threshold = 0.0;
        assert!(nominal_lives(&zero, &evaluation)[1].line(8000).contains("limit 0 r/min; "), "no margin");
        let printed = lives[0].to_json();
        assert!((printed["lower"].as_f64().unwrap() - 2e-6).abs() < 1e-18);
        evaluation.start = vec![Some(0.0), None];
        let lives = nominal_lives(&scene, &evaluation);
        let printed = lives[0].to_json();
        assert_eq!(printed["limit_state"], "wear");
        assert!((printed["life"].as_f64().unwrap() - 6400.0).abs() < 1e-6, "{printed}");
    }

    #[test]
    fn an_error_beyond_the_distance_from_the_limit_leaves_the_verdict_open() {
        let scene = SceneSource::builtin("four-bar").expect("built in").nominal().clone();
        let line = |error| {
            let mut evaluation =
                Evaluation::from_histories(vec![1000, 2000], vec![vec![1e-6, 7e-6], vec![0.0; 2]]);
            evaluation.errors = vec![vec![0.0, error], vec![0.0; 2]];
            nominal_lives(&scene, &evaluation)[0].line(2000)
        };
        // 7 um of the 8 um allowed.
        assert!(line(2e-6).ends_with(
            "; its numerical error of 2.00 µm leaves that open: choose another accuracy with --accuracy\n"
        ));
        assert!(!line(5e-7).contains("open"));
    }
}
