//! The trade-off as a page in Markdown: cost and error, whether the stated errors hold, and the reliability.

use super::compare::Row;
use super::lives::LEVELS;
use super::stated::{REQUIRED_SHARE, TIMES};
use common::scene::Scene;
use std::fmt::Write;

/// Three tables, each with a row per setting from the quickest to the slowest; `points` is how many were measured.
pub fn table(scene: &Scene, rows: &[Row], reference: &Row, points: usize) -> String {
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = cost_and_error(&mut out, scene, rows, reference, points)
        .and_then(|()| stated(&mut out, scene, rows))
        .and_then(|()| reliability(&mut out, rows));
    out
}

fn by_time(rows: &[Row]) -> Vec<&Row> {
    let mut sorted: Vec<&Row> = rows.iter().collect();
    sorted.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
    sorted
}

fn shown_name(row: &Row) -> String {
    let name = &row.setting.name;
    let name = if row.setting.is_preset() { format!("**{name}**") } else { name.clone() };
    if row.efficient { format!("{name} *") } else { name }
}

fn cost_and_error(
    out: &mut String,
    scene: &Scene,
    rows: &[Row],
    reference: &Row,
    points: usize,
) -> std::fmt::Result {
    writeln!(out, "Accuracy settings of `{}`, against `reference`, at {points} points.\n", scene.name)?;
    writeln!(
        out,
        "Error: largest difference over all points and checkpoints, of the threshold of the output's limit state or of its \
         largest value; in brackets, only up to where the reference reaches that limit. Life: by how much the life at which \
         the limit is reached is displaced at most. A star marks settings that no other beats in both time and \
         error. The last row is the reference with the error that it states of itself.\n"
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
        writeln!(out, "\nWithout a result, and left out there: {} of {points} points.", failed.join(", "))?;
    }
    writeln!(out)
}

fn percent(share: f64) -> String {
    format!("{:.3} %", 100.0 * share)
}

/// Whether the stated errors hold.
fn stated(out: &mut String, scene: &Scene, rows: &[Row]) -> std::fmt::Result {
    writeln!(
        out,
        "Stated errors: share of the values whose true error is within the error that the evaluation states of itself, and \
         within {TIMES} times that, which {:.0} % must be; true over stated error of the value in the middle, and the one \
         that 95 % do not exceed; where the values beyond {TIMES} times are: in the first, second and last third of life, \
         and at how many points; the worst of them.\n",
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

/// What the errors mean for the reliability.
fn reliability(out: &mut String, rows: &[Row]) -> std::fmt::Result {
    let Some(first) = rows.iter().find_map(|row| row.lives.first()) else { return Ok(()) };
    writeln!(
        out,
        "Reliability: share of the {} random points that fail at another checkpoint than by the reference, and reliability \
         R of these points less that by the reference: where it differs most, and where R of the reference is nearest \
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
            for at in life.at {
                match at {
                    Some(at) => {
                        write!(out, " {:+.3} ({:.2} at {}) |", at.difference(), at.reference, at.cycles)?
                    }
                    None => write!(out, " - |")?,
                }
            }
            writeln!(out)?;
        }
    }
    Ok(())
}
