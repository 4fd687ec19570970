//! The shape that every evaluation of a scene has, and whether one fits it.

use crate::outputs::Evaluation;
use crate::scene::Scene;

/// Largest size of a value or of its stated error [unit of the output]: beyond about 1e154 the square of a double is infinite,
/// and with it variances and surrogates.
pub const LARGEST: f64 = 1e150;

/// Outputs and checkpoints of the evaluations of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct EvaluationShape {
    /// Names of the outputs.
    outputs: Vec<String>,
    /// Checkpoints `(m,)` [cycles].
    checkpoints: Vec<u32>,
}

impl EvaluationShape {
    /// The shape of the evaluations of a scene.
    pub fn of(scene: &Scene) -> Self {
        let outputs = scene.outputs.iter().map(|output| output.name.clone()).collect();
        Self { outputs, checkpoints: scene.life.checkpoints() }
    }

    /// Why an evaluation cannot be one of the scene, in words: other checkpoints or outputs, a value that is no number whose
    /// square is one, a stated error that is none or negative. `None` if it fits. An evaluation that states no errors counts as
    /// exact.
    pub fn misfit(&self, evaluation: &Evaluation) -> Option<String> {
        let checkpoints = &self.checkpoints;
        if evaluation.cycles != *checkpoints {
            let mut pairs = evaluation.cycles.iter().zip(checkpoints);
            return Some(match pairs.find(|(found, expected)| found != expected) {
                Some((found, expected)) => format!("a checkpoint at {found} cycles instead of {expected}"),
                None => format!("{} checkpoints, not {}", evaluation.cycles.len(), checkpoints.len()),
            });
        }
        let values = self.table("", &evaluation.histories, -LARGEST);
        let stated = Some(&evaluation.errors).filter(|errors| !errors.is_empty());
        let errors = || self.table("the stated error of ", stated?, 0.0);
        values.or_else(errors).or_else(|| self.start(&evaluation.start))
    }

    /// The first misfit of values `(outputs, m)`, which must not be below `least`.
    fn table(&self, what: &str, table: &[Vec<f64>], least: f64) -> Option<String> {
        let Self { outputs, checkpoints } = self;
        if table.len() != outputs.len() {
            return Some(format!("{what}{} outputs, not {}", table.len(), outputs.len()));
        }
        let of_output = |(name, values): (&String, &Vec<f64>)| {
            if values.len() != checkpoints.len() {
                return Some(format!("{what}output \"{name}\" has {} values", values.len()));
            }
            let place = values.iter().position(|value| !(least..=LARGEST).contains(value))?;
            let (value, cycles) = (values[place], checkpoints[place]);
            Some(format!(
                "{what}output \"{name}\" is {value:e} at {cycles} cycles, allowed: {least:e} to {LARGEST:e}, whose square is \
                 still a number"
            ))
        };
        outputs.iter().zip(table).find_map(of_output)
    }

    /// The first misfit of values in the first cycle `(outputs,)`.
    fn start(&self, start: &[Option<f64>]) -> Option<String> {
        let known = self.outputs.iter().zip(start).filter_map(|(name, value)| Some((name, (*value)?)));
        let mut unfit = known.filter(|(_, value)| value.is_nan() || value.abs() > LARGEST);
        unfit.next().map(|(name, value)| format!("output \"{name}\" is {value:e} in the first cycle"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shape() -> EvaluationShape {
        EvaluationShape { outputs: vec!["wear".into(), "angle".into()], checkpoints: vec![10, 20] }
    }

    fn fitting() -> Evaluation {
        let errors = vec![vec![0.0, 1e149]; 2];
        Evaluation {
            errors,
            start: vec![None, Some(-1e149)],
            ..Evaluation::from_histories(vec![10, 20], vec![vec![-1e149, 2.0]; 2])
        }
    }

    #[test]
    fn issue_misfits_are_found_before_they_are_recorded() {
        assert_eq!(shape().misfit(&fitting()), None);
        assert_eq!(shape().misfit(&Evaluation { errors: vec![], start: vec![], ..fitting() }), None);
        let histories =
            |values: [f64; 2]| Evaluation { histories: vec![vec![0.0; 2], values.into()], ..fitting() };
        let errors = |values: [f64; 2]| Evaluation { errors: vec![vec![0.0; 2], values.into()], ..fitting() };
        let start = |value: f64| Evaluation { start: vec![Some(value)], ..fitting() };
        for (evaluation, expected) in [
            (Evaluation { cycles: vec![10], ..fitting() }, "1 checkpoints, not 2"),
            (Evaluation { cycles: vec![10, 21], ..fitting() }, "a checkpoint at 21 cycles instead of 20"),
            (Evaluation { cycles: vec![10, 10], ..fitting() }, "a checkpoint at 10 cycles instead of 20"),
            (Evaluation { histories: vec![], ..fitting() }, "0 outputs, not 2"),
            (
                Evaluation { histories: vec![vec![1.0, 2.0], vec![1.0]], ..fitting() },
                "output \"angle\" has 1 values",
            ),
            (Evaluation { errors: vec![vec![0.0; 2]], ..fitting() }, "the stated error of 1 outputs, not 2"),
            (histories([1.0, 1e151]), "output \"angle\" is 1e151 at 20 cycles"),
            (histories([f64::NAN, 1.0]), "output \"angle\" is NaN at 10 cycles"),
            (
                errors([0.0, -1.0]),
                "the stated error of output \"angle\" is -1e0 at 20 cycles, allowed: 0e0 to 1e150",
            ),
            (errors([1e200, 0.0]), "the stated error of output \"angle\" is 1e200 at 10 cycles"),
            (errors([f64::INFINITY, 0.0]), "is inf at 10 cycles"),
            (start(1e200), "output \"wear\" is "),
            (start(f64::NAN), "output \"wear\" is NaN in the first cycle"),
        ] {
            let found = shape().misfit(&evaluation).unwrap_or_default();
            assert!(found.contains(expected), "{found}: {expected}");
        }
    }
}
