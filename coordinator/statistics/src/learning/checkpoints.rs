//! The checkpoints that matter: those at which the population is neither all safe nor all failed.
//!
//! # Source
//! This project's own choice; the bounds on the share are below the error target of the curves.

/// Failure share below which (or above one minus which) a mode counts as settled: a hundredth of that of a life at R = 0.99.
const SETTLED: f64 = 1e-4;

/// True if a failure share [1] is so near to 0 or 1 that its checkpoint does not matter.
pub fn is_settled(share: f64) -> bool {
    !(share > SETTLED && share < 1.0 - SETTLED)
}

/// Returns the indices of the checkpoints that matter for one mode, ascending, never empty.
///
/// A checkpoint matters if the failure share of the initial design (`sample_share` `(m,)` [1]) lies strictly
/// between 0 and 1, or that of the surrogate over the population (`predicted_share` `(m,)` [1], `None` before
/// the first fit) between 0.0001 and 0.9999; one more checkpoint on either side is a margin. If no checkpoint
/// matters, those around the jump from safe to failed are taken, or the last two if nothing fails. More than
/// `most` checkpoints (at least 2) are thinned evenly to `most`: failure shares are counted at every
/// checkpoint anyway, learning only needs a dense enough grid.
///
/// The choice is repeated each round with the new data.
pub fn checkpoints_that_matter(
    sample_share: &[f64],
    predicted_share: Option<&[f64]>,
    most: usize,
) -> Vec<usize> {
    let m = sample_share.len();
    let matters = |n: &usize| {
        let sampled = sample_share[*n] > 0.0 && sample_share[*n] < 1.0;
        sampled || predicted_share.is_some_and(|p| !is_settled(p[*n]))
    };
    let jump = predicted_share.unwrap_or(sample_share).iter().position(|p| *p >= 0.5).unwrap_or(m - 1);
    let first = (0..m).find(matters).unwrap_or(jump);
    let last = (0..m).rev().find(matters).unwrap_or(jump);
    let (first, last) = (first.saturating_sub(1), (last + 1).min(m - 1));
    let count = last - first + 1;
    if count <= most {
        return (first..=last).collect();
    }
    (0..most).map(|i| first + i * (count - 1) / (most - 1)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_transition_and_a_margin_matter() {
        let share = [0.0, 0.0, 0.0, 0.1, 0.6, 1.0, 1.0, 1.0];
        assert_eq!(checkpoints_that_matter(&share, None, 24), vec![2, 3, 4, 5]);
        let predicted = [0.0, 0.0, 0.0002, 0.1, 0.6, 0.99, 0.99999, 1.0];
        assert_eq!(checkpoints_that_matter(&share, Some(&predicted), 24), vec![1, 2, 3, 4, 5, 6]);
    }

    #[test]
    fn a_sudden_or_absent_transition_still_has_checkpoints() {
        assert_eq!(checkpoints_that_matter(&[0.0, 0.0, 1.0, 1.0], None, 24), vec![1, 2, 3]);
        assert_eq!(checkpoints_that_matter(&[0.0; 5], None, 24), vec![3, 4]);
        assert_eq!(checkpoints_that_matter(&[1.0; 5], None, 24), vec![0, 1]);
        assert_eq!(checkpoints_that_matter(&[0.0], Some(&[0.0]), 24), vec![0]);
    }

    #[test]
    fn a_long_transition_is_thinned_with_its_ends_kept() {
        let chosen = checkpoints_that_matter(&[0.5; 720], None, 24);
        assert_eq!((chosen.len(), chosen[0], chosen[23]), (24, 0, 719));
        assert!(chosen.windows(2).all(|w| w[0] < w[1]));
    }
}
