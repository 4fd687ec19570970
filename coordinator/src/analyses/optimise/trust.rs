//! The designs that simulations support: a trust region of the means around the last design that was simulated.
//!
//! A mean is trusted within three scales of that design. The scale is the standard deviation over which the simulations there are
//! spread. Where it is small against the bounds, a walk over them would take many rounds, and responses hardly change over it; a
//! visit then spreads its simulations uniformly over a tenth of the range to both sides, and this thirtieth of it is the scale.

use super::problem::{DesignProblem, DesignQuantity};
use crate::statistics::design::InputModel;
use common::random::Distribution;

/// Reach of the region in scales [1].
const TRUST: f64 = 3.0;
/// Largest number of scales in a range that visits spread over.
const PARTS: f64 = 30.0;
/// Distance from the edge of the region below which a design lies on it, in widths of the region [1].
const ON_EDGE: f64 = 1e-2;

impl DesignQuantity {
    /// The scale of a mean by its bounds alone [SI].
    fn part(&self) -> f64 {
        (self.upper - self.lower) / PARTS
    }

    /// True if visits spread this variable: its mean is a quantity with wide bounds.
    fn spreads(&self, law: &Distribution) -> bool {
        !self.kind.is_spread() && !law.is_constant() && law.given_std() < self.part()
    }
}

/// The quantity whose visits spread variable `k`, if there is one.
pub(super) fn spread_by<'p>(
    problem: &'p DesignProblem,
    inputs: &InputModel,
    k: usize,
) -> Option<&'p DesignQuantity> {
    let spreads = |q: &&DesignQuantity| q.variables.contains(&k) && q.spreads(&inputs.variables()[k]);
    problem.quantities.iter().find(spreads)
}

/// The inputs of the study, with coordinates whose scale is at least that of the visits.
pub(super) fn with_scales(problem: &DesignProblem, inputs: &InputModel) -> InputModel {
    let scaled = |k: usize, law: &Distribution| {
        Distribution::normal(law.parent_mean(), spread_by(problem, inputs, k)?.part()).ok()
    };
    inputs.clone().standardised_as(&with_laws(inputs, scaled))
}

/// The inputs with other distributions where `changed` gives some.
fn with_laws(
    inputs: &InputModel,
    changed: impl Fn(usize, &Distribution) -> Option<Distribution>,
) -> InputModel {
    let law = |(k, law): (usize, &Distribution)| changed(k, law).unwrap_or_else(|| law.clone());
    InputModel::new(inputs.variables().iter().enumerate().map(law).collect(), inputs.copula.clone())
}

/// The inputs of a visit to the design `inputs`: its variables are spread over the region that it will support.
pub(super) fn of_visit(problem: &DesignProblem, inputs: &InputModel) -> InputModel {
    let visited = |k: usize, law: &Distribution| {
        let quantity = spread_by(problem, inputs, k)?;
        let (mean, reach) = (law.parent_mean(), TRUST * quantity.part());
        Distribution::uniform(quantity.lower.max(mean - reach), quantity.upper.min(mean + reach)).ok()
    };
    with_laws(inputs, visited).standardised_as(inputs)
}

/// Region of y `(q,)` that simulations at the design y `(q,)` support, whose inputs are `inputs`; `visited` if a visit has spread them.
pub fn region(problem: &DesignProblem, inputs: &InputModel, y: &[f64], visited: bool) -> Vec<(f64, f64)> {
    let range = |(quantity, y): (&DesignQuantity, &f64)| {
        let stds = quantity.variables.iter().map(|k| {
            let law = &inputs.variables()[*k];
            if visited && quantity.spreads(law) { quantity.part() } else { law.given_std() }
        });
        let reach = TRUST * stds.fold(f64::INFINITY, f64::min) / (quantity.upper - quantity.lower);
        let is_whole = quantity.kind.is_spread() || reach.is_nan() || reach <= 0.0;
        if is_whole { (0.0, 1.0) } else { ((y - reach).max(0.0), (y + reach).min(1.0)) }
    };
    problem.quantities.iter().zip(y).map(range).collect()
}

/// Quantities, by their number, that the region holds at the design y `(q,)`, besides their own bounds.
pub(super) fn held(region: &[(f64, f64)], y: &[f64]) -> Vec<usize> {
    let is_held = |k: &usize| {
        let ((from, to), y) = (region[*k], y[*k]);
        let margin = ON_EDGE * (to - from);
        (from > 0.0 && y - from < margin) || (to < 1.0 && to - y < margin)
    };
    (0..y.len()).filter(is_held).collect()
}

#[cfg(test)]
mod tests {
    use super::super::QuantityKind;
    use super::*;
    use crate::analyses::quantity::ShownUnit;
    use crate::statistics::optimisation::CostModel;

    #[test]
    fn a_visit_supports_a_tenth_of_wide_bounds_and_three_standard_deviations_of_others() {
        let quantity = |k: usize| DesignQuantity {
            name: format!("x{k}"),
            variables: vec![k],
            kind: QuantityKind::Mean,
            lower: 0.0,
            upper: 6.0,
            unit: ShownUnit::of(""),
            cost: CostModel::Linear { c0: 0.0, c1: 1.0 },
            cost_unit: 1.0,
            grades: vec![],
        };
        let problem = DesignProblem {
            quantities: vec![quantity(0), quantity(1)],
            targets: vec![],
            ..DesignProblem::default()
        };
        let inputs =
            InputModel::from(&[(3.0, 0.4), (3.0, 0.001)].map(|(m, s)| Distribution::normal(m, s).unwrap()));
        let near = |found: &[(f64, f64)], expected: [f64; 2]| {
            found
                .iter()
                .zip(expected)
                .all(|((from, to), e)| (0.5 - from - e).abs() + (to - 0.5 - e).abs() < 1e-12)
        };
        let [before, after] = [false, true].map(|visited| region(&problem, &inputs, &[0.5, 0.5], visited));
        assert!(near(&before, [0.2, 0.0005]) && near(&after, [0.2, 0.1]), "{before:?} {after:?}");
        assert_eq!(held(&after, &[0.3, 0.55]), [0]);
        // A bound of the quantity is not an edge of the region.
        assert_eq!(held(&[(0.0, 0.2), (0.8, 1.0)], &[0.0, 1.0]), [0usize; 0]);
        // Coordinates keep what has a scale.
        let scaled = with_scales(&problem, &inputs);
        assert_eq!(scaled.standardised_value(0, 3.4), inputs.standardised_value(0, 3.4));
        assert!((scaled.standardised_value(1, 3.2) - 1.0).abs() < 1e-12);
        let visit = of_visit(&problem, &scaled);
        let (from, to) = visit.variables()[1].support();
        assert!(
            (from - 2.4).abs() + (to - 3.6).abs() < 1e-12 && visit.variables()[0] == inputs.variables()[0]
        );
    }
}
