//! Effect of numerical errors on the reliability: the empirical curve of a setting against that of the reference, from the
//! same random points.

use common::outputs::Evaluation;
use common::scene::{LimitState, Scene};

/// Reliabilities at which curves are compared besides where they differ most.
pub const LEVELS: [f64; 3] = [0.9, 0.5, 0.1];

/// The two reliabilities at one checkpoint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairedReliability {
    /// Checkpoint of the comparison [cycles].
    pub cycles: u32,
    /// Share of the points that have not failed there according to the reference [1].
    pub reference: f64,
    /// Share of the points that have not failed there according to the setting [1].
    pub found: f64,
}

impl PairedReliability {
    /// Reliability of the setting less that of the reference.
    pub fn difference(&self) -> f64 {
        self.found - self.reference
    }
}

/// Change of the lives by one limit state, or by all together (the first failure of any).
#[derive(Debug, Clone, PartialEq)]
pub struct LifeChange {
    /// Name of the limit state; `total` for all.
    pub limit_state: String,
    /// Share of them that fail at another checkpoint than by the reference, or fail in one of the two only [1].
    pub changed: f64,
    /// Checkpoint of the largest difference between the curves, the first of equal ones.
    pub largest: PairedReliability,
    /// Checkpoints at which the reference is nearest to each of `LEVELS`; `None` if it never comes within 0.25.
    pub at_levels: [Option<PairedReliability>; 3],
}

/// Compares lives of pairs (found, reference) at random points, by every limit state and in `total`; empty without points
/// or limit states.
pub fn life_changes(scene: &Scene, pairs: &[(&Evaluation, &Evaluation)]) -> Vec<LifeChange> {
    let Some((_, first)) = pairs.first() else { return vec![] };
    let cycles = &first.cycles;
    // Index of the first checkpoint with failure; the number of checkpoints without failure.
    let fails = |evaluation: &Evaluation, limit: &LimitState| {
        let history = &evaluation.histories[limit.output];
        history.iter().position(|y| limit.is_reached(*y)).unwrap_or(cycles.len())
    };
    let compared = |name: &str, limits: &[LimitState]| {
        let life = |evaluation| limits.iter().map(|limit| fails(evaluation, limit)).min();
        let lives: Vec<(usize, usize)> =
            pairs.iter().filter_map(|(found, reference)| Some((life(found)?, life(reference)?))).collect();
        change(name, cycles, &lives)
    };
    let each = scene.limit_states.iter().map(|limit| compared(&limit.name, std::slice::from_ref(limit)));
    let total = (scene.limit_states.len() > 1).then(|| compared("total", &scene.limit_states));
    each.chain(total).flatten().collect()
}

/// Change between lives (found, reference), each the index of a checkpoint.
fn change(name: &str, cycles: &[u32], lives: &[(usize, usize)]) -> Option<LifeChange> {
    let share = |count: usize| count as f64 / lives.len() as f64;
    let reliabilities = |n: usize| PairedReliability {
        cycles: cycles[n],
        reference: share(lives.iter().filter(|(_, reference)| *reference > n).count()),
        found: share(lives.iter().filter(|(found, _)| *found > n).count()),
    };
    let curve: Vec<PairedReliability> = (0..cycles.len()).map(reliabilities).collect();
    let first_by = |distance: &dyn Fn(&PairedReliability) -> f64| {
        curve.iter().copied().reduce(|best, at| if distance(&at) < distance(&best) { at } else { best })
    };
    Some(LifeChange {
        limit_state: name.to_owned(),
        changed: share(lives.iter().filter(|(found, reference)| found != reference).count()),
        // In whole points, so that rounding does not affect ties.
        largest: first_by(&|at| -(at.difference() * lives.len() as f64).round().abs())?,
        at_levels: LEVELS.map(|level| {
            let distance = |at: &PairedReliability| (at.reference - level).abs();
            first_by(&distance).filter(|at| distance(at) <= 0.25)
        }),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_are_compared_where_they_differ_most_and_at_the_levels() {
        // By the reference, of ten points one fails at each checkpoint but the first; the setting lets three of
        // them live one checkpoint longer and one for ever.
        let cycles: Vec<u32> = (1..=11).map(|k| 1000 * k).collect();
        let mut lives: Vec<(usize, usize)> = (1..=10).map(|k| (k, k)).collect();
        lives[3].0 += 1;
        lives[4].0 += 1;
        lives[5].0 += 1;
        lives[9].0 = 11;
        let found = change("wear", &cycles, &lives).expect("points to compare");
        assert_eq!(found.changed, 0.4);
        assert_eq!((found.largest.cycles, found.largest.reference), (5000, 0.6));
        assert!((found.largest.difference() - 0.1).abs() < 1e-12);
        let at = found.at_levels.map(|at| at.expect("the curve passes all levels").cycles);
        assert_eq!(at, [2000, 6000, 10_000]);
    }

    #[test]
    fn a_curve_that_never_comes_near_a_level_has_no_value_there() {
        let found = change("wear", &[1000, 2000], &[(2, 2), (2, 2)]).expect("points to compare");
        assert_eq!(found.changed, 0.0);
        assert_eq!(found.at_levels.map(|at| at.is_some()), [true, false, false]);
    }
}
