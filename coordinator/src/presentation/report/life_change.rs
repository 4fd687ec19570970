//! The change of a life in words: the best estimate with its 95 % interval, or what is known of it where one of the lives is
//! only bounded.

use super::format::rounded_cycles;
use super::life::{LifeAt, life_at};
use crate::results::summary::StudySummary;
use crate::statistics::reliability::paired::{Change, IntervalEstimate, OtherErrors, change};

/// The change from `before` to `after` of a life, e.g. `+910 (700 to 1 120)` [cycles]; `known` is its estimate where both lives
/// are resolved.
pub fn change_of_life(known: Option<Change>, before: LifeAt, after: LifeAt) -> String {
    known.map_or_else(|| bound(before, after), |change| in_cycles(&change))
}

/// The change of a life between two studies with independent samples, of the curve `name` at `level`, and in words; `None` where
/// one of the lives is not resolved. All errors are taken as independent.
pub fn change_between(
    [before, after]: [&StudySummary; 2],
    (name, level): (&str, f64),
) -> (Option<Change>, String) {
    let [before, after] = [before, after].map(|summary| life_at(summary, name, level));
    let estimate = |life: LifeAt| match life {
        LifeAt::Cycles { life, lower, upper } => {
            // Without a correlation the part of sampling plays no role.
            Some(IntervalEstimate { value: life, lower, upper, sampling: 0.0 })
        }
        LifeAt::Unworn { .. } | LifeAt::Between { .. } | LifeAt::Beyond { .. } => None,
    };
    let known = estimate(before)
        .zip(estimate(after))
        .map(|(before, after)| change(before, after, 0.0, OtherErrors::Independent));
    (known, change_of_life(known, before, after))
}

fn in_cycles(change: &Change) -> String {
    let ends = [change.lower, change.upper];
    let width = ends.iter().flatten().map(|end| (end - change.value).abs()).fold(0.0, f64::max);
    let shown = |value: f64| {
        let text = rounded_cycles(value.abs(), width);
        match value {
            v if v < 0.0 && text != "0" => format!("\u{2212}{text}"),
            v if v > 0.0 && text != "0" => format!("+{text}"),
            _ => text,
        }
    };
    let value = shown(change.value);
    match ends.map(|end| end.map(shown)) {
        [Some(lower), Some(upper)] => format!("{value} ({lower} to {upper})"),
        [Some(lower), None] => format!("{value} (at least {lower})"),
        [None, Some(upper)] => format!("{value} (at most {upper})"),
        [None, None] => value,
    }
}

/// What is known of a change of life where one of the lives is only bounded.
fn bound(before: LifeAt, after: LifeAt) -> String {
    let (sign, change) = match (before, after) {
        (LifeAt::Cycles { upper: Some(upper), .. }, LifeAt::Beyond { lower, .. }) if lower > upper => {
            ('+', lower - upper)
        }
        (LifeAt::Beyond { lower, .. }, LifeAt::Cycles { upper: Some(upper), .. }) if lower > upper => {
            ('\u{2212}', lower - upper)
        }
        _ => return "not known".to_owned(),
    };
    format!("more than {sign}{}", rounded_cycles(change, 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cycles(life: f64, half: f64) -> LifeAt {
        LifeAt::Cycles { life, lower: life - half, upper: Some(life + half) }
    }

    #[test]
    fn changes_have_signs_and_intervals_and_bounds_where_a_life_is_not_resolved() {
        let known = Change { value: 912.0, lower: Some(700.0), upper: Some(1124.0) };
        let said = change_of_life(Some(known), cycles(5000.0, 10.0), cycles(5912.0, 10.0));
        assert_eq!(said, "+910 (+700 to +1\u{a0}120)");
        let beyond = LifeAt::Beyond { lower: 8000.0, end: 8000.0 };
        assert_eq!(change_of_life(None, cycles(5000.0, 500.0), beyond), "more than +2\u{a0}500");
        assert_eq!(change_of_life(None, beyond, cycles(5000.0, 500.0)), "more than \u{2212}2\u{a0}500");
        assert_eq!(change_of_life(None, beyond, beyond), "not known");
    }
}
