//! Outputs, limit states, life, random variables and settings as the tables of a report state them.

use super::page::{between, plain, table};
use super::scene::{place, quoted};
use std::fmt::Write;

/// Outputs, limit states, life, variables and settings.
pub fn outputs_and_study(page: &str, text: &mut String) {
    for row in table(page, "outputs") {
        let (name, of) = (&row["output"], &row["of"]);
        let body = |signed: &str| {
            let (sign, rest) = signed.split_at(1);
            let (body, label) = rest.split_once(" (").unwrap();
            let sign = if sign == "-" { -1 } else { 1 };
            format!("{{ body = \"{body}\", sign = {sign}, label = \"{}\" }}", label.trim_end_matches(')'))
        };
        if row["quantity"].starts_with("largest wear depth") {
            let joints: Vec<String> = of.split(", ").map(quoted).collect();
            writeln!(
                text,
                "[[outputs]]\nname = \"{name}\"\ntype = \"largest-wear\"\njoints = [{}]",
                joints.join(", ")
            )
            .unwrap();
        } else if row["quantity"].starts_with("largest distance of a point") {
            writeln!(text, "[[outputs]]\nname = \"{name}\"\ntype = \"position-error\"\nat = {}", place(of))
                .unwrap();
        } else {
            assert!(row["quantity"].starts_with("largest difference of angular velocity"), "{row:?}");
            let (a, b) = of.split_once("; ").unwrap();
            let (a, b) = (body(a), body(b));
            writeln!(
                text,
                "[[outputs]]\nname = \"{name}\"\ntype = \"angular-velocity-difference\"\na = {a}\nb = {b}"
            )
            .unwrap();
        }
    }
    for row in table(page, "limits") {
        let threshold = row["failed where the output is"].trim_start_matches("≥ ");
        writeln!(
            text,
            "[[limit_states]]\nname = \"{}\"\noutput = \"{}\"\nthreshold = \"{threshold}\"",
            row["limit state"], row["output"]
        )
        .unwrap();
    }
    let life = plain(between(page, "Life studied: ", "</p>")).trim_end_matches('.').to_owned();
    let cycles = life.split(" cycles").next().unwrap().replace(' ', "");
    let every = between(&life, "a checkpoint every ", " cycles").replace(' ', "");
    let settling = life.rsplit_once(": ").unwrap().1;
    let period = between(&life, " cycles of ", ", with");
    writeln!(text, "[life]\ncycles = {cycles}\ncheckpoint_every = {every}\nsettle_cycles = {settling}")
        .unwrap();
    // Without a given period a cycle is one of the drive.
    if !period.ends_with(", the period of the drive") {
        writeln!(text, "period = \"{period}\"").unwrap();
    }
    text.push_str("[study]\n");
    // Direct simulation has no settings of learning.
    for row in table(page, "settings").iter().filter(|row| row["setting"] != "samples") {
        let value = match row["setting"].as_str() {
            "accuracy" => quoted(&row["value"]),
            "levels" => format!("[{}]", row["value"].split(", ").map(quoted).collect::<Vec<_>>().join(", ")),
            _ => row["value"].clone(),
        };
        writeln!(text, "{} = {value}", row["setting"]).unwrap();
    }
    for row in table(page, "variables") {
        let unit = if row["unit"] == "1" { String::new() } else { format!(" {}", row["unit"]) };
        let value = |cell: &str| {
            let text = if cell.parse::<f64>().is_ok() { format!("{cell}{unit}") } else { cell.to_owned() };
            if text.parse::<f64>().is_ok() { text } else { quoted(&text) }
        };
        let changes: Vec<String> = row["sets"].split(", ").map(quoted).collect();
        writeln!(
            text,
            "[[variables]]\nname = \"{}\"\nchanges = [{}]\ndistribution = \"{}\"\nmean = {}\nstd = {}",
            row["variable"],
            changes.join(", "),
            row["distribution"],
            value(&row["mean"]),
            value(&row["std"])
        )
        .unwrap();
        // "1" denotes a plain number.
        if row["unit"] != "1" {
            writeln!(text, "unit = \"{}\"", row["unit"]).unwrap();
        }
        let reach = row["upper bound"].strip_prefix("mean + ").and_then(|rest| rest.strip_suffix(" std"));
        match reach {
            Some(reach) => writeln!(text, "truncation = {reach}").unwrap(),
            None if row["lower bound"].starts_with('–') || row["lower bound"] == "—" => {}
            // The bounds of a truncated normal are keys, those of a lognormal its nature.
            None if row["distribution"] == "lognormal" => {}
            None => {
                let (lower, upper) = (value(&row["lower bound"]), value(&row["upper bound"]));
                writeln!(text, "lower = {lower}\nupper = {upper}").unwrap();
            }
        }
    }
    assert!(table(page, "correlations").is_empty());
}
