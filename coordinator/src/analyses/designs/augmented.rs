//! The scene that is studied for all designs: random variables whose distributions cover those of every design, and a random
//! variable for each design variable that is a quantity of the scene.
//!
//! A design variable t is uniform over its range. A variable x_k of the scene with the mean m_k(t) and the standard deviation
//! s_k(t) has over all designs, with m_k taken as linear in t,
//!
//!   mean = m_k(middle), variance = max s_k^2 + sum_i b_ki^2 / 3, b_ki = (m_k(upper end of t_i) - m_k(lower end)) / 2,
//!
//! and the covariances sum_i b_ki b_li / 3 with other variables and b_ki / sqrt(3) std(t_i) with the design variables, so that
//! dimensions that follow a design variable are simulated where the designs have them. These distributions choose the
//! simulations; the reliability of a design is computed with its own.

use super::space::{DesignSpace, DesignVariable};
use crate::analyses::scene_settings::{FIT_KEYS, correlation_of, row, rows, write_values};
use crate::analyses::setting::correlation_row;
use common::random::RandomVariable;
use common::scene::{Faults, Scene, SceneSource};
use toml::{Table, Value};

/// Share of its unit range that a correlation may reach, so that the matrix stays positive definite.
const MOST_CORRELATED: f64 = 0.99;
/// Correlation below which variables count as independent.
const LEAST_CORRELATED: f64 = 1e-6;

/// Moments of one variable over all designs.
struct Envelope {
    /// Half of the change of the mean over the range of each design variable `(q,)` [SI].
    slopes: Vec<f64>,
    mean: f64,
    /// Largest standard deviation at any design [SI].
    own_std: f64,
    /// Bounds that contain those of every design [SI].
    bounds: (f64, f64),
    /// Whether the distribution is the same in every design.
    is_fixed: bool,
}

impl Envelope {
    fn std(&self) -> f64 {
        (self.own_std.powi(2) + self.slopes.iter().map(|b| b * b / 3.0).sum::<f64>()).sqrt()
    }
}

impl DesignSpace {
    /// The augmented scene.
    ///
    /// # Errors
    /// Its faults: a design variable whose range leads to a scene that is not valid together with the bounds of the others.
    pub fn augmented(&self) -> Result<SceneSource, Faults> {
        let corners = self.corners();
        let corners = corners.iter().map(|values| self.scene_at(values)).collect::<Result<Vec<_>, _>>()?;
        let middle = self.scene_at(&self.middle())?;
        let ends = self.ends()?;
        let variables = self.base.variables();
        let envelopes: Vec<_> = (0..variables.len()).map(|k| envelope(k, &corners, &middle, &ends)).collect();
        let correlations = self.correlations(&envelopes, &middle);
        self.base.edited("--design", |document| {
            for (variable, envelope) in variables.iter().zip(&envelopes).filter(|(_, e)| !e.is_fixed) {
                if let Some(row) = row(document, &variable.name) {
                    write_envelope(row, variable, envelope);
                }
            }
            let uniform = |design: &DesignVariable| {
                let [lower, upper] = [design.lower, design.upper].map(|end| design.written(end));
                design.row(&[("distribution", "uniform".into()), ("lower", lower), ("upper", upper)])
            };
            rows(document, "variables").extend(self.variables.iter().filter_map(uniform));
            if correlations.is_empty() {
                document.remove("correlations");
            } else {
                document.insert("correlations".to_owned(), Value::Array(correlations));
            }
        })
    }

    /// For each design variable the scenes at both ends of its range, the others in the middle.
    pub(super) fn ends(&self) -> Result<Vec<[Scene; 2]>, Faults> {
        let at = |i: usize, end: f64| {
            let mut values = self.middle();
            values[i] = self.variables[i].at(end);
            self.scene_at(&values)
        };
        (0..self.variables.len()).map(|i| Ok([at(i, 0.0)?, at(i, 1.0)?])).collect()
    }

    /// Rows of correlations over all designs.
    fn correlations(&self, envelopes: &[Envelope], middle: &Scene) -> Vec<Value> {
        let d = middle.variables.len();
        // Loadings on the design variables, in standard deviations.
        let own = envelopes.iter().map(|e| {
            let std = e.std();
            let loading = |b: &f64| if std > 0.0 { b / 3f64.sqrt() / std } else { 0.0 };
            e.slopes.iter().map(loading).collect()
        });
        let q = self.variables.len();
        let added = (0..q).filter(|i| self.variables[*i].added.is_some());
        let added = added.map(|i| (0..q).map(|j| f64::from(u8::from(i == j))).collect());
        let loadings: Vec<Vec<f64>> = own.chain(added).collect();
        let rest = |k: usize| envelopes.get(k).filter(|e| e.std() > 0.0).map_or(0.0, |e| e.own_std / e.std());
        let row = |(k, l): (usize, usize)| {
            let common: f64 = loadings[k].iter().zip(&loadings[l]).map(|(a, b)| a * b).sum();
            let coefficient = MOST_CORRELATED * common + correlation_of(middle, k, l) * rest(k) * rest(l);
            let names = [k, l].map(|k| middle.variables[k].name.as_str());
            (coefficient.abs() > LEAST_CORRELATED)
                .then(|| correlation_row(names, "coefficient", coefficient.into()))
        };
        (0..d).flat_map(|k| (k + 1..d).map(move |l| (k, l))).filter_map(row).collect()
    }
}

/// Moments of variable `k` of the scene over all designs.
fn envelope(k: usize, corners: &[Scene], middle: &Scene, ends: &[[Scene; 2]]) -> Envelope {
    let law = |scene: &Scene| scene.variables[k].distribution.clone();
    let mean = |scene: &Scene| law(scene).parent_mean();
    let all: Vec<_> = corners.iter().chain([middle]).chain(ends.iter().flatten()).map(law).collect();
    let wider = |(low, high): (f64, f64), (l, h): (f64, f64)| (low.min(l), high.max(h));
    let bounds = all.iter().map(|law| law.limits()).fold((f64::INFINITY, f64::NEG_INFINITY), wider);
    Envelope {
        slopes: ends.iter().map(|[lower, upper]| 0.5 * (mean(upper) - mean(lower))).collect(),
        mean: mean(middle),
        own_std: all.iter().map(|law| law.given_std()).fold(0.0, f64::max),
        bounds,
        is_fixed: all.iter().all(|law| *law == all[0]),
    }
}

/// Writes the distribution over all designs into the row of a variable.
fn write_envelope(row: &mut Table, variable: &RandomVariable, envelope: &Envelope) {
    for key in ["std", "truncation", "mode"].iter().chain(&FIT_KEYS) {
        row.remove(*key);
    }
    row.insert("distribution".to_owned(), Value::from("truncated-normal"));
    let (lower, upper) = envelope.bounds;
    let values = [("mean", envelope.mean), ("std", envelope.std()), ("lower", lower), ("upper", upper)];
    write_values(row, &values, &variable.unit);
}
