//! Differences of the histories of one output, at every checkpoint; their form is the one that predicts the pairs left out better, over all
//! checkpoints.

use super::difference::{Difference, DifferenceForm, KrigedDifference, Remainder};

/// Fewest pairs for a line.
const ENOUGH: usize = 5;
/// Mean square of errors at pairs left out over that of a simpler form below which the difference is no noise [1].
const BETTER: f64 = 0.25;

/// Histories of one output at the same point.
#[derive(Debug, Clone, PartialEq)]
pub struct HistoryPair<'a> {
    /// Values of the variables `(d,)`.
    pub point: &'a [f64],
    /// At the first level `(m,)` [unit of the output].
    pub working: Vec<f64>,
    /// At the second level `(m,)`.
    pub finer: Vec<f64>,
    /// At the third level `(m,)`, at few points.
    pub finest: Option<Vec<f64>>,
}

/// Difference of the histories of one output.
#[derive(Debug, Clone)]
pub struct HistoryDifference {
    /// Form at all checkpoints, unless they follow the variables.
    form: DifferenceForm,
    /// To the second level, at each checkpoint `(m,)`.
    differences: Vec<Difference>,
    /// To the second level as a function of the variables, where that predicts better.
    kriged: Option<KrigedDifference>,
    /// What the second level leaves, at each checkpoint `(m,)`.
    pub remainders: Vec<Remainder>,
    /// The difference from the second level to an exact third one.
    to_exact: Option<Box<Self>>,
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
        let gain = |left_out: f64, plain: &Difference| {
            if plain.left_out > 0.0 { left_out / plain.left_out } else { 1.0 }
        };
        let gains = line.iter().zip(&constant).map(|(line, constant)| gain(line.left_out, constant));
        let ratio = gains.sum::<f64>() / m as f64;
        let (form, differences) =
            if ratio < 1.0 { (DifferenceForm::Line, line) } else { (DifferenceForm::Constant, constant) };
        let points: Vec<&[f64]> = pairs.iter().map(|pair| pair.point).collect();
        let of_pair = |p: &HistoryPair<'_>| p.finer.iter().zip(&p.working).map(|(f, w)| f - w).collect();
        let all: Vec<Vec<f64>> = pairs.iter().map(of_pair).collect();
        let kriged = KrigedDifference::fit(&points, &all).filter(|kriged| {
            let gains = kriged.left_out.iter().zip(&differences).map(|(own, plain)| gain(*own, plain));
            gains.sum::<f64>() < BETTER * m as f64
        });
        let remainder = |n: usize| {
            let third = pairs
                .iter()
                .filter_map(|p| Some((p.finer[n] - p.working[n], p.finest.as_ref()?[n] - p.finer[n])));
            let (coarse, fine): (Vec<f64>, Vec<f64>) = third.unzip();
            let known = values(n).iter().map(|(_, difference)| difference).sum::<f64>() / pairs.len() as f64;
            Remainder::new(&coarse, &fine, known)
        };
        Self { form, differences, kriged, remainders: (0..m).map(remainder).collect(), to_exact: None }
    }

    /// The differences to the second level itself, which leaves nothing: where it is no level of accuracy.
    #[must_use]
    pub fn without_remainder(self) -> Self {
        let none = Remainder { mean: 0.0, std: 0.0, of_points: 0.0, order: None };
        Self { remainders: vec![none; self.remainders.len()], ..self }
    }

    /// The differences to the last level, which is exact.
    pub fn to_exact(pairs: &[HistoryPair<'_>]) -> Self {
        let mut last = Vec::new();
        for HistoryPair { point, finer: working, finest, .. } in pairs {
            let further = |finer| HistoryPair { point, working: working.clone(), finer, finest: None };
            last.extend(finest.clone().map(further));
        }
        let to_exact = (!last.is_empty()).then(|| Box::new(Self::new(&last).without_remainder()));
        Self { to_exact, ..Self::new(pairs).without_remainder() }
    }

    /// The form in a word.
    pub fn form(&self) -> &'static str {
        match self.form {
            _ if self.kriged.is_some() => "kriging",
            DifferenceForm::Constant => "constant",
            DifferenceForm::Line => "line",
        }
    }

    /// What is added to a value of the first level at checkpoint `n` and at values of the variables `(d,)` [unit of the output].
    pub fn at(&self, n: usize, value: f64, point: &[f64]) -> f64 {
        let difference = match &self.kriged {
            Some(kriged) => kriged.at(n, point),
            None => self.differences[n].at(value),
        };
        let further = self.to_exact.as_ref().map_or(0.0, |further| further.at(n, value + difference, point));
        difference + self.remainders[n].mean + further
    }

    /// Standard deviation of its error, common to all points [unit of the output].
    pub fn std_at(&self, n: usize, value: f64) -> f64 {
        let further = self.to_exact.as_ref().map_or(0.0, |further| further.std_at(n, value));
        self.std_of_pairs(n, value).hypot(self.remainders[n].std).hypot(further)
    }

    /// The part of it that more points at the third level reduce [unit of the output].
    pub fn std_of_thirds(&self, n: usize, value: f64) -> f64 {
        self.to_exact.as_ref().map_or(self.remainders[n].of_points, |further| further.std_at(n, value))
    }

    /// The part of it that more pairs reduce [unit of the output].
    pub fn std_of_pairs(&self, n: usize, value: f64) -> f64 {
        let kriged = self.kriged.as_ref().map(|kriged| kriged.left_out[n].sqrt());
        kriged.unwrap_or_else(|| self.differences[n].std_at(value))
    }

    /// Spread of the pairs around the difference at checkpoint `n`, which acts as noise [unit of the output]; where the difference follows
    /// the variables, all of it is in its error.
    pub fn rough(&self, n: usize) -> f64 {
        let own = if self.kriged.is_some() { 0.0 } else { self.differences[n].rough };
        self.to_exact.as_ref().map_or(own, |further| own.hypot(further.rough(n)))
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
            let pair = |(working, finer): (&[f64; 2], &[f64; 2])| HistoryPair {
                point: &[0.0],
                working: working.to_vec(),
                finer: finer.to_vec(),
                finest: None,
            };
            HistoryDifference::new(&working.iter().zip(finer).map(pair).collect::<Vec<_>>())
        };
        let line = difference(&scaled);
        assert_eq!(line.form, DifferenceForm::Line);
        assert!((line.at(1, 100.0, &[0.0]) - 11.0).abs() < 1e-12);
        // A third of the mean difference to the second level, 1.35, without a third one.
        assert!((line.std_at(0, 3.0) - 0.45).abs() < 1e-12);
        let constant = difference(&shifted);
        assert_eq!(constant.form, DifferenceForm::Constant);
        assert!((constant.at(0, 5.0, &[0.0]) - 1.0).abs() < 1e-14 && constant.rough(1) > 0.1);
    }

    #[test]
    fn a_difference_that_follows_the_variables_is_followed() {
        // The third variable never varies.
        let points: Vec<[f64; 3]> =
            (1..=16).map(f64::from).map(|i| [(1.3 * i).sin(), (2.1 * i).sin(), 4.0]).collect();
        let wave = |x: &[f64]| 0.5 * (2.0 * x[0] + x[1]).sin();
        let working: Vec<[f64; 2]> = points.iter().map(|x| [x[1], 2.0 * x[1]]).collect();
        let finer: Vec<[f64; 2]> = points.iter().zip(&working).map(|(x, y)| y.map(|y| y + wave(x))).collect();
        let pair = |i: usize| HistoryPair {
            point: &points[i],
            working: working[i].to_vec(),
            finer: finer[i].to_vec(),
            finest: None,
        };
        let pairs: Vec<HistoryPair<'_>> = (0..points.len()).map(pair).collect();
        let found = HistoryDifference::new(&pairs).without_remainder();
        let at = [0.3, -0.4, 4.0];
        let (error, stated) = (found.at(1, -0.8, &at) - wave(&at), found.std_at(1, -0.8));
        assert_eq!((found.form(), found.rough(1)), ("kriging", 0.0));
        assert!(error.abs() < 2.0 * stated && stated < 0.05, "{error} {stated}");
        // An exact third level, at most of the points, off by another wave.
        let exact: Vec<[f64; 2]> =
            points.iter().zip(&finer).map(|(x, y)| y.map(|y| y + 0.2 * (x[0] - x[1]).cos())).collect();
        let mut all = pairs.clone();
        all.iter_mut().zip(&exact).take(12).for_each(|(pair, exact)| pair.finest = Some(exact.to_vec()));
        let found = HistoryDifference::to_exact(&all);
        let wanted = wave(&at) + 0.2 * (at[0] - at[1]).cos();
        let (error, stated) = (found.at(1, -0.8, &at) - wanted, found.std_at(1, -0.8));
        assert!(
            error.abs() < 2.0 * stated && stated < 0.06 && found.std_of_thirds(1, -0.8) > 0.0,
            "{error} {stated}"
        );
        // As many pairs as variables do not tell a function from noise.
        assert_ne!(HistoryDifference::new(&pairs[..5]).form(), "kriging");
    }
}
