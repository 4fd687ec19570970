//! Every published number of the flapping-wing drive beside ours, as a page.
//!
//! ```sh
//! coordinator run --scene flapping-wing --out study
//! coordinator run --scene flapping-wing-experiment --out tunnel
//! cargo run --release -p coordinator --example reproduction -- study 'load of both signs=tunnel' > coordinator/doc/reproduction.md
//! ```
//!
//! Further folders of finished studies, as `NAME=DIR`, give the table of what the conclusions owe to the choices of the model, or,
//! where their scene is that of the experiment, the reliability in the wind tunnel. Nominal mechanisms are simulated here, some 150
//! times; no number of ours stands in this program. With `-` in the place of the first folder, only the sections of the
//! experiment and of a kinematic asymmetry are printed; `--figure FILE` writes the figure of the bore.

mod experiment;
mod kinematic_page;
mod kinematics;
mod nominal;
mod page;
mod published;
mod sensitivity;
mod study;
mod wind_tunnel;

use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments: Vec<String> = std::env::args().skip(1).collect();
    let usage = "expected the folder of a finished study of flapping-wing, or -, then NAME=DIR of any others";
    if let Some(place) = arguments.iter().position(|argument| argument == "--figure") {
        let file = arguments.get(place + 1).ok_or("--figure needs a file")?.clone();
        arguments.drain(place..=place + 1);
        std::fs::write(file, wind_tunnel::figure(&experiment::as_it_stands()?)?)?;
    }
    let mut arguments = arguments.into_iter();
    let first = arguments.next().ok_or(usage)?;
    let others = arguments
        .map(|argument| {
            let (name, dir) = argument.split_once('=').ok_or(usage)?;
            study::Finished::open(name, dir)
        })
        .collect::<Result<Vec<_>, _>>()?;
    let (in_the_tunnel, others): (Vec<_>, Vec<_>) =
        others.into_iter().partition(|study| study.summary.scene == experiment::SCENE);
    let nominal = nominal::Run::of(nominal::AS_IT_STANDS)?;
    if first != "-" {
        let default = study::Finished::open("as it stands", &first)?;
        let variants = nominal::VARIANTS
            .iter()
            .map(|variant| nominal::Run::of(*variant))
            .collect::<Result<Vec<_>, _>>()?;
        println!("{}", page::page(&default, &others, &nominal, &variants)?);
    }
    let mut out = String::new();
    wind_tunnel::write(&mut out, &in_the_tunnel, &experiment::as_it_stands()?)?;
    kinematic_page::write(&mut out, &nominal)?;
    print!("{}", out.trim_end().to_owned() + "\n");
    Ok(())
}
