//! Design variables of the study in an optimisation: their bounds must lie within the ranges of the study, and the random
//! variables that follow them must do so along straight lines.

use super::problem::{DesignProblem, StudiedDesigns};
use crate::analyses::designs::DesignSpace;
use crate::statistics::design::InputModel;
use common::scene::{Faults, InputFile, Scene};

/// Share of a range by which a bound may lie outside of it, for rounding.
const ROUNDING: f64 = 1e-9;

/// The problem, read for the present design of a study with the design variables of `space` and the `augmented` scene.
///
/// # Errors
/// A bound lies outside the range of the study, or a random variable does not follow a design
/// variable along a straight line.
pub(super) fn for_designs(
    problem: DesignProblem,
    space: &DesignSpace,
    augmented: &Scene,
    file: &InputFile,
) -> Result<DesignProblem, Faults> {
    let followers = space.followers()?;
    let mut faults = Vec::new();
    for (place, quantity) in problem.quantities.iter().enumerate() {
        for (variable, k, _) in space.quantities() {
            if !quantity.variables.contains(&k) {
                continue;
            }
            let key = format!("quantities[{}]", place + 1);
            let (lower, upper) = augmented.variables[k].distribution.support();
            let margin = ROUNDING * (upper - lower);
            if quantity.lower < lower - margin || quantity.upper > upper + margin {
                let range = [variable.lower, variable.upper].map(|end| variable.with_unit(end)).join(" to ");
                let what = format!("the study has designs with {} from {range} only", variable.key);
                faults.push((key.clone(), what));
            }
            if let Some(bent) = followers.iter().find(|f| f.leader == k && !f.is_straight) {
                let what = format!(
                    "the distribution of {} does not follow {} along a straight line, which an optimum needs; give the mean \
                     of {0} as a quantity instead",
                    augmented.variables[bent.variable].name, variable.key
                );
                faults.push((key, what));
            }
        }
    }
    file.refuse_for(faults)?;
    let augmented = InputModel::from_scene(augmented);
    Ok(DesignProblem { designs: Some(StudiedDesigns { augmented, followers }), ..problem })
}
