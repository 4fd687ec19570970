//! Results of the response of one limit state, as its surrogate learns them.

use super::Plan;
use super::observations::{Observations, Sides};
use crate::statistics::learning::{LearnedThreshold, Mode, is_on_grid, learned_threshold};
use crate::statistics::surrogate::{
    Chosen, Effort, Kriging, NoiseShape, ResponseScale, SurrogateError, TrainingSet, fit_surrogate,
};
use faer::{Mat, MatRef};

/// Results of the response of one limit state, in the scale in which they are learned.
#[derive(Clone)]
pub(super) struct ModeResults<'a> {
    /// Standardised points `(d, n)` [1].
    pub points: &'a Mat<f64>,
    /// Running maxima `(n, m)` [unit of the output, or 1 of logarithms].
    pub values: Mat<f64>,
    /// Stated errors of the running maxima `(n, m)`, in that unit.
    pub errors: Mat<f64>,
    /// The two sides of the response, which are learned instead if it is a distance from a middle.
    pub sides: Option<Sides>,
    /// Threshold of the limit state, in that unit.
    pub threshold: f64,
    /// The scale of all of these.
    pub scale: ResponseScale,
}

impl<'a> ModeResults<'a> {
    /// The results of `mode` among the observations, whose points are `points` `(d, n)`.
    pub fn new(observations: &Observations, points: &'a Mat<f64>, mode: &Mode) -> Self {
        Self {
            points,
            values: observations.running_maxima(mode.output),
            errors: observations.errors_of_running_maxima(mode.output),
            sides: observations.sides(mode.output),
            threshold: mode.threshold,
            scale: ResponseScale::Values,
        }
    }

    /// These results, which are values, in this `scale`; `None` if they cannot be learned in it.
    pub fn in_scale(&self, scale: ResponseScale) -> Option<Self> {
        if scale == ResponseScale::Values {
            return Some(self.clone());
        }
        if self.sides.is_some() || self.threshold <= 0.0 || !scale.allows(self.values.as_ref()) {
            return None;
        }
        if self.learned_threshold().jump != 0.0 {
            return None;
        }
        let error = |i: usize, n: usize| self.errors[(i, n)] / scale.slope(self.values[(i, n)]);
        let values = scale.learned_values(&self.values);
        let errors = Mat::from_fn(values.nrows(), values.ncols(), error);
        Some(Self { values, errors, threshold: scale.learned(self.threshold), scale, ..self.clone() })
    }

    /// Values and errors that are learned `(n, m)`, or `(n, 2 m)` of two sides [unit of the output].
    pub fn learned(&self) -> (&Mat<f64>, &Mat<f64>) {
        let both = self.sides.as_ref().map(|sides| (&sides.values, &sides.errors));
        both.unwrap_or((&self.values, &self.errors))
    }

    /// Threshold that a surrogate of these results uses, by those with a value of their own of some variable.
    pub fn learned_threshold(&self) -> LearnedThreshold {
        if self.scale == ResponseScale::Logarithms {
            return LearnedThreshold { value: self.threshold, jump: 0.0, coarse: None };
        }
        // On a grid of the variables the response has steps of the design.
        let is_shared = |k: usize, i: usize| {
            (0..self.points.ncols()).any(|j| j != i && self.points[(k, j)] == self.points[(k, i)])
        };
        let is_free = |i: &usize| (0..self.points.nrows()).any(|k| !is_shared(k, *i));
        let free = (0..self.values.nrows()).filter(is_free);
        let values = |k: usize| self.points.row(k).iter().copied().collect();
        let on_grid = (0..self.points.nrows()).all(|k| is_on_grid(values(k)));
        learned_threshold(free.map(|i| self.values.row(i).iter().copied()), self.threshold, on_grid)
    }

    /// Learned values at some checkpoints `(n, columns)`, and the noise of the points in proportion to their stated errors.
    pub fn chosen(&self, checkpoints: &[usize], plan: &Plan) -> (Mat<f64>, Option<NoiseShape>) {
        let ((values, errors), places) = (self.learned(), self.columns_of(checkpoints));
        let (chosen, errors) = (columns(values, &places), columns(errors, &places));
        let noise = NoiseShape::new(chosen.as_ref(), errors.as_ref(), plan.settings.stated_errors);
        (chosen, noise)
    }

    /// What the fit of these learned values is given.
    pub fn training<'t>(
        &'t self,
        chosen: &'t Mat<f64>,
        noise: Option<&'t NoiseShape>,
        plan: &Plan,
    ) -> TrainingSet<'t> {
        let (points, values) = (self.points.as_ref(), chosen.as_ref());
        TrainingSet { points, values, noise, is_exact: plan.is_as_published() }
    }

    /// Fits form and lengths to these checkpoints, from those of the model `before`.
    pub fn fitted(
        &self,
        checkpoints: &[usize],
        before: Option<&Kriging>,
        (plan, effort): (&Plan, Effort),
    ) -> Result<Chosen, SurrogateError> {
        let (chosen, noise) = self.chosen(checkpoints, plan);
        let training = self.training(&chosen, noise.as_ref(), plan);
        fit_surrogate(training, plan.settings.forms, before, effort)
    }

    /// The columns of these of some checkpoints.
    pub fn columns_of(&self, checkpoints: &[usize]) -> Vec<usize> {
        let m = self.values.ncols();
        let sides = if self.sides.is_some() { 2 } else { 1 };
        (0..sides).flat_map(|side| checkpoints.iter().map(move |n| side * m + n)).collect()
    }
}

/// The chosen columns of a matrix `(n, m)`.
pub(super) fn columns(of: &Mat<f64>, chosen: &[usize]) -> Mat<f64> {
    let of: MatRef<'_, f64> = of.as_ref();
    Mat::from_fn(of.nrows(), chosen.len(), |i, o| of[(i, chosen[o])])
}
