//! The tables of the drive of the simulations.

use super::nominal::Run;
use super::published::{Goal, Number, Ours, Standing, rows};
use super::sensitivity;
use super::study::Finished;
use super::tables::{Tables, cell, head};
use std::error::Error;
use std::f64::consts::PI;

/// [rad/s] to [r/min].
const RPM: f64 = 30.0 / PI;

/// Lives at which choices of the model are compared [cycles].
const LIVES: [u32; 3] = [64_000, 66_000, 68_000];

/// Published numbers, worn bores, sensitivities and choices of the model.
pub fn write(
    tables: &mut Tables,
    study: &Finished,
    [nominal, angles]: [&Run; 2],
    variants: &[Run],
) -> Result<(), Box<dyn Error>> {
    let ours = Ours { study, nominal, angles };
    let numbers: Vec<Vec<String>> =
        rows().iter().map(|row| number_row(&row.number, (row.ours)(&ours))).collect();
    tables.write("drive", &number_head(), &numbers)?;
    bores(tables, nominal)?;
    sensitivity::write(tables, study)?;
    choices(tables, nominal, variants)
}

/// Head of a table of published numbers.
pub fn number_head() -> Vec<String> {
    head(["quantity", "published", "ours", "unit", "difference", "goal", "standing", "reason"])
}

/// A published number beside ours.
pub fn number_row(row: &Number, ours: Option<f64>) -> Vec<String> {
    let digits = row.decimals;
    let standing = match row.standing {
        Standing::Fitted => "fitted",
        Standing::Free => "free",
    };
    let difference = ours.map_or(String::new(), |ours| {
        let difference = ours - row.published;
        match row.goal {
            Goal::Relative(_) => format!("{:+.1} %", 100.0 * difference / row.published),
            _ => format!("{difference:+.digits$}"),
        }
    });
    let within = |met: bool| if met { "met" } else { "MISSED" };
    let off = ours.map_or(f64::INFINITY, |ours| (ours - row.published).abs());
    let goal = match row.goal {
        Goal::None => String::new(),
        Goal::Absolute(most) => {
            let most_shown = format!("{most} {}", row.unit);
            format!("{}, {}", most_shown.trim_end(), within(off <= most))
        }
        Goal::AtMost => within(ours.is_some_and(|ours| ours <= row.published)).to_owned(),
        Goal::Relative(most) => format!("{} %, {}", 100.0 * most, within(off <= most * row.published.abs())),
    };
    let published = cell(Some(row.published), digits);
    let texts = [row.what, &published, &cell(ours, digits), row.unit, &difference, &goal, standing, row.why];
    texts.map(str::to_owned).to_vec()
}

/// The deepest places of the bores after 72 000 cycles, at angles counter-clockwise in the frame of the bushing.
fn bores(tables: &Tables, nominal: &Run) -> Result<(), Box<dyn Error>> {
    let row = |(joint, peaks): (&str, Vec<(f64, f64)>)| {
        let place = |k: usize| {
            let place = peaks.get(k);
            [cell(place.map(|place| 1e3 * place.1), 4), cell(place.map(|place| place.0), 0)]
        };
        [vec![joint.to_owned()], place(0).to_vec(), place(1).to_vec()].concat()
    };
    let rows: Vec<Vec<String>> = nominal.bores().into_iter().map(row).collect();
    tables.write("bores", &head(["joint", "deepest [mm]", "at [deg]", "second peak [mm]", "at [deg]"]), &rows)
}

/// The nominal drive with one choice changed: wear and angular-velocity difference, and the life at which the latter passes its limit.
fn choices(tables: &mut Tables, nominal: &Run, variants: &[Run]) -> Result<(), Box<dyn Error>> {
    let of_lives =
        |what: &str, unit: &str| LIVES.map(|life| format!("{what} at {} [{unit}]", thousands(life)));
    let heads = [
        vec!["choice".to_owned()],
        of_lives("wear", "mm").to_vec(),
        of_lives("difference", "r/min").to_vec(),
        head(["25 r/min at [cycles]", "0.03 mm at [cycles]"]),
    ];
    let row = |run: &Run| {
        let wear = LIVES.map(|life| cell(Some(1e3 * run.value(0, life)), 5));
        let difference = LIVES.map(|life| cell(Some(RPM * run.value(1, life)), 3));
        let passes = [(1, 25.0 / RPM), (0, 30e-6)].map(|(output, limit)| cell(run.life_to(output, limit), 0));
        [vec![run.variant.name.to_owned()], wear.to_vec(), difference.to_vec(), passes.to_vec()].concat()
    };
    let rows: Vec<Vec<String>> = std::iter::once(nominal).chain(variants).map(row).collect();
    tables.write("choices", &heads.concat(), &rows)?;
    let by_effort = [("difference", 1, RPM, "r/min"), ("wear", 0, 1e6, "um")];
    for (what, output, unit, name) in by_effort {
        if let Some(most) = numerical(nominal, variants, output, unit) {
            tables.derive(&format!("largest effect of numerical effort on the {what}"), (most, 2), name);
        }
    }
    Ok(())
}

/// Finished studies: R at three lives, lives of the system with their 95 % intervals, and R of the system where it falls.
pub fn studies<'a>(
    tables: &Tables,
    studies: impl Iterator<Item = &'a Finished>,
) -> Result<(), Box<dyn Error>> {
    const LEVELS: [f64; 3] = [0.99, 0.9, 0.5];
    const STATES: [&str; 2] = ["wear", "asymmetry"];
    let mut heads = head(["study", "simulations"]);
    heads.extend(
        STATES.iter().flat_map(|state| LIVES.map(|life| format!("R of {state} at {}", thousands(life)))),
    );
    heads.extend(LEVELS.iter().flat_map(|level| {
        ["life", "lower", "upper"].map(|what| format!("{what} at R = {level} [thousand cycles]"))
    }));
    heads.push("R of the system by thousand cycles".to_owned());
    let row = |study: &Finished| {
        let mut row = vec![study.name.clone(), study.summary.evaluations.total.to_string()];
        row.extend(STATES.iter().flat_map(|state| LIVES.map(|life| cell(study.reliability(state, life), 4))));
        row.extend(LEVELS.iter().flat_map(|level| {
            let life = study.life(*level);
            [0, 1, 2].map(|k| cell(life.map(|life| life[k]), 2))
        }));
        let fall: Vec<String> = study.fall().map(|(life, r)| format!("{:.0}: {r:.4}", life / 1e3)).collect();
        row.push(fall.join(", "));
        row
    };
    tables.write("studies", &heads, &studies.map(row).collect::<Vec<_>>())
}

/// A life with its thousands set apart.
pub fn thousands(life: u32) -> String {
    format!("{} 000 cycles", life / 1000)
}

/// Largest distance of an output from that of `reference` at any of the lives, over what differs from it in numerical effort alone.
fn numerical(nominal: &Run, variants: &[Run], output: usize, unit: f64) -> Option<f64> {
    let reference = variants.iter().find(|run| run.variant.name == "reference")?;
    let same_model =
        std::iter::once(nominal).chain(variants.iter().filter(|run| run.variant.accuracy.is_some()));
    let distance = |run: &Run| {
        let off = |life: &u32| unit * (run.value(output, *life) - reference.value(output, *life)).abs();
        LIVES.iter().map(off).fold(0.0, f64::max)
    };
    Some(same_model.map(distance).fold(0.0, f64::max))
}
