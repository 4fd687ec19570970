//! Intervals of a changed scene where most of its population lies outside the simulated region.
//!
//! A surrogate states its own error, which supposes that the response goes on as inside. If the share s of the population [1]
//! outside is large, that supposition decides R. Then nothing is taken as known there: all or none of these units may fail,
//!
//!   R - s <= R(n) <= R + s, within 0 and 1,
//!
//! and a life lies where these limits fall to its level. The same convention bounds a share that cannot be simulated.

use crate::analyses::paired_results::reached;
use crate::results::life_summary::{CyclesRange, LifeCurveRow};
use crate::results::summary::{ReliabilityRange, StudySummary};

/// Widens the 95 % intervals of R and of the lives of `summary` by a share of unknown units [1].
pub(super) fn widen(summary: &mut StudySummary, share: f64) {
    let down = |r: &mut f64| *r = (*r - share).max(0.0);
    let up = |r: &mut f64| *r = (*r + share).min(1.0);
    for row in &mut summary.reliability {
        let names: Vec<String> = row.reliability.keys().cloned().collect();
        for name in names {
            let Some(ReliabilityRange { mut lower, mut upper }) = row.interval_of(&name) else { continue };
            down(&mut lower);
            up(&mut upper);
            row.numerical.remove(&name);
            row.interval.insert(name, ReliabilityRange { lower, upper });
        }
    }
    for curve in &mut summary.curves {
        curve.lower.iter_mut().chain(&mut curve.numerical_lower).for_each(down);
        curve.upper.iter_mut().chain(&mut curve.numerical_upper).for_each(up);
    }
    for life in &mut summary.lives {
        let of_life = |curve: &&LifeCurveRow| curve.limit_state == life.limit_state;
        let Some(curve) = summary.curves.iter().find(of_life) else { continue };
        let range = |lower: &[f64], upper: &[f64], end: f64| CyclesRange {
            lower: reached(&curve.cycles, lower, life.reliability).unwrap_or(end),
            upper: reached(&curve.cycles, upper, life.reliability),
        };
        life.interval = range(&curve.lower, &curve.upper, life.interval.lower);
        if let Some(with) = &mut life.with_numerical_error
            && !curve.numerical_lower.is_empty()
        {
            *with = range(&curve.numerical_lower, &curve.numerical_upper, with.lower);
        }
    }
}
