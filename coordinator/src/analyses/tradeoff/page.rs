//! The trade-off as a page in Markdown: cost and error, validity of the stated errors, and reliability.

use super::compare::SettingComparison;
use super::lives::LEVELS;
use super::stated::{REQUIRED_SHARE, TIMES};
use common::scene::Scene;
use std::fmt::Write;

/// Three tables, each with a row per setting from the fastest to the slowest; `points`: number of points measured.
pub fn table(
    scene: &Scene,
    rows: &[SettingComparison],
    reference: &SettingComparison,
    points: usize,
) -> String {
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = cost_and_error(&mut out, scene, rows, reference, points)
        .and_then(|()| stated(&mut out, scene, rows))
        .and_then(|()| reliability(&mut out, rows));
    out
}

fn by_time(rows: &[SettingComparison]) -> Vec<&SettingComparison> {
    let mut sorted: Vec<&SettingComparison> = rows.iter().collect();
    sorted.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
    sorted
}

fn shown_name(row: &SettingComparison) -> String {
    let name = &row.setting.name;
    let name = if row.setting.is_preset() { format!("**{name}**") } else { name.clone() };
    if row.efficient { format!("{name} *") } else { name }
}

fn cost_and_error(
    out: &mut String,
    scene: &Scene,
    rows: &[SettingComparison],
    reference: &SettingComparison,
    points: usize,
) -> std::fmt::Result {
    writeln!(out, "Accuracy settings of `{}`, against `reference`, at {points} points.\n", scene.name)?;
    writeln!(
        out,
        "Error: largest difference over all points and checkpoints, relative to the threshold of the output's limit state or \
         to its largest value; in brackets, only up to where the reference reaches that limit. Life: largest change of the \
         life at which the limit is reached. A star marks the Pareto front of time and error. The last row is the \
         reference with its own stated error. All have the control points of the scene: what more of them change is not in these errors.\n"
    )?;
    write!(out, "| setting | s | steps | cycles |")?;
    for output in &scene.outputs {
        write!(out, " {} | life |", output.name)?;
    }
    writeln!(out, "\n|---|---|---|---|{}", "---|---|".repeat(scene.outputs.len()))?;
    for row in by_time(rows).into_iter().chain([reference]) {
        let name = shown_name(row);
        write!(out, "| {name} | {:.3} | {:.0} | {:.0} |", row.seconds, row.steps, row.cycles)?;
        if row.outputs.is_empty() {
            write!(out, "{}", " failed | |".repeat(scene.outputs.len()))?;
        }
        for o in &row.outputs {
            let life = o.life.map_or_else(|| "-".to_owned(), |cycles| format!("{cycles:.0} cycles"));
            let (all, until) = (percent(o.relative), percent(o.until_limit));
            let until = if all == until { String::new() } else { format!(" ({until})") };
            write!(out, " {all}{until} | {life} |")?;
        }
        writeln!(out)?;
    }
    let failed = rows.iter().chain([reference]).filter(|row| row.failures > 0);
    let failed: Vec<String> = failed.map(|row| format!("{} at {}", row.setting.name, row.failures)).collect();
    if !failed.is_empty() {
        writeln!(out, "\nWithout a result, and excluded there: {} of {points} points.", failed.join(", "))?;
    }
    writeln!(out)
}

fn percent(share: f64) -> String {
    format!("{:.3} %", 100.0 * share)
}

/// Validity of the stated errors.
fn stated(out: &mut String, scene: &Scene, rows: &[SettingComparison]) -> std::fmt::Result {
    writeln!(
        out,
        "Stated errors: share of the values whose true error is within the stated one, and within {TIMES} times the stated \
         one, which must hold for {:.0} %; median and 95 % quantile of true over stated error; number of values beyond \
         {TIMES} times the stated error in the first, second and last third of life, and number of points with such \
         values; the worst of them.\n",
        100.0 * REQUIRED_SHARE
    )?;
    writeln!(
        out,
        "| setting | output | within | within twice | | median | 95 % | missed by thirds of life | points | worst |\n\
         |---|---|---|---|---|---|---|---|---|---|"
    )?;
    for row in by_time(rows) {
        let each = scene.outputs.iter().zip(&row.outputs).map(|(o, e)| (o.name.as_str(), &e.stated));
        let all = (row.outputs.len() > 1).then_some(("all", &row.stated));
        for (name, s) in each.chain(all) {
            let verdict = if s.holds() { "holds" } else { "DOES NOT HOLD" };
            let [first, second, last] = s.missed;
            let worst = s.worst.map_or_else(
                || "-".to_owned(),
                |w| format!("{:.2} times, point {}, {} cycles", w.ratio(), w.point, w.cycles),
            );
            writeln!(
                out,
                "| {} | {name} | {:.1} % | {:.1} % | {verdict} | {:.3} | {:.3} | {first}, {second}, {last} of {} | {} | {worst} |",
                row.setting.name,
                100.0 * s.within,
                100.0 * s.within_twice,
                s.median_ratio,
                s.ratio_95,
                s.values,
                s.points_missed
            )?;
        }
    }
    writeln!(out)
}

/// Effect of the errors on the reliability.
fn reliability(out: &mut String, rows: &[SettingComparison]) -> std::fmt::Result {
    let Some(first) = rows.iter().find_map(|row| row.lives.first()) else { return Ok(()) };
    writeln!(
        out,
        "Reliability: share of the {} random points that fail at another checkpoint than with the reference, and reliability \
         R of these points minus that of the reference: where it differs most, and where R of the reference is nearest \
         {}, {} and {}.\n",
        first.points, LEVELS[0], LEVELS[1], LEVELS[2]
    )?;
    writeln!(
        out,
        "| setting | limit state | lives changed | largest | at R = {} | at R = {} | at R = {} |\n|---|---|---|---|---|---|---|",
        LEVELS[0], LEVELS[1], LEVELS[2]
    )?;
    for row in by_time(rows) {
        for life in &row.lives {
            write!(
                out,
                "| {} | {} | {:.1} % | {:+.2} at {} |",
                row.setting.name,
                life.limit_state,
                100.0 * life.changed,
                life.largest.difference(),
                life.largest.cycles
            )?;
            for level in life.at_levels {
                match level {
                    Some(r) => write!(out, " {:+.3} ({:.2} at {}) |", r.difference(), r.reference, r.cycles)?,
                    None => write!(out, " - |")?,
                }
            }
            writeln!(out)?;
        }
    }
    Ok(())
}
