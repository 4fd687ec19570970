//! Shares of first failures, the cumulative incidence of competing risks:
//!
//!   F_s(n) = P(N_s <= n, N_s < N_t for all t other than s),   N_s the checkpoint of the failure by limit state s.
//!
//! # Source
//! Kalbfleisch, Prentice (2002), The Statistical Analysis of Failure Time Data, chapter 8.

/// Shares of the samples that have failed by each checkpoint, by the limit state that failed first
/// `(modes + 1, m)` [1]: each mode alone, then several modes at the same checkpoint. The shares add up to the
/// failure share of the system.
///
/// `first_failures` `(modes)(N,)` holds the index of the checkpoint by which each sample has failed, m if
/// never.
pub fn first_failure_shares(first_failures: &[&[u32]], m: usize) -> Vec<Vec<f64>> {
    let (modes, points) = (first_failures.len(), first_failures[0].len());
    let mut counts = vec![vec![0usize; m]; modes + 1];
    for j in 0..points {
        let first = first_failures.iter().map(|first| first[j] as usize).min().unwrap_or(m);
        if first == m {
            continue;
        }
        let mut earliest = (0..modes).filter(|s| first_failures[*s][j] as usize == first);
        let mode = earliest.next().expect("one mode is the earliest");
        counts[if earliest.next().is_some() { modes } else { mode }][first] += 1;
    }
    let cumulated = |counts: Vec<usize>| {
        let add = |sum: &mut usize, count: usize| {
            *sum += count;
            Some(*sum as f64 / points as f64)
        };
        counts.into_iter().scan(0, add).collect()
    };
    counts.into_iter().map(cumulated).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_failure_of_the_system_has_one_cause() {
        let (a, b) = ([0, 2, 3, 1], [3, 1, 3, 1]);
        let shares = first_failure_shares(&[&a, &b], 3);
        assert_eq!(shares, vec![vec![0.25, 0.25, 0.25], vec![0.0, 0.25, 0.25], vec![0.0, 0.25, 0.25]]);
        assert_eq!(first_failure_shares(&[&[1, 1]], 2), vec![vec![0.0, 1.0], vec![0.0, 0.0]]);
    }
}
