//! Lives of a study as the report states them: the life at which R falls to a level, the limit state with the most failures.

use super::format::{self, count, fixed, power, rounded_cycles, share, three_digits, whole};
use crate::results::life_summary::{CyclesRange, LifeRow};
use crate::results::summary::{ReliabilityRange, ReliabilityRow, StudySummary};
pub use crate::study::LEVELS;

/// What the intervals of a summary contain, as the end of a sentence: that of a study under way has no numerical error yet.
pub fn errors_in_intervals(summary: &StudySummary) -> &'static str {
    let has_numerical = |row: &ReliabilityRow| {
        !row.numerical.is_empty() || row.parts.values().any(|parts| parts.numerical > 0.0)
    };
    if summary.reliability.iter().any(has_numerical) {
        "sampling, surrogate, interpolation and numerical error"
    } else {
        "sampling, surrogate and interpolation error, no numerical error"
    }
}

/// The life at which a reliability falls to a level, with the limits of its 95 % interval [cycles].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LifeAt {
    /// A life between two limits, the upper of which may lie beyond the life studied.
    Cycles {
        /// Best estimate of the life.
        life: f64,
        /// Lower limit of its interval.
        lower: f64,
        /// Upper limit of its interval.
        upper: Option<f64>,
    },
    /// R is not above the level even unworn, in the first cycle.
    Unworn {
        /// Upper limit of its interval, 0 if that too is certain.
        upper: Option<f64>,
    },
    /// The checkpoints bound the life but do not resolve it.
    Between {
        /// Lower limit, 0 if only the upper one is known.
        lower: f64,
        /// Upper limit of its interval.
        upper: Option<f64>,
    },
    /// R is above the level at the end of the life studied.
    Beyond {
        /// Lower limit of its interval.
        lower: f64,
        /// End of the life studied.
        end: f64,
    },
}

/// Life at which the reliability `key` (a limit state or `total`) falls to `level`, one of [`LEVELS`]. A study by an earlier
/// version, which stored no lives, has the checkpoints around it as limits.
pub fn life_at(summary: &StudySummary, key: &str, level: f64) -> LifeAt {
    let is_asked = |row: &&LifeRow| row.limit_state == key && row.reliability.to_bits() == level.to_bits();
    let Some(row) = summary.lives.iter().find(is_asked) else {
        return between_checkpoints(summary, key, level);
    };
    let CyclesRange { lower, upper } = row.whole_interval();
    let end = end_of_life(summary);
    let falls = summary.reliability.last().is_some_and(|row| row.reliability.get(key) <= Some(&level));
    let first = summary.curves.iter().find(|curve| curve.limit_state == key);
    let unworn = first.and_then(|curve| curve.reliability.first()).is_some_and(|r| *r <= level);
    match row.cycles {
        Some(life) => LifeAt::Cycles { life, lower, upper },
        None if falls && (unworn || upper == Some(0.0)) => LifeAt::Unworn { upper },
        None if falls => LifeAt::Between { lower, upper },
        None => LifeAt::Beyond { lower: lower.min(end), end },
    }
}

/// End of the life studied [cycles].
pub fn end_of_life(summary: &StudySummary) -> f64 {
    summary.reliability.last().map_or(0.0, |row| f64::from(row.cycles))
}

/// Checkpoints between which the limits of R fall to `level`.
fn between_checkpoints(summary: &StudySummary, key: &str, level: f64) -> LifeAt {
    let first_below = |limit: fn(&ReliabilityRange) -> f64| {
        summary.reliability.iter().position(|row| row.interval_of(key).is_some_and(|r| limit(&r) <= level))
    };
    let cycles = |k: usize| f64::from(summary.reliability[k].cycles);
    let (lower, upper) = (first_below(|range| range.lower), first_below(|range| range.upper));
    let before = |k: usize| if k == 0 { 0.0 } else { cycles(k - 1) };
    let end = end_of_life(summary);
    let falls = summary.reliability.last().is_some_and(|row| row.reliability.get(key) <= Some(&level));
    match lower {
        Some(k) if falls => LifeAt::Between { lower: before(k), upper: upper.map(cycles) },
        Some(k) => LifeAt::Beyond { lower: before(k), end },
        None => LifeAt::Beyond { lower: end, end },
    }
}

/// The life of mechanisms that exceed a limit in their first cycle.
const FAILED_UNWORN: &str = "failed unworn";
/// A life of which nothing is known.
const NOT_KNOWN: &str = "not known";

/// The unit of a life in words, if it is a number of cycles.
pub fn unit_of_life(life: &str) -> &'static str {
    if [FAILED_UNWORN, NOT_KNOWN].contains(&life) { "" } else { "cycles" }
}

/// A life in words and its limits, e.g. `63 420` and `63 200 to 63 640`, with two digits of the width of the interval.
pub fn life_and_limits(life: LifeAt) -> (String, String) {
    match life {
        LifeAt::Cycles { life, lower, upper } => {
            let width = 0.5 * (upper.unwrap_or(2.0 * life) - lower);
            let upper_text = upper.map_or("beyond the life studied".to_owned(), |u| rounded_cycles(u, width));
            (rounded_cycles(life, width), format!("{} to {upper_text}", rounded_cycles(lower, width)))
        }
        LifeAt::Unworn { upper } => {
            let limits = match upper {
                None => "to beyond the life studied".to_owned(),
                Some(upper) if upper <= 0.0 => String::new(),
                Some(upper) => format!("0 to {}", whole(upper.ceil())),
            };
            (FAILED_UNWORN.to_owned(), limits)
        }
        LifeAt::Between { lower, upper } => {
            let (lower_text, upper_text) = (whole(lower.floor()), upper.map(|upper| whole(upper.ceil())));
            let life = match upper_text {
                Some(upper) if lower > 0.0 => format!("{lower_text} to {upper}"),
                Some(upper) => format!("before {upper}"),
                None => format!("after {lower_text}"),
            };
            (life, String::new())
        }
        LifeAt::Beyond { lower, .. } if lower < 1.0 => (NOT_KNOWN.to_owned(), String::new()),
        LifeAt::Beyond { lower, .. } => (format!("beyond {}", whole(lower.floor())), String::new()),
    }
}

/// A life in one cell: with its limits in brackets, where it has some.
pub fn life_with_limits(life: LifeAt) -> String {
    let (life, limits) = life_and_limits(life);
    if limits.is_empty() { life } else { format!("{life} ({limits})") }
}

/// The interval between two checkpoints that contains too much of the fall of R, in words with what resolves it.
pub fn unresolved_fall(summary: &StudySummary) -> Option<String> {
    let fall = summary.unresolved_fall?;
    let [from, to] = [fall.from, fall.to].map(|cycles| count(cycles.into()));
    if fall.to - fall.from <= 1 {
        return Some(format!(
            "R falls within the one cycle from {from} to {to}, which no checkpoints resolve: lives there are interpolated or bounded."
        ));
    }
    let unworn = if fall.from == 0 { ", unless limits are exceeded unworn, in the first cycle" } else { "" };
    Some(format!(
        "The checkpoints do not resolve the fall of R between {from} and {to} cycles: lives there are interpolated or bounded. \
         `checkpoint_every = {}` resolves it{unworn}.",
        fall.checkpoint_every
    ))
}

/// The failure probability of a limit state with its 95 % interval, e.g. `1.973e-4 ± 6.2e-6`, or its bound, e.g. `< 3.0e-5`.
pub fn failure_probability(row: &ReliabilityRow, name: &str) -> String {
    let r = row.reliability.get(name).copied().unwrap_or(f64::NAN);
    let Some(ReliabilityRange { lower, upper }) = row.interval_of(name) else { return three_digits(1.0 - r) };
    if r >= 1.0 && lower < 1.0 {
        let bound = 1.0 - lower;
        return format!("< {}", if bound < 0.01 { power(bound, 1) } else { three_digits(bound) });
    }
    share(1.0 - r, 1.0 - upper, 1.0 - lower)
}

/// The reliability of a limit state with its 95 % interval, e.g. `0.3730 ± 0.0043`, or its bound, e.g. `> 0.9985`.
pub fn reliability(row: &ReliabilityRow, name: &str) -> String {
    let r = row.reliability.get(name).copied().unwrap_or(f64::NAN);
    let interval = row.interval_of(name);
    interval.map_or_else(|| fixed(r, 4), |range| format::reliability(r, range.lower, range.upper))
}

/// The reliability of every limit state, and of the system if there are several, with its 95 % interval at these checkpoints: the head
/// and a row each.
pub fn reliability_table(summary: &StudySummary, rows: &[ReliabilityRow]) -> Vec<Vec<String>> {
    let states = &summary.limit_states;
    let system = (states.len() != 1).then_some("total");
    let names = || states.iter().map(String::as_str).chain(system);
    let head = std::iter::once("cycles".to_owned()).chain(names().map(|name| format!("R {name} (95 %)")));
    let cells = |row: &ReliabilityRow| {
        std::iter::once(count(row.cycles.into())).chain(names().map(|name| reliability(row, name))).collect()
    };
    std::iter::once(head.collect()).chain(rows.iter().map(cells)).collect()
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

/// The limit state that has been the first failure of most mechanisms at each row, or has failed most where first failures are not known:
/// (cycles from, name), one entry per change of the leader; the cycles are those of the first checkpoint where it leads.
pub fn leaders(summary: &StudySummary) -> Vec<(u32, &str)> {
    let mut leaders: Vec<(u32, &str)> = Vec::new();
    for row in &summary.reliability {
        let first = summary.first_failure.iter().find(|first| first.cycles == row.cycles);
        let failed = |name: &str| match first {
            Some(first) => first.first.get(name).copied().unwrap_or(0.0),
            None => 1.0 - row.reliability.get(name).copied().unwrap_or(1.0),
        };
        // Once nearly all have failed in every mode, the shares may be equal and no mode leads.
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
    use crate::results::life_summary::LifeCurveRow;
    use crate::results::summary::FirstFailureRow;
    use crate::tests::test_study;

    fn summary(curves: &[(&str, &[f64])]) -> StudySummary {
        let mut summary = test_study::study().summary;
        summary.lives.clear();
        summary.first_failure.clear();
        summary.limit_states =
            curves.iter().map(|(name, _)| name.to_string()).filter(|n| n != "total").collect();
        summary.reliability = (0..curves[0].1.len())
            .map(|k| ReliabilityRow {
                cycles: 1000 * (k as u32 + 1),
                reliability: curves.iter().map(|(name, r)| (name.to_string(), r[k])).collect(),
                standard_error: curves.iter().map(|(name, _)| (name.to_string(), 0.1 / 1.96)).collect(),
                ..ReliabilityRow::default()
            })
            .collect();
        summary
    }

    /// A life of 2400 cycles at R = 0.5.
    fn with_life(cycles: Option<f64>, lower: f64, upper: Option<f64>) -> StudySummary {
        let mut summary = summary(&[("wear", &[1.0, 0.8, 0.4]), ("total", &[1.0, 0.8, 0.4])]);
        summary.lives = vec![LifeRow {
            limit_state: "total".into(),
            reliability: 0.5,
            cycles,
            interval: CyclesRange { lower: 2380.0, upper: Some(2420.0) },
            with_numerical_error: Some(CyclesRange { lower, upper }),
        }];
        summary
    }

    fn text(summary: &StudySummary) -> (String, String) {
        let (life, limits) = life_and_limits(life_at(summary, "total", 0.5));
        (life.replace('\u{a0}', " "), limits.replace('\u{a0}', " "))
    }

    #[test]
    fn a_life_contains_the_numerical_error_and_has_the_digits_of_its_interval() {
        let known = with_life(Some(2403.7), 2301.2, Some(2512.9));
        assert_eq!(text(&known), ("2 400".into(), "2 300 to 2 510".into()));
        let LifeAt::Cycles { lower, .. } = life_at(&known, "total", 0.5) else { panic!() };
        assert_eq!(lower, 2301.2);
        assert_eq!(
            text(&with_life(Some(2403.7), 1100.0, Some(3900.0))),
            ("2 400".into(), "1 100 to 3 900".into())
        );
    }

    #[test]
    fn what_the_checkpoints_do_not_resolve_is_a_bound() {
        assert_eq!(text(&with_life(None, 0.0, Some(3000.0))).0, "before 3 000");
        assert_eq!(text(&with_life(None, 2000.0, Some(2999.5))).0, "2 000 to 3 000");
        // Without stored lives the checkpoints are the limits.
        let mut old = with_life(None, 0.0, None);
        old.lives.clear();
        assert_eq!(life_at(&old, "total", 0.5), LifeAt::Between { lower: 2000.0, upper: Some(3000.0) });
        assert_eq!(life_at(&old, "total", 0.2), LifeAt::Beyond { lower: 3000.0, end: 3000.0 });
        assert_eq!(governing(&old).unwrap().cycles, 3000);
        assert_eq!(unresolved_fall(&old), None);
        old.unresolved_fall = Some(crate::results::life_summary::UnresolvedFall {
            from: 2000,
            to: 3000,
            checkpoint_every: 200,
        });
        assert!(unresolved_fall(&old).unwrap().contains("`checkpoint_every = 200` resolves it"));
        let cycle = crate::results::life_summary::UnresolvedFall { from: 0, to: 1, checkpoint_every: 1 };
        old.unresolved_fall = Some(cycle);
        let said = unresolved_fall(&old).unwrap();
        assert!(said.contains("no checkpoints resolve") && !said.contains("checkpoint_every"), "{said}");
        assert_eq!(text(&with_life(None, 0.0, Some(0.0))), ("failed unworn".into(), String::new()));
    }

    #[test]
    fn issue_mechanisms_that_all_fail_unworn_lived_after_0_cycles() {
        let mut summary = with_life(None, 0.0, None);
        summary.curves = vec![LifeCurveRow {
            limit_state: "total".into(),
            cycles: vec![0.0, 3000.0],
            reliability: vec![0.0; 2],
            lower: vec![0.0; 2],
            upper: vec![0.63; 2],
            ..LifeCurveRow::default()
        }];
        assert_eq!(text(&summary), ("failed unworn".into(), "to beyond the life studied".into()));
        let said = crate::presentation::terminal::final_text(&summary, std::path::Path::new("out"));
        assert!(said.contains("life at R = 0.5: failed unworn (95 % interval to beyond"), "{said}");
        let (card, below) = crate::presentation::report::words::life(&summary, 0.5);
        assert_eq!((&*card, &*below), ("failed unworn", "95 % interval to beyond the life studied"));
    }

    #[test]
    fn the_lead_changes_where_another_mode_has_more_failures() {
        let summary = summary(&[
            ("wear", &[1.0, 0.9, 0.6, 0.0]),
            ("asymmetry", &[1.0, 1.0, 0.3, 0.0]),
            ("total", &[1.0, 0.9, 0.2, 0.0]),
        ]);
        assert_eq!(leaders(&summary), [(2000, "wear"), (3000, "asymmetry")]);
        // The first failures count, not all of a mode as if it were alone.
        let first = |cycles: u32, wear: f64, asymmetry: f64| FirstFailureRow {
            cycles,
            together: 0.0,
            first: [("wear".to_owned(), wear), ("asymmetry".to_owned(), asymmetry)].into(),
        };
        let rows = vec![first(2000, 0.1, 0.0), first(3000, 0.4, 0.4), first(4000, 0.6, 0.4)];
        let found = StudySummary { first_failure: rows, ..summary.clone() };
        assert_eq!(leaders(&found), [(2000, "wear")]);
        assert_eq!(rows_that_matter(&summary, 0).len(), 4);
    }

    #[test]
    fn nothing_fails() {
        let summary = summary(&[("wear", &[1.0, 1.0]), ("total", &[1.0, 1.0])]);
        assert!(leaders(&summary).is_empty());
        assert_eq!(rows_that_matter(&summary, 3).len(), 2);
        let beyond = life_at(&summary, "total", 0.5);
        assert_eq!(beyond, LifeAt::Beyond { lower: 2000.0, end: 2000.0 });
    }
}
