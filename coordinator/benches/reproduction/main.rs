//! Every published number of the flapping-wing drive beside ours, as a page.
//!
//! ```sh
//! coordinator run --scene flapping-wing --out study
//! cargo run --release -p coordinator --example reproduction -- study > coordinator/doc/reproduction.md
//! ```
//!
//! Further folders of finished studies, as `NAME=DIR`, give the table of what the conclusions owe to the choices of the model. The
//! nominal mechanism is simulated here, some 15 times; no number of ours stands in this program.

mod nominal;
mod page;
mod published;
mod sensitivity;
mod study;

use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let usage = "expected the folder of a finished study of flapping-wing, then NAME=DIR of any others";
    let default = study::Finished::open("as it stands", &arguments.next().ok_or(usage)?)?;
    let others = arguments
        .map(|argument| {
            let (name, dir) = argument.split_once('=').ok_or(usage)?;
            study::Finished::open(name, dir)
        })
        .collect::<Result<Vec<_>, _>>()?;
    let first = nominal::Run::of(nominal::AS_IT_STANDS)?;
    let variants =
        nominal::VARIANTS.iter().map(|variant| nominal::Run::of(*variant)).collect::<Result<Vec<_>, _>>()?;
    print!("{}", page::page(&default, &others, &first, &variants)?);
    Ok(())
}
