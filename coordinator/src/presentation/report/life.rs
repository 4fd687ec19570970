//! Lives read from reliability curves: the life at which R falls to a level, and the limit state with the most failures.

use crate::results::summary::{NumericalRange, ReliabilityRow, StudySummary};
use statrs::distribution::{ContinuousCDF, Normal};

/// Reliabilities at which lives are stated.
pub const LEVELS: [f64; 3] = [0.99, 0.9, 0.5];

/// The life at which a reliability curve falls to a level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LifeAt {
    /// Life interpolated between two checkpoints, linearly in the probit of R, which is exact for normally distributed
    /// lives. The bounds are the lives at which R minus and plus 1.96 standard errors reaches the level (the upper one is
    /// the end of life if R stays above the level), widened by a quarter of the distance to linear interpolation of R,
    /// since the course of R between checkpoints is unknown.
    Cycles {
        /// Interpolated life [cycles].
        life: f64,
        /// Lower bound [cycles].
        lower: f64,
        /// Upper bound [cycles].
        upper: f64,
    },
    /// R is above the level at the end of the life studied [cycles].
    Beyond(u32),
}

/// Life at which the reliability `key` (a limit state or `total`) falls to `level`; R(0) = 1.
pub fn life_at(summary: &StudySummary, key: &str, level: f64) -> LifeAt {
    let moved = |errors: f64| {
        let curve = |row: &ReliabilityRow| {
            let error = row.standard_error.get(key).copied().filter(|error| error.is_finite()).unwrap_or(0.0);
            row.reliability.get(key).map(|r| r + errors * error)
        };
        crossing(summary, &curve, level)
    };
    let last = summary.reliability.last().map_or(0, |row| row.cycles);
    match moved(0.0) {
        None => LifeAt::Beyond(last),
        Some((life, uncertainty)) => LifeAt::Cycles {
            life,
            lower: (moved(-1.96).map_or(life, |(lower, _)| lower) - uncertainty).max(0.0),
            upper: moved(1.96).map_or(f64::from(last), |(upper, _)| upper + uncertainty),
        },
    }
}

/// Lives [cycles] at which the reliability `key` falls to `level` with all responses shifted by their stated numerical
/// errors to the unsafe and to the safe side; `None` for a life beyond the one studied. `None` as a whole if the study
/// states no numerical errors.
pub fn numerical_lives(summary: &StudySummary, key: &str, level: f64) -> Option<[Option<f64>; 2]> {
    summary.reliability.first()?.numerical.get(key)?;
    let life = |side: fn(&NumericalRange) -> f64| {
        let curve = |row: &ReliabilityRow| row.numerical.get(key).map(side);
        crossing(summary, &curve, level).map(|(life, _)| life)
    };
    Some([life(|range| range.lower), life(|range| range.upper)])
}

/// Life at which the curve falls to `level`, and the uncertainty of its interpolation [cycles].
fn crossing(
    summary: &StudySummary,
    curve: &dyn Fn(&ReliabilityRow) -> Option<f64>,
    level: f64,
) -> Option<(f64, f64)> {
    // Shares below half a point of the population cannot be distinguished from zero.
    let least = 0.5 / summary.population.max(1) as f64;
    let probit = |r: f64| Normal::standard().inverse_cdf(r.clamp(least, 1.0 - least));
    let mut before = (0.0, 1.0);
    for row in &summary.reliability {
        let now = (f64::from(row.cycles), curve(row)?);
        if now.1 <= level {
            if before.1 <= level {
                return Some((before.0, 0.0));
            }
            let span = now.0 - before.0;
            let linear = span * (before.1 - level) / (before.1 - now.1);
            let (start, end) = (probit(before.1), probit(now.1));
            let along = if start > end { span * (start - probit(level)) / (start - end) } else { linear };
            return Some((before.0 + along, 0.25 * (along - linear).abs()));
        }
        before = now;
    }
    None
}

/// The row where the system's reliability is nearest 1/2.
pub fn governing(summary: &StudySummary) -> Option<&ReliabilityRow> {
    let distance = |row: &ReliabilityRow| (row.reliability.get("total").copied().unwrap_or(1.0) - 0.5).abs();
    summary.reliability.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

/// The rows from the last one without failures to the first one without survivors, and `margin` more on either side; all
/// rows if nothing fails.
pub fn rows_that_matter(summary: &StudySummary, margin: usize) -> &[ReliabilityRow] {
    let rows = &summary.reliability;
    let alive = |row: &ReliabilityRow| row.reliability.values().all(|r| *r > 0.9995);
    let dead = |row: &ReliabilityRow| row.reliability.values().all(|r| *r < 0.0005);
    let Some(first) = rows.iter().position(|row| !alive(row)) else { return rows };
    let last = rows.iter().position(dead).unwrap_or(rows.len() - 1);
    &rows[first.saturating_sub(1 + margin)..(last + 1 + margin).min(rows.len())]
}

/// A limit state leads once it has failed this share of the mechanisms more than any other.
const LEAD: f64 = 1e-3;

/// The limit state with the most failures at each row, where any has failed: (cycles from, name), one entry
/// per change of the leader; the cycles are those of the first checkpoint where it leads.
pub fn leaders(summary: &StudySummary) -> Vec<(u32, &str)> {
    let mut leaders: Vec<(u32, &str)> = Vec::new();
    for row in &summary.reliability {
        let failed = |name: &str| 1.0 - row.reliability.get(name).copied().unwrap_or(1.0);
        // Once nearly all have failed in every mode, the shares are equal and no mode leads.
        let mut order: Vec<&String> = summary.limit_states.iter().collect();
        order.sort_by(|a, b| failed(b).total_cmp(&failed(a)));
        let Some(first) = order.first() else { continue };
        let second = order.get(1).map_or(0.0, |name| failed(name));
        let leads = failed(first) - second > LEAD;
        if leads && leaders.last().is_none_or(|(_, leader)| leader != first) {
            leaders.push((row.cycles, first));
        }
    }
    leaders
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_study;
    use std::collections::BTreeMap;

    fn summary(curves: &[(&str, &[f64])]) -> StudySummary {
        let mut summary = test_study::study().summary;
        summary.limit_states =
            curves.iter().map(|(name, _)| name.to_string()).filter(|n| n != "total").collect();
        summary.reliability = (0..curves[0].1.len())
            .map(|k| ReliabilityRow {
                cycles: 1000 * (k as u32 + 1),
                reliability: curves.iter().map(|(name, r)| (name.to_string(), r[k])).collect(),
                standard_error: curves.iter().map(|(name, _)| (name.to_string(), 0.1 / 1.96)).collect(),
                numerical: BTreeMap::new(),
            })
            .collect();
        summary
    }

    #[test]
    fn numerical_errors_move_the_life_both_ways() {
        let mut summary = summary(&[("wear", &[1.0, 0.8, 0.5]), ("total", &[1.0, 0.8, 0.5])]);
        assert_eq!(numerical_lives(&summary, "total", 0.5), None);
        for (row, (lower, upper)) in summary.reliability.iter_mut().zip([(0.9, 1.0), (0.5, 0.95), (0.1, 0.6)])
        {
            row.numerical.insert("total".into(), NumericalRange { lower, upper });
        }
        let [worst, best] = numerical_lives(&summary, "total", 0.5).unwrap();
        assert!((worst.unwrap() - 2000.0).abs() < 1e-6 && best.is_none(), "{worst:?} {best:?}");
    }

    #[test]
    fn the_life_at_a_level_is_interpolated() {
        let summary = summary(&[("wear", &[1.0, 0.8, 0.4]), ("total", &[1.0, 0.8, 0.4])]);
        let LifeAt::Cycles { life, lower, upper } = life_at(&summary, "total", 0.6) else { panic!() };
        assert!(lower < life && life < upper && upper - lower > 400.0, "{lower} {life} {upper}");
        // Probits of 0.8, 0.6, 0.4: 0.84162, 0.25335, -0.25335.
        assert!((life - (2000.0 + 1000.0 * 0.588_27 / 1.094_97)).abs() < 0.1, "{life}");
        assert_eq!(life_at(&summary, "total", 0.3), LifeAt::Beyond(3000));
        let LifeAt::Cycles { life, .. } = life_at(&summary, "wear", 0.9) else { panic!() };
        // Linear interpolation of R between 1 and 0.8 would give 1500.
        assert!(life > 1600.0 && life < 2000.0, "{life}");
        assert_eq!(governing(&summary).unwrap().cycles, 3000);
    }

    #[test]
    fn a_normal_life_is_met_between_coarse_checkpoints() {
        // Lives are normal with mean 2600 and standard deviation 300; checkpoints every 1000 cycles.
        let normal = Normal::new(2600.0, 300.0).unwrap();
        let curve: Vec<f64> = (1..=4).map(|k| 1.0 - normal.cdf(1000.0 * k as f64)).collect();
        let summary = summary(&[("wear", &curve), ("total", &curve)]);
        for level in [0.95, 0.9, 0.5, 0.2] {
            let LifeAt::Cycles { life, lower, upper } = life_at(&summary, "total", level) else { panic!() };
            let truth = normal.inverse_cdf(1.0 - level);
            assert!(
                (life - truth).abs() < 1e-6 * truth && lower < truth && truth < upper,
                "{level}: {life} {truth}"
            );
        }
    }

    #[test]
    fn the_lead_changes_where_another_mode_has_more_failures() {
        let summary = summary(&[
            ("wear", &[1.0, 0.9, 0.6, 0.0]),
            ("asymmetry", &[1.0, 1.0, 0.3, 0.0]),
            ("total", &[1.0, 0.9, 0.2, 0.0]),
        ]);
        assert_eq!(leaders(&summary), [(2000, "wear"), (3000, "asymmetry")]);
        assert_eq!(rows_that_matter(&summary, 0).len(), 4);
    }

    #[test]
    fn nothing_fails() {
        let summary = summary(&[("wear", &[1.0, 1.0]), ("total", &[1.0, 1.0])]);
        assert!(leaders(&summary).is_empty());
        assert_eq!(rows_that_matter(&summary, 3).len(), 2);
        assert_eq!(life_at(&summary, "total", 0.5), LifeAt::Beyond(2000));
    }
}
