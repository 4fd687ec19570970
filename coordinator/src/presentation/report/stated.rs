//! The numerical errors that the evaluations state, over the life and beside the limits: gathered, as a table, and in
//! sentences.

use super::figures::words;
use super::format::{count, escape, percent, three_digits};
use super::input::ReportInput;
use super::life::{governing, numerical_lives};
use super::tables::table;
use common::outputs::Evaluation;

/// Stated errors of one output over all evaluations, at one checkpoint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StatedAt {
    /// Checkpoint [cycles].
    pub cycles: u32,
    /// Median over the evaluations [SI unit of the output].
    pub typical: f64,
    /// Largest of any evaluation [SI unit of the output].
    pub largest: f64,
}

/// Gathers the errors of evaluations one by one.
#[derive(Debug, Default)]
pub struct StatedErrors {
    cycles: Vec<u32>,
    /// By output and checkpoint, one value per evaluation `(outputs)(m)(n)`.
    all: Vec<Vec<Vec<f64>>>,
}

impl StatedErrors {
    /// Takes notice of an evaluation; one that states no errors counts for nothing.
    pub fn add(&mut self, evaluation: &Evaluation) {
        self.cycles.clone_from(&evaluation.cycles);
        self.all.resize_with(evaluation.errors.len().max(self.all.len()), Vec::new);
        for (all, errors) in self.all.iter_mut().zip(&evaluation.errors) {
            all.resize_with(errors.len().max(all.len()), Vec::new);
            all.iter_mut().zip(errors).for_each(|(all, error)| all.push(*error));
        }
    }

    /// Typical and largest errors per output and checkpoint `(outputs)(m,)`.
    pub fn over_life(self) -> Vec<Vec<StatedAt>> {
        let cycles = self.cycles;
        let at = |(cycles, mut errors): (&u32, Vec<f64>)| {
            errors.sort_unstable_by(f64::total_cmp);
            let largest = *errors.last()?;
            Some(StatedAt { cycles: *cycles, typical: errors[errors.len() / 2], largest })
        };
        self.all.into_iter().map(|all| cycles.iter().zip(all).filter_map(at).collect()).collect()
    }
}

/// Lives shown in the table: the end of every sixth of the life, and the governing checkpoint.
const SIXTHS: usize = 6;

/// Typical and largest stated error of every limit state's output over life, in its unit and over its limit; empty
/// where no evaluation states any.
pub fn errors_over_life(input: &ReportInput) -> String {
    let governing = governing(&input.summary).map(|row| row.cycles);
    let rows = input.limit_states.iter().flat_map(|state| {
        let of = input.stated.get(state.output).map_or(&[][..], Vec::as_slice);
        let unit = input.unit_of(state);
        let shown = move |(k, at): &(usize, &StatedAt)| {
            (1..=SIXTHS).any(|sixth| k + 1 == of.len() * sixth / SIXTHS) || Some(at.cycles) == governing
        };
        of.iter().enumerate().filter(shown).map(move |(_, at)| {
            let share = |error: f64| percent((error / state.threshold).abs());
            let value = |error: f64| escape(&unit.after(&three_digits(unit.to_shown(error))));
            vec![
                escape(&words(&input.outputs[state.output].name)),
                count(at.cycles.into()),
                value(at.typical),
                share(at.typical),
                value(at.largest),
                share(at.largest),
            ]
        })
    });
    let rows: Vec<Vec<String>> = rows.collect();
    if rows.is_empty() {
        return String::new();
    }
    let head = ["stated error of", "at cycles", "typical", "of the limit", "largest", "of the limit"];
    table(&head.map(String::from), rows.into_iter())
}

/// What the stated errors are, how large, and what they mean for the lives; empty where none are stated.
pub fn sentences(input: &ReportInput) -> Vec<String> {
    let Some(row) = governing(&input.summary) else { return vec![] };
    let sizes: Vec<String> = input
        .limit_states
        .iter()
        .filter_map(|state| {
            let at = input.stated.get(state.output)?.iter().find(|at| at.cycles == row.cycles)?;
            let share = |error: f64| percent((error / state.threshold).abs());
            let name = words(&input.outputs[state.output].name);
            Some(format!("{name} {}, at most {}", share(at.typical), share(at.largest)))
        })
        .collect();
    if sizes.is_empty() {
        return vec![];
    }
    let mut text = vec![format!(
        "Every simulation states the numerical error of its own values{}; a value is meant to \
         lie within twice of it in 95 % of cases. At {} cycles this is typically, as a share of the limit: {}.",
        if input.summary.of_mechanism() { ", from its time and wear steps" } else { "" },
        count(row.cycles.into()),
        sizes.join("; ")
    )];
    if !input.summary.is_static() {
        text.extend(meaning(input));
    }
    let shares: Vec<String> = input
        .summary
        .surrogates
        .iter()
        .filter_map(|surrogate| Some((surrogate, surrogate.share_of_stated_error?)))
        .map(|(surrogate, share)| format!("{} for {}", percent(share), surrogate.limit_state))
        .collect();
    if !shares.is_empty() {
        text.push(format!(
            "The surrogates take as noise, scatter from one simulation to the next, {} of the stated errors; the rest they \
             cannot tell from the truth.",
            shares.join(" and ")
        ));
    }
    text
}

/// The life that half of the mechanisms reach, under the stated errors.
pub fn meaning(input: &ReportInput) -> Option<String> {
    let [worst, best] = numerical_lives(&input.summary, "total", 0.5)?;
    let last = input.summary.reliability.last()?.cycles;
    let life = |at: Option<f64>| match at {
        Some(life) => count(life.round().max(0.0) as u64),
        None => format!("more than {}", count(last.into())),
    };
    Some(format!(
        "If all simulations erred by their stated errors in the same direction, the worst one, half of the {}s would \
         reach {} cycles, in the best one {}. This is no standard error, and more simulations do not narrow it: a finer \
         accuracy does.",
        input.subject(),
        life(worst),
        life(best)
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::presentation::report::synthetic;

    #[test]
    fn typical_is_the_median_and_largest_the_largest() {
        let mut evaluation = synthetic::input().nominal.unwrap();
        let mut stated = StatedErrors::default();
        for error in [3.0, 1.0, 2.0, 9.0, 1.5] {
            evaluation.errors.iter_mut().for_each(|errors| errors.fill(error));
            evaluation.errors[1][7] = 0.5 * error;
            stated.add(&evaluation);
        }
        evaluation.errors.clear();
        stated.add(&evaluation);
        let over_life = stated.over_life();
        assert_eq!((over_life.len(), over_life[0].len()), (2, 72));
        assert_eq!(over_life[0][3], StatedAt { cycles: 4000, typical: 2.0, largest: 9.0 });
        assert_eq!(over_life[1][7], StatedAt { cycles: 8000, typical: 1.0, largest: 4.5 });
    }

    #[test]
    fn the_sentences_say_share_and_lives() {
        let input = synthetic::input();
        let text = sentences(&input).join(" ").replace('\u{a0}', " ");
        // 0.25 of 30 um, 0.1 of 25 r/min.
        assert!(text.contains("max wear depth 0.8 %, at most 0.8 %"), "{text}");
        assert!(text.contains("angular velocity difference 0.4 %, at most 0.4 %"), "{text}");
        assert!(text.contains("half of the mechanisms would reach 6"), "{text}");
        assert!(text.contains("5.0 % for wear"), "{text}");
        let mut silent = input.clone();
        silent.stated.clear();
        assert!(sentences(&silent).is_empty() && errors_over_life(&silent).is_empty());
    }
}
