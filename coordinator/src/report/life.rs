//! Lives read from reliability curves: when R falls to a level, and which limit state leads there.

use crate::summary::{ReliabilityRow, StudySummary};

/// The life at which a reliability curve falls to a level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LifeAt {
    /// Reached, by linear interpolation between checkpoints; the bounds are where the curve less and plus 1.96
    /// standard errors reaches the level (the upper one is the end of life if it does not).
    Cycles {
        /// Life [cycles].
        life: f64,
        /// Lower bound [cycles].
        lower: f64,
        /// Upper bound [cycles].
        upper: f64,
    },
    /// Still above the level at the end of the life studied [cycles].
    Beyond(u32),
}

/// Life at which the reliability `key` (a limit state or `total`) falls to `level`; R(0) = 1.
pub fn life_at(summary: &StudySummary, key: &str, level: f64) -> LifeAt {
    let last = summary.reliability.last().map_or(0, |row| row.cycles);
    match crossing(summary, key, level, 0.0) {
        None => LifeAt::Beyond(last),
        Some(life) => LifeAt::Cycles {
            life,
            lower: crossing(summary, key, level, -1.96).unwrap_or(life),
            upper: crossing(summary, key, level, 1.96).unwrap_or(f64::from(last)),
        },
    }
}

fn crossing(summary: &StudySummary, key: &str, level: f64, errors: f64) -> Option<f64> {
    let mut before = (0.0, 1.0);
    for row in &summary.reliability {
        let error = row.standard_error.get(key).copied().filter(|error| error.is_finite()).unwrap_or(0.0);
        let now = (f64::from(row.cycles), row.reliability.get(key)? + errors * error);
        if now.1 <= level {
            let share = if before.1 > level { (before.1 - level) / (before.1 - now.1) } else { 0.0 };
            return Some(before.0 + share * (now.0 - before.0));
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

/// The rows in which something happens: from the last one with everything alive to the first one with nothing
/// alive, within `margin` rows more on either side. All rows if nothing fails at all.
pub fn rows_that_matter(summary: &StudySummary, margin: usize) -> &[ReliabilityRow] {
    let rows = &summary.reliability;
    let alive = |row: &ReliabilityRow| row.reliability.values().all(|r| *r > 0.9995);
    let dead = |row: &ReliabilityRow| row.reliability.values().all(|r| *r < 0.0005);
    let Some(first) = rows.iter().position(|row| !alive(row)) else { return rows };
    let last = rows.iter().position(dead).unwrap_or(rows.len() - 1);
    &rows[first.saturating_sub(1 + margin)..(last + 1 + margin).min(rows.len())]
}

/// The limit state with the most failures at each row, where any has failed: (cycles from, name), one entry
/// per change of the leader.
pub fn leaders(summary: &StudySummary) -> Vec<(u32, &str)> {
    let mut leaders: Vec<(u32, &str)> = Vec::new();
    for row in &summary.reliability {
        let failed = |name: &str| 1.0 - row.reliability.get(name).copied().unwrap_or(1.0);
        // When nearly all have failed by every mode the shares are equal and nobody leads.
        let mut order: Vec<&String> = summary.limit_states.iter().collect();
        order.sort_by(|a, b| failed(b).total_cmp(&failed(a)));
        let Some(first) = order.first() else { continue };
        let second = order.get(1).map_or(0.0, |name| failed(name));
        let leads = failed(first) > 1e-3 && failed(first) - second > 1e-2;
        if leads && leaders.last().is_none_or(|(_, leader)| leader != first) {
            leaders.push((row.cycles, first));
        }
    }
    leaders
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::synthetic;

    fn summary(curves: &[(&str, &[f64])]) -> StudySummary {
        let mut summary = synthetic::study().summary;
        summary.limit_states =
            curves.iter().map(|(name, _)| name.to_string()).filter(|n| n != "total").collect();
        summary.reliability = (0..curves[0].1.len())
            .map(|k| ReliabilityRow {
                cycles: 1000 * (k as u32 + 1),
                reliability: curves.iter().map(|(name, r)| (name.to_string(), r[k])).collect(),
                standard_error: curves.iter().map(|(name, _)| (name.to_string(), 0.1 / 1.96)).collect(),
            })
            .collect();
        summary
    }

    #[test]
    fn the_life_at_a_level_is_interpolated() {
        let summary = summary(&[("wear", &[1.0, 0.8, 0.4]), ("total", &[1.0, 0.8, 0.4])]);
        let LifeAt::Cycles { life, lower, upper } = life_at(&summary, "total", 0.6) else { panic!() };
        assert!(
            (life - 2500.0).abs() < 1e-6 && (lower - 2250.0).abs() < 1e-6 && (upper - 2750.0).abs() < 1e-6
        );
        assert_eq!(life_at(&summary, "total", 0.3), LifeAt::Beyond(3000));
        let LifeAt::Cycles { life, .. } = life_at(&summary, "wear", 0.9) else { panic!() };
        assert!((life - 1500.0).abs() < 1e-6);
        assert_eq!(governing(&summary).unwrap().cycles, 3000);
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
