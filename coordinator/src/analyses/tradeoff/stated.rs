//! Validity of the numerical errors that evaluations state: comparison with the true errors.

/// Multiple of the stated error below which the true error must lie in [`REQUIRED_SHARE`] of the values.
pub const TIMES: f64 = 2.0;
/// Share of the values whose true error must lie within [`TIMES`] the stated one [1].
pub const REQUIRED_SHARE: f64 = 0.95;

/// One value with its true and its stated error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StatedValue {
    /// Point, from 0.
    pub point: usize,
    /// True error, |value - reference| [SI unit of the output].
    pub off: f64,
    /// Stated error [SI unit of the output].
    pub stated: f64,
}

impl StatedValue {
    /// True error over stated error [1]; 0 if both are zero, infinite if only the stated error is zero.
    pub fn ratio(&self) -> f64 {
        if self.off == 0.0 { 0.0 } else { self.off / self.stated }
    }

    fn is_missed(&self) -> bool {
        self.off > TIMES * self.stated
    }
}

/// Comparison of stated and true errors over all points and checkpoints of one or several outputs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StatedErrorCheck {
    /// Share of the values whose true error is within the stated one [1].
    pub within: f64,
    /// Share of the values whose true error is within twice the stated one [1].
    pub within_twice: f64,
    /// Median of true over stated error [1].
    pub median_ratio: f64,
    /// 95 % quantile of true over stated error [1]; above 2 the stated errors are not valid.
    pub ratio_95: f64,
    /// Number of points with such a value.
    pub points_missed: usize,
}

impl StatedErrorCheck {
    /// Statistics of these values.
    pub fn new(values: &[StatedValue]) -> Self {
        let share = |count: usize| count as f64 / values.len().max(1) as f64;
        let mut ratios: Vec<f64> = values.iter().map(StatedValue::ratio).collect();
        ratios.sort_by(f64::total_cmp);
        // The smallest ratio that at least this share of the values does not exceed.
        let quantile = |q: f64| {
            let rank = (q * ratios.len() as f64).ceil() as usize;
            ratios.get(rank.max(1) - 1).copied().unwrap_or(0.0)
        };
        let missed: Vec<&StatedValue> = values.iter().filter(|case| case.is_missed()).collect();
        let mut points: Vec<usize> = missed.iter().map(|case| case.point).collect();
        points.sort_unstable();
        points.dedup();
        StatedErrorCheck {
            within: share(values.iter().filter(|case| case.off <= case.stated).count()),
            within_twice: share(values.len() - missed.len()),
            median_ratio: quantile(0.5),
            ratio_95: quantile(REQUIRED_SHARE),
            points_missed: points.len(),
        }
    }

    /// True if enough values lie within twice their stated error.
    pub fn holds(&self) -> bool {
        self.within_twice >= REQUIRED_SHARE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn case(point: usize, off: f64, stated: f64) -> StatedValue {
        StatedValue { point, off, stated }
    }

    #[test]
    fn shares_and_quantiles_are_counted() {
        // Ratios 0.1, 0.2, ..., 2.0 at the first point.
        let mut cases: Vec<StatedValue> = (1..=20).map(|k| case(0, 0.1 * f64::from(k), 1.0)).collect();
        let all = StatedErrorCheck::new(&cases);
        assert_eq!((all.within, all.within_twice, all.points_missed), (0.5, 1.0, 0));
        assert!((all.median_ratio - 1.0).abs() < 1e-12 && (all.ratio_95 - 1.9).abs() < 1e-12);
        assert!(all.holds());
        // Three at two points; an error where none was stated is the worst of all.
        cases.extend([case(1, 3.0, 1.0), case(1, 2.1, 1.0), case(2, 1e-9, 0.0)]);
        let some = StatedErrorCheck::new(&cases);
        assert_eq!(some.points_missed, 2);
        assert!(!some.holds() && some.ratio_95 > 2.0);
        assert_eq!((case(2, 1e-9, 0.0).ratio(), case(0, 0.0, 0.0).ratio()), (f64::INFINITY, 0.0));
        assert_eq!(StatedErrorCheck::new(&[]).median_ratio, 0.0);
    }
}
