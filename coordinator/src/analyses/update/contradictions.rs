//! Observations of one unit that cannot be true together.

use super::observation::{Observable, Observation, ObservedUnit, Quantity};
use common::scene::{LimitState, Scene};

/// Differences that contradict: of two values of one quantity at one life, of a value from a limit [standard deviations].
pub(super) const CONTRADICTION: f64 = 4.0;

/// Observations of a unit, in order, that cannot be true together: line, column and why.
pub(super) fn contradictions(unit: &ObservedUnit, scene: &Scene) -> Vec<(u64, &'static str, String)> {
    let mut faults = Vec::new();
    let failed = unit.failure();
    for (place, observation) in unit.observations.iter().enumerate() {
        let Observation { line, cycles, ref name, quantity } = *observation;
        if let Some(failure) = failed.filter(|failure| failure.line != line) {
            let after = match quantity {
                Quantity::Measured { of: Observable::Variable(_), .. } => false,
                Quantity::Survived => cycles >= failure.cycles,
                _ => cycles > failure.cycles || matches!(quantity, Quantity::Failed { .. }),
            };
            if after {
                let (unit, Observation { line: at, cycles, .. }) = (&unit.name, failure);
                let what =
                    format!("unit {unit} had failed by {cycles} cycles (line {at}); nothing can follow");
                faults.push((line, "cycles", what));
            }
        }
        let Quantity::Measured { of, value: other, error: f } = quantity else { continue };
        let exceeds = |limit: &&LimitState| {
            let beyond = limit.response(other) - limit.response_threshold();
            of == Observable::Output(limit.output) && beyond > CONTRADICTION * f
        };
        let survived =
            unit.observations.iter().rfind(|o| o.quantity == Quantity::Survived && o.cycles >= cycles);
        if let (Some(limit), Some(later)) = (scene.limit_states.iter().find(exceeds), survived) {
            let (unit, Observation { line: at, cycles, .. }, limit) = (&unit.name, later, &limit.name);
            let what = format!(
                "{name} of unit {unit} is beyond the threshold of {limit}, but it had survived {cycles} cycles (line {at})"
            );
            faults.push((line, "value", what));
        }
        for before in &unit.observations[..place] {
            let Quantity::Measured { of: first, value: one, error: e } = before.quantity else { continue };
            let same_life = before.cycles == cycles || matches!(of, Observable::Variable(_));
            let (difference, error) = ((one - other).abs(), e.hypot(f));
            if same_life && first == of && difference > CONTRADICTION * error {
                let (unit, first, times) = (&unit.name, before.line, difference / error);
                let what = format!(
                    "{name} of unit {unit} contradicts line {first}: the values differ by {times:.1} standard deviations of their \
                     errors; allowed: at most {CONTRADICTION}"
                );
                faults.push((line.max(first), "value", what));
            }
        }
    }
    faults
}
