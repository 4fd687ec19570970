//! Differences of the histories of one output, at every checkpoint; their form is the one that predicts the pairs left out better, over all
//! checkpoints.

use super::difference::{Difference, DifferenceForm};
use super::remainder::Remainder;

/// Fewest pairs for a line.
const ENOUGH: usize = 5;

/// Histories of one output at the same point.
#[derive(Debug, Clone, PartialEq)]
pub struct HistoryPair<'a> {
    /// At the first level `(m,)` [unit of the output].
    pub working: &'a [f64],
    /// At the second level `(m,)`.
    pub finer: &'a [f64],
    /// At the third level `(m,)`, at few points.
    pub finest: Option<&'a [f64]>,
}

/// Difference of the histories of one output.
#[derive(Debug, Clone, PartialEq)]
pub struct HistoryDifference {
    /// Form at all checkpoints.
    pub form: DifferenceForm,
    /// To the second level, at each checkpoint `(m,)`.
    pub differences: Vec<Difference>,
    /// What the second level leaves, at each checkpoint `(m,)`.
    pub remainders: Vec<Remainder>,
}

impl HistoryDifference {
    /// The differences by at least one pair.
    pub fn new(pairs: &[HistoryPair<'_>]) -> Self {
        let m = pairs[0].working.len();
        let values =
            |n: usize| pairs.iter().map(|p| (p.working[n], p.finer[n] - p.working[n])).collect::<Vec<_>>();
        let fit = |form: DifferenceForm| -> Vec<Difference> {
            (0..m).map(|n| Difference::fit(&values(n), form)).collect()
        };
        let constant = fit(DifferenceForm::Constant);
        let line = if pairs.len() >= ENOUGH { fit(DifferenceForm::Line) } else { constant.clone() };
        let gain = |(line, constant): (&Difference, &Difference)| {
            if constant.left_out > 0.0 { line.left_out / constant.left_out } else { 1.0 }
        };
        let ratio = line.iter().zip(&constant).map(gain).sum::<f64>() / m as f64;
        let (form, differences) =
            if ratio < 1.0 { (DifferenceForm::Line, line) } else { (DifferenceForm::Constant, constant) };
        let remainder = |n: usize| {
            let third =
                pairs.iter().filter_map(|p| Some((p.finer[n] - p.working[n], p.finest?[n] - p.finer[n])));
            let (coarse, fine): (Vec<f64>, Vec<f64>) = third.unzip();
            let known = values(n).iter().map(|(_, difference)| difference).sum::<f64>() / pairs.len() as f64;
            Remainder::new(&coarse, &fine, known)
        };
        Self { form, differences, remainders: (0..m).map(remainder).collect() }
    }

    /// The differences to the second level itself, which leaves nothing: where it is no level of accuracy.
    #[must_use]
    pub fn without_remainder(self) -> Self {
        let none = Remainder { mean: 0.0, std: 0.0, of_points: 0.0, order: None };
        Self { remainders: vec![none; self.remainders.len()], ..self }
    }

    /// What is added to a value of the first level at checkpoint `n` [unit of the output].
    pub fn at(&self, n: usize, value: f64) -> f64 {
        self.differences[n].at(value) + self.remainders[n].mean
    }

    /// Standard deviation of its error, common to all points [unit of the output].
    pub fn std_at(&self, n: usize, value: f64) -> f64 {
        self.differences[n].std_at(value).hypot(self.remainders[n].std)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_form_is_chosen_for_all_checkpoints() {
        let working: Vec<[f64; 2]> = (0..8).map(|i| [f64::from(i), 10.0 * f64::from(i)]).collect();
        let scaled: Vec<[f64; 2]> = working.iter().map(|y| y.map(|y| 1.1 * y + 1.0)).collect();
        let shifted: Vec<[f64; 2]> = working
            .iter()
            .enumerate()
            .map(|(i, y)| y.map(|y| y + if i % 2 == 0 { 0.9 } else { 1.1 }))
            .collect();
        let difference = |finer: &[[f64; 2]]| {
            let pair = |(working, finer)| HistoryPair { working, finer, finest: None };
            let slices = working.iter().zip(finer).map(|(a, b)| (&a[..], &b[..]));
            HistoryDifference::new(&slices.map(pair).collect::<Vec<_>>())
        };
        let line = difference(&scaled);
        assert_eq!(line.form, DifferenceForm::Line);
        assert!((line.at(1, 100.0) - 11.0).abs() < 1e-12);
        // A third of the mean difference to the second level, 1.35, without a third one.
        assert!((line.std_at(0, 3.0) - 0.45).abs() < 1e-12);
        let constant = difference(&shifted);
        assert_eq!(constant.form, DifferenceForm::Constant);
        assert!((constant.at(0, 5.0) - 1.0).abs() < 1e-14 && constant.differences[1].rough > 0.1);
    }
}
