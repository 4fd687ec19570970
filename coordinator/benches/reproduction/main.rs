//! Every published number of the flapping-wing drive beside ours, as tables; `coordinator/doc/validation.md` states what they say.
//!
//! ```sh
//! coordinator run flapping-wing --out study
//! coordinator run flapping-wing-experiment --out tunnel
//! cargo run --release -p coordinator --example reproduction -- coordinator/doc/reproduction study 'load of both signs=tunnel'
//! ```
//!
//! Further folders of finished studies, as `NAME=DIR`, are studies with one choice of the model changed, or, where their scene is that
//! of the experiment, studies in the wind tunnel. Nominal mechanisms are simulated here, some 150 times; no number of ours stands in
//! this program. With `-` in the place of the first study, only the tables of the experiment and of a kinematic asymmetry are written;
//! `--figure FILE` writes the figure of the bore.

mod drive;
mod experiment;
mod kinematic_tables;
mod kinematics;
mod nominal;
mod published;
mod sensitivity;
mod study;
mod tables;
mod wind_tunnel;

use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments: Vec<String> = std::env::args().skip(1).collect();
    let usage = "expected a folder for the tables, that of a finished study of flapping-wing, or -, then NAME=DIR of any others";
    if let Some(place) = arguments.iter().position(|argument| argument == "--figure") {
        let file = arguments.get(place + 1).ok_or("--figure needs a file")?.clone();
        arguments.drain(place..=place + 1);
        std::fs::write(file, wind_tunnel::figure(&experiment::as_it_stands()?)?)?;
    }
    let mut arguments = arguments.into_iter();
    let mut tables = tables::Tables::in_folder(&arguments.next().ok_or(usage)?)?;
    let first = arguments.next().ok_or(usage)?;
    let others = arguments
        .map(|argument| {
            let (name, dir) = argument.split_once('=').ok_or(usage)?;
            study::Finished::open(name, dir)
        })
        .collect::<Result<Vec<_>, _>>()?;
    let nominal = nominal::Run::of(nominal::AS_IT_STANDS)?;
    let mut default = None;
    if first != "-" {
        let study = default.insert(study::Finished::open("as it stands", &first)?);
        let variants = nominal::VARIANTS
            .iter()
            .map(|variant| nominal::Run::of(*variant))
            .collect::<Result<Vec<_>, _>>()?;
        let angles = nominal::Run::of(nominal::WITH_ANGLES)?;
        drive::write(&mut tables, study, [&nominal, &angles], &variants)?;
    }
    drive::studies(&tables, default.iter().chain(&others))?;
    wind_tunnel::write(&mut tables, &experiment::as_it_stands()?)?;
    kinematic_tables::write(&mut tables, &nominal)?;
    tables.finish()
}
