//! Which limit state fails first.

/// Shares of the samples that have failed by each checkpoint by what failed first, `(modes + 1, m)` [1]: each mode alone,
/// then several at the same checkpoint. They add up to the failure share of the system, so divided by it they say what
/// kills first.
///
/// `first_failures` holds the index of the checkpoint by which each sample has failed, m if never `(modes)(N,)`.
pub fn killers(first_failures: &[&[u32]], m: usize) -> Vec<Vec<f64>> {
    let (modes, points) = (first_failures.len(), first_failures[0].len());
    let mut counts = vec![vec![0usize; m]; modes + 1];
    for j in 0..points {
        let first = first_failures.iter().map(|first| first[j] as usize).min().unwrap_or(m);
        if first == m {
            continue;
        }
        let mut of = (0..modes).filter(|s| first_failures[*s][j] as usize == first);
        let killer = of.next().expect("one of them is the earliest");
        counts[if of.next().is_some() { modes } else { killer }][first] += 1;
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
        let shares = killers(&[&a, &b], 3);
        assert_eq!(shares, vec![vec![0.25, 0.25, 0.25], vec![0.0, 0.25, 0.25], vec![0.0, 0.25, 0.25]]);
        assert_eq!(killers(&[&[1, 1]], 2), vec![vec![0.0, 1.0], vec![0.0, 0.0]]);
    }
}
