//! When two evaluations of one sample agree.

/// Difference of results of external simulators beyond their stated errors that counts as none, relative to the values [1].
const SAME: f64 = 1e-9;

/// Histories of an evaluation and their stated errors, both `(outputs)(m,)` [unit of the output]; without stated errors the latter are empty.
pub type HistoriesWithErrors<'a> = (&'a [Vec<f64>], &'a [Vec<f64>]);

/// True if two evaluations agree: to the last bit if results are `exact`, as those of the built-in simulator are, otherwise within the sum
/// of their stated errors and 1e-9 of the larger value.
pub fn agree(one: HistoriesWithErrors<'_>, other: HistoriesWithErrors<'_>, exact: bool) -> bool {
    if exact {
        return one == other;
    }
    let error =
        |of: &[Vec<f64>], k: usize, j: usize| of.get(k).and_then(|e| e.get(j)).copied().unwrap_or(0.0);
    one.0.iter().zip(other.0).enumerate().all(|(k, (a, b))| {
        a.iter().zip(b).enumerate().all(|(j, (a, b))| {
            (a - b).abs() <= error(one.1, k, j) + error(other.1, k, j) + SAME * a.abs().max(b.abs())
        })
    })
}
