//! Distributions of the outputs in the form of the report: one entry per output and checkpoint.

use coordinator::presentation::report::CheckpointDistribution;
use coordinator::statistics::reliability::{Histogram, PROBABILITIES};
use coordinator::study::OutputHistory;

/// One entry per output and checkpoint of the histories.
pub fn for_report(histories: &[OutputHistory]) -> Vec<CheckpointDistribution> {
    let mut all = Vec::new();
    for history in histories {
        for (&cycles, at) in history.cycles.iter().zip(&history.at) {
            let (edges, counts) = bins(&at.histogram);
            all.push(CheckpointDistribution {
                output: history.output.clone(),
                cycles,
                mean: at.mean,
                std: at.std,
                edges,
                counts,
                quantiles: PROBABILITIES.iter().copied().zip(at.quantiles.iter().copied()).collect(),
            });
        }
    }
    all
}

/// Edges `(bins + 1,)`, increasing, and counts `(bins,)`; one narrow bin if every value is the same.
fn bins(histogram: &Histogram) -> (Vec<f64>, Vec<u64>) {
    let Histogram { from, to, counts } = histogram;
    let width = (to - from) / counts.len() as f64;
    let edges: Vec<f64> = (0..=counts.len()).map(|i| from + width * i as f64).collect();
    if edges.is_sorted_by(|a, b| a < b) {
        return (edges, counts.clone());
    }
    // Wide enough for different edges at any magnitude.
    let half = (1e-9 * from.abs()).max(f64::MIN_POSITIVE);
    (vec![from - half, to + half], vec![counts.iter().sum()])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_increase_whatever_the_histogram() {
        let (edges, counts) = bins(&Histogram { from: 1.0, to: 3.0, counts: vec![5, 0, 2, 1] });
        assert_eq!((edges, counts), (vec![1.0, 1.5, 2.0, 2.5, 3.0], vec![5, 0, 2, 1]));
        for value in [0.0, 2e-5, -7.0] {
            let (edges, counts) = bins(&Histogram { from: value, to: value, counts: vec![9, 0, 0] });
            assert_eq!(counts, [9]);
            assert!(edges[0] < value && value < edges[1], "{edges:?}");
        }
    }
}
