//! The trade-off for programs: a line a setting with its knobs, and a line a value with its error.

use super::compare::Row;
use super::measure::Measurement;
use crate::results::output_unit::OutputUnit;
use common::accuracy::NamedAccuracy;
use common::scene::Scene;
use std::fmt::Write;

/// One line per setting: its knobs, its cost, per output its errors, per limit state what they mean for the reliability.
/// Shares and relative errors are plain numbers; an empty field has no value.
pub fn csv(scene: &Scene, rows: &[Row]) -> String {
    let mut out = String::from(
        "setting,step_tolerance,largest_step,wear_samples,cycle_jump,jump_tolerance,wear_tolerance,warm_up,seconds,steps,simulated_cycles,\
         failures,efficient,within_twice",
    );
    for output in &scene.outputs {
        for column in [
            "error",
            "error_until_limit",
            "life_cycles",
            "within",
            "within_twice",
            "median_ratio",
            "ratio_95",
            "missed_points",
        ] {
            let _ = write!(out, ",{}_{column}", output.name);
        }
    }
    let states = limit_states(scene);
    for name in &states {
        for column in [
            "lives_changed",
            "R_change",
            "R_change_cycles",
            "R_change_at_0.9",
            "R_change_at_0.5",
            "R_change_at_0.1",
        ] {
            let _ = write!(out, ",{name}_{column}");
        }
    }
    out.push('\n');
    for row in rows {
        line(&mut out, scene, &states, row);
    }
    out
}

/// Limit states, and all together where there are several.
fn limit_states(scene: &Scene) -> Vec<&str> {
    let names = scene.limit_states.iter().map(|limit| limit.name.as_str());
    names.chain((scene.limit_states.len() > 1).then_some("total")).collect()
}

fn line(out: &mut String, scene: &Scene, states: &[&str], row: &Row) {
    let a = &row.setting.accuracy;
    let knobs = [
        format!("\"{}\"", row.setting.name),
        format!("{:e}", a.step_tolerance),
        format!("{:e}", a.largest_step),
        a.wear_samples.to_string(),
        a.cycle_jump.to_string(),
        format!("{:e}", a.jump_tolerance),
        format!("{:e}", a.wear_tolerance),
        a.warm_up.to_string(),
        format!("{:e}", row.seconds),
        row.steps.to_string(),
        row.cycles.to_string(),
        row.failures.to_string(),
        row.efficient.to_string(),
        row.stated.within_twice.to_string(),
    ];
    out.push_str(&knobs.join(","));
    for k in 0..scene.outputs.len() {
        match row.outputs.get(k) {
            Some(o) => {
                let life = o.life.map_or_else(String::new, |cycles| cycles.to_string());
                let s = &o.stated;
                let _ = write!(
                    out,
                    ",{:e},{:e},{life},{},{},{:e},{:e},{}",
                    o.relative,
                    o.until_limit,
                    s.within,
                    s.within_twice,
                    s.median_ratio,
                    s.ratio_95,
                    s.points_missed
                );
            }
            None => out.push_str(",,,,,,,,"),
        }
    }
    for name in states {
        match row.lives.iter().find(|life| life.limit_state == *name) {
            Some(life) => {
                let _ =
                    write!(out, ",{},{},{}", life.changed, life.largest.difference(), life.largest.cycles);
                for at in life.at {
                    let _ = write!(out, ",{}", at.map_or_else(String::new, |at| at.difference().to_string()));
                }
            }
            None => out.push_str(",,,,,,"),
        }
    }
    out.push('\n');
}

/// One line per setting, point, output and checkpoint, with its reference and its stated error, in the unit of the column
/// `unit`: where the stated errors miss can be looked up here.
pub fn values_csv(scene: &Scene, settings: &[NamedAccuracy], measurement: &Measurement) -> String {
    let mut out = String::from("setting,point,output,unit,cycles,value,reference,stated_error\n");
    for (setting, points) in settings.iter().zip(&measurement.settings) {
        for (point, (measured, reference)) in points.iter().zip(&measurement.reference).enumerate() {
            let (Ok(found), Ok(reference)) = (&measured.outcome, &reference.outcome) else { continue };
            for (k, output) in scene.outputs.iter().enumerate() {
                let unit = OutputUnit::of(&output.kind);
                for (n, cycles) in found.cycles.iter().enumerate() {
                    let [value, truth, stated] =
                        [found.histories[k][n], reference.histories[k][n], found.errors[k][n]]
                            .map(|si| unit.to_file(si));
                    let _ = writeln!(
                        out,
                        "\"{}\",{point},{},{},{cycles},{value:e},{truth:e},{stated:e}",
                        setting.name,
                        output.name,
                        unit.suffix()
                    );
                }
            }
        }
    }
    out
}
