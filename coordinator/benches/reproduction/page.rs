//! The page, in Markdown.

use super::nominal::Run;
use super::published::{Goal, Number, Ours, Standing, sections};
use super::sensitivity;
use super::study::Finished;
use std::fmt::Write;

const OPENING: &str = "# The published drive and the built-in one

[Contents](README.md)

Published: Cui et al., Reliability Analysis for Driving Mechanisms of Flapping-wing Aircrafts Considering Competitive Failure and
Multi-source Uncertainty, China Mechanical Engineering 37(6), 2026, 1472-1485, doi 10.3969/j.issn.1004-132X.2026.06.020. This page is written by a
program:

```sh
coordinator run --scene flapping-wing --out study
coordinator run --scene flapping-wing --set parameters.film_damping='7.3124 N s/m' --out damped
sed s/local-hertz/foundation/ common/scenes/flapping-wing.toml > foundation.toml
coordinator run --scene foundation.toml --out foundation
coordinator run --scene flapping-wing-experiment --out tunnel
coordinator run --scene flapping-wing-experiment --set load_flow=1m/s --set load_drag='1.324 N s/m' --out one-sign
cargo run --release -p coordinator --example reproduction -- study 'film damping 1 % more=damped' 'contact law `foundation`=foundation' 'load of both signs=tunnel' 'load of one sign=one-sign' --figure coordinator/doc/experiment.svg > coordinator/doc/reproduction.md
```

`flapping-wing` is a reconstruction: the publication names the mechanism, its materials, its loads in words and its results, but not all
dimensions, masses, loads and dampings. What was not published was chosen or calibrated so that the published results follow. **Rows
marked *fitted* were targets of that calibration: their agreement shows that the model can reproduce them, not that it predicts them.** Rows
marked *free* were not targets.

";

/// The page of the drive of the simulations.
pub fn page(
    study: &Finished,
    others: &[Finished],
    nominal: &Run,
    variants: &[Run],
) -> Result<String, Box<dyn std::error::Error>> {
    let mut out = String::from(OPENING);
    let ours = Ours { study, nominal };
    for section in sections() {
        writeln!(out, "## {}\n\n{HEAD}", section.title)?;
        for row in &section.rows {
            write_number(&mut out, &row.number, (row.ours)(&ours))?;
        }
        writeln!(out)?;
    }
    bores(&mut out, nominal)?;
    sensitivity::write(&mut out, study)?;
    owed(&mut out, study, others, nominal, variants)?;
    Ok(out)
}

/// Head of a table of published numbers.
pub const HEAD: &str =
    "| | published | ours | difference | aimed at | | why |\n|---|---|---|---|---|---|---|";

/// A line of that table: a published number beside ours.
pub fn write_number(out: &mut String, row: &Number, ours: Option<f64>) -> std::fmt::Result {
    let unit = if row.unit.is_empty() { String::new() } else { format!(" {}", row.unit) };
    let digits = row.decimals;
    let standing = match row.standing {
        Standing::Fitted => "fitted",
        Standing::Free => "free",
    };
    let (found, difference) = match ours {
        None => ("none".to_owned(), String::new()),
        Some(ours) => {
            let difference = ours - row.published;
            let shown = match row.goal {
                Goal::Relative(_) => format!("{:+.1} %", 100.0 * difference / row.published),
                _ => format!("{difference:+.digits$}"),
            };
            (format!("{ours:.digits$}{unit}"), shown)
        }
    };
    let within = |met: bool| if met { "met" } else { "MISSED" };
    let off = ours.map_or(f64::INFINITY, |ours| (ours - row.published).abs());
    let aim = match row.goal {
        Goal::None => String::new(),
        Goal::Absolute(most) => format!("{most}{unit}, {}", within(off <= most)),
        Goal::Relative(most) => {
            format!("{} %, {}", 100.0 * most, within(off <= most * row.published.abs()))
        }
    };
    writeln!(
        out,
        "| {} | {:.digits$}{unit} | {found} | {difference} | {aim} | {standing} | {} |",
        row.what, row.published, row.why
    )
}

fn bores(out: &mut String, nominal: &Run) -> std::fmt::Result {
    writeln!(
        out,
        "## Worn bores\n\nThe nominal drive after 72 000 cycles, at angles counter-clockwise in the frame of the bushing:\n\n| joint | deepest | second peak |\n|---|---|---|"
    )?;
    for (joint, peaks) in nominal.bores() {
        let shown = |k: usize| {
            peaks.get(k).map_or("none".to_owned(), |(angle, depth)| {
                format!("{:.4} mm at {angle:.0} deg", 1e3 * depth)
            })
        };
        writeln!(out, "| {joint} | {} | {} |", shown(0), shown(1))?;
    }
    writeln!(
        out,
        "\nThe simulated load has one direction through the whole cycle, as the single published force peak \
         requires, so every bore wears on one side; that of a load that changes its sign is in \
         [the experiment](#the-experiment). The two joints at the crank wear deepest, because \
         their journal makes a full turn in every cycle.\n"
    )
}

/// What follows from choices of the model.
fn owed(
    out: &mut String,
    study: &Finished,
    others: &[Finished],
    nominal: &Run,
    variants: &[Run],
) -> std::fmt::Result {
    writeln!(
        out,
        "## Influence of modelling choices\n\nThe nominal drive with one choice changed: largest wear and \
         angular-velocity difference at \
         64, 66 and 68 thousand cycles.\n\n\
         | | wear | | | difference | | |\n|---|---|---|---|---|---|---|\n\
         | | 64 000 | 66 000 | 68 000 | 64 000 | 66 000 | 68 000 |"
    )?;
    for run in std::iter::once(nominal).chain(variants) {
        write!(out, "| {} ", run.variant.name)?;
        for cycles in LIVES {
            write!(out, "| {:.5} mm ", 1e3 * run.value(0, cycles))?;
        }
        for cycles in LIVES {
            write!(out, "| {:.3} r/min ", run.value(1, cycles) * 30.0 / std::f64::consts::PI)?;
        }
        writeln!(out, "|")?;
    }
    let passes = |points| {
        let with_points = variants.iter().find(|run| run.variant.points() == Some(points));
        with_points.unwrap_or(nominal).life_to(1, 25.0 * std::f64::consts::PI / 30.0)
    };
    writeln!(
        out,
        "\n- The contact law decides the failure mode. `local-hertz` is the published law: the whole load \
         acts at one point, and a vibration of the rockers grows as the bores wear. On an elastic foundation \
         the bores carry the load along an arc, wear more, and the asymmetry keeps its initial value.\n\
         - So do the 36 control points of the published bores: under `local-hertz` the vibration sets in earlier \
         with more of them, and the difference does not converge with their number. With 144 the nominal drive passes \
         25 r/min at {early} cycles, with 36 at {late}. The published failure by asymmetry is a property of that law \
         and of these points; the scene declares the points a part of its model, and its stated errors leave \
         them out. The wear converges.\n\
         - Film damping decides when the vibration sets in. Of the published results only the asymmetry \
         curve determines it: it was fitted to that curve.\n\
         - Numerical effort moves the difference by up to {} r/min from that of `reference`: which variant \
         deviates in which direction is random, as it is from one drive to the next (see \
         [reliability.md](reliability.md)). Wear moves by up to {} um.",
        shown(numerical(nominal, variants, 1, 30.0 / std::f64::consts::PI)),
        shown(numerical(nominal, variants, 0, 1e6)),
        early = passes(144),
        late = passes(36),
    )?;
    if !others.is_empty() {
        writeln!(
            out,
            "\nWhole studies with one choice changed:\n\n| | simulations | R of wear | | | R of asymmetry | \
             | |\n|---|---|---|---|---|---|---|---|\n\
             | | | 64 000 | 66 000 | 68 000 | 64 000 | 66 000 | 68 000 |"
        )?;
        for study in std::iter::once(study).chain(others) {
            write!(out, "| {} | {} ", study.name, study.summary.evaluations.total)?;
            for key in ["wear", "asymmetry"] {
                for cycles in LIVES {
                    write!(out, "| {:.4} ", study.reliability(key, cycles).unwrap_or(f64::NAN))?;
                }
            }
            writeln!(out, "|")?;
        }
        studies_over_life(out, study, others)?;
    }
    Ok(())
}

/// Lives of whole studies with their 95 % intervals, and R of the system at the checkpoints where it falls.
fn studies_over_life(out: &mut String, study: &Finished, others: &[Finished]) -> std::fmt::Result {
    writeln!(
        out,
        "\nThe same studies over life: thousands of cycles at which R of the system reaches a level, with the 95 % interval, which \
         contains the stated numerical errors, and R of the system where it falls:\n\n\
         | | R = 0.99 | R = 0.9 | R = 0.5 | thousand cycles: R |\n|---|---|---|---|---|"
    )?;
    for study in std::iter::once(study).chain(others) {
        write!(out, "| {} ", study.name)?;
        write_lives(out, study)?;
    }
    Ok(())
}

/// The end of a line: lives of a study at three levels, and R where it falls.
pub fn write_lives(out: &mut String, study: &Finished) -> std::fmt::Result {
    for level in [0.99, 0.9, 0.5] {
        match study.life(level) {
            Some([life, lower, upper]) => write!(out, "| {life:.2} ({lower:.2} to {upper:.2}) ")?,
            None => write!(out, "| ")?,
        }
    }
    let curve: Vec<String> = study.fall().map(|(life, r)| format!("{:.0}: {r:.4}", life / 1e3)).collect();
    writeln!(out, "| {} |", curve.join(", "))
}

fn shown(value: Option<f64>) -> String {
    value.map_or("?".to_owned(), |value| format!("{value:.2}"))
}

/// Largest distance of an output from that of `reference` at any of the lives, over what differs from it in numerical effort alone.
fn numerical(nominal: &Run, variants: &[Run], output: usize, unit: f64) -> Option<f64> {
    let reference = variants.iter().find(|run| run.variant.name == "`reference`")?;
    let same_model =
        std::iter::once(nominal).chain(variants.iter().filter(|run| run.variant.accuracy.is_some()));
    let distance = |run: &Run| {
        let off = |life: &u32| unit * (run.value(output, *life) - reference.value(output, *life)).abs();
        LIVES.iter().map(off).fold(0.0, f64::max)
    };
    Some(same_model.map(distance).fold(0.0, f64::max))
}

const LIVES: [u32; 3] = [64_000, 66_000, 68_000];
