//! The deviation of a point's response from its predicted mean, in predicted standard deviations: one standard
//! normal number for every point and mode, the same in every round, so that classifications change only with
//! the predictions.
//!
//! # Source
//! Numbers by counter: Steele, Lea, Flood (2014), Fast splittable pseudorandom number generators, OOPSLA 2014
//! (SplitMix64), one number from each counter.

use common::random::standard_normal_quantile;

/// Distance of the counters of two modes: more than a population has points.
const MODES: u64 = 1 << 40;
/// Increment and multipliers of SplitMix64.
const GAMMA: u64 = 0x9e37_79b9_7f4a_7c15;
const MULTIPLIERS: [u64; 2] = [0xbf58_476d_1ce4_e5b9, 0x94d0_49bb_1331_11eb];
/// Bits of a double below 1.
const BITS: u32 = 53;

/// Deviation [1] of point `j` by mode `mode`.
pub fn deviation(mode: usize, j: usize) -> f64 {
    let counter = (mode as u64).wrapping_mul(MODES).wrapping_add(j as u64 + 1);
    let mut bits = counter.wrapping_mul(GAMMA);
    bits = (bits ^ (bits >> 30)).wrapping_mul(MULTIPLIERS[0]);
    bits = (bits ^ (bits >> 27)).wrapping_mul(MULTIPLIERS[1]);
    bits ^= bits >> 31;
    // The middle of one of 2^53 intervals of (0, 1).
    let uniform = ((bits >> (u64::BITS - BITS)) as f64 + 0.5) / (1u64 << BITS) as f64;
    standard_normal_quantile(uniform)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn deviations_are_standard_normal_and_independent() {
        let n = 100_000;
        let pairs: Vec<(f64, f64)> = (0..n).map(|j| (deviation(0, j), deviation(1, j))).collect();
        let mean = |of: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>() / n as f64;
        // Four standard errors of each moment.
        let bound = 4.0 / (n as f64).sqrt();
        assert!(mean(&|p| p.0).abs() < bound && mean(&|p| p.0 * p.1).abs() < bound);
        assert!((mean(&|p| p.0 * p.0) - 1.0).abs() < 1.5 * bound);
        assert!((mean(&|p| f64::from(u8::from(p.1 > 1.0))) - 0.158_655).abs() < 0.4 * bound);
        let next = pairs.windows(2).map(|w| w[0].0 * w[1].0).sum::<f64>() / n as f64;
        assert!(next.abs() < bound, "{next}");
    }
}
