//! Whether an evaluation's statement of its own error holds: the true error against it.

/// The true error lies within this many times the stated one in this share of cases, or the statement is wrong.
pub const TIMES: f64 = 2.0;
/// See [`TIMES`].
pub const REQUIRED_SHARE: f64 = 0.95;

/// One value with its true and its stated error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Case {
    /// Point, from 0.
    pub point: usize,
    /// Checkpoint [cycles].
    pub cycles: u32,
    /// Share of the life at the checkpoint [1].
    pub life: f64,
    /// |value - reference|, in the output's unit.
    pub off: f64,
    /// The error stated, likewise.
    pub stated: f64,
}

impl Case {
    /// True over stated error; 0 for 0 of 0, infinite for an error where none was stated.
    pub fn ratio(&self) -> f64 {
        if self.off == 0.0 { 0.0 } else { self.off / self.stated }
    }

    fn is_missed(&self) -> bool {
        self.off > TIMES * self.stated
    }
}

/// How stated errors hold, over all points and checkpoints of one or several outputs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stated {
    /// Number of values.
    pub values: usize,
    /// Share of them within the stated error [1].
    pub within: f64,
    /// Share within twice that [1].
    pub within_twice: f64,
    /// True over stated error of the value in the middle [1].
    pub median_ratio: f64,
    /// The ratio that 95 % of the values do not exceed [1]: above 2, the statement is wrong.
    pub ratio_95: f64,
    /// Values beyond twice the stated error in the first, second and last third of life.
    pub missed: [usize; 3],
    /// Points with any such value.
    pub points_missed: usize,
    /// The value furthest beyond, if any is.
    pub worst: Option<Case>,
}

impl Stated {
    /// Counts.
    pub fn of(cases: &[Case]) -> Self {
        let share = |count: usize| count as f64 / cases.len().max(1) as f64;
        let mut ratios: Vec<f64> = cases.iter().map(Case::ratio).collect();
        ratios.sort_by(f64::total_cmp);
        // The smallest ratio that at least this share of the values does not exceed.
        let quantile = |q: f64| {
            let rank = (q * ratios.len() as f64).ceil() as usize;
            ratios.get(rank.max(1) - 1).copied().unwrap_or(0.0)
        };
        let missed: Vec<&Case> = cases.iter().filter(|case| case.is_missed()).collect();
        let mut thirds = [0; 3];
        for case in &missed {
            thirds[((case.life * 3.0).ceil() as usize).clamp(1, 3) - 1] += 1;
        }
        let mut points: Vec<usize> = missed.iter().map(|case| case.point).collect();
        points.sort_unstable();
        points.dedup();
        Stated {
            values: cases.len(),
            within: share(cases.iter().filter(|case| case.off <= case.stated).count()),
            within_twice: share(cases.len() - missed.len()),
            median_ratio: quantile(0.5),
            ratio_95: quantile(REQUIRED_SHARE),
            missed: thirds,
            points_missed: points.len(),
            worst: missed.into_iter().copied().max_by(|a, b| a.ratio().total_cmp(&b.ratio())),
        }
    }

    /// Whether enough values lie within twice their stated error.
    pub fn holds(&self) -> bool {
        self.within_twice >= REQUIRED_SHARE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn case(point: usize, life: f64, off: f64, stated: f64) -> Case {
        Case { point, cycles: (1e4 * life) as u32, life, off, stated }
    }

    #[test]
    fn shares_quantiles_and_misses_are_counted() {
        // Ratios 0.1, 0.2, ..., 2.0 at the first point.
        let mut cases: Vec<Case> =
            (1..=20).map(|k| case(0, f64::from(k) / 20.0, 0.1 * f64::from(k), 1.0)).collect();
        let all = Stated::of(&cases);
        assert_eq!((all.values, all.within, all.within_twice), (20, 0.5, 1.0));
        assert!((all.median_ratio - 1.0).abs() < 1e-12 && (all.ratio_95 - 1.9).abs() < 1e-12);
        assert!(all.holds() && all.worst.is_none());
        // One early, two late, at two points; an error where none was stated is the worst of all.
        cases.extend([case(1, 0.2, 3.0, 1.0), case(1, 0.9, 2.1, 1.0), case(2, 1.0, 1e-9, 0.0)]);
        let some = Stated::of(&cases);
        assert_eq!((some.missed, some.points_missed), ([1, 0, 2], 2));
        assert!(!some.holds() && some.ratio_95 > 2.0);
        assert_eq!(some.worst.map(|w| (w.point, w.ratio())), Some((2, f64::INFINITY)));
        assert_eq!(case(0, 1.0, 0.0, 0.0).ratio(), 0.0);
        assert_eq!(Stated::of(&[]).values, 0);
    }
}
