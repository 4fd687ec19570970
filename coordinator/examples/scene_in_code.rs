//! A chain of pendulums built in a loop and simulated: `cargo run --release -p coordinator --example scene_in_code`
//!
//! A scene is text; the parser checks it as it checks a file, and reports all faults at once.

use common::accuracy::Accuracy;
use common::scene::SceneSource;
use std::fmt::Write;
use worker::simulate::{SimulateOptions, simulate};

fn chain(links: usize) -> Result<SceneSource, Box<dyn std::error::Error>> {
    let mut text = format!(
        "gravity = ['0 m/s^2', '-9.81 m/s^2']\n\
         scene = {{ name = 'chain-of-{links}' }}\n\
         life = {{ period = '2 s', cycles = 1, checkpoint_every = 1, settle_cycles = 0 }}\n\
         outputs = [{{ name = 'force', type = 'peak-joint-force', joints = ['hinge1'] }}]\n\
         [[bodies]]\nname = 'link0'\nmotion = 'fixed'\npoints = {{ end = ['0 m', '0 m'] }}\n"
    );
    for k in 1..=links {
        let (before, x) = (k - 1, 0.1 * (k - 1) as f64);
        // Links of 100 mm and 50 g, released from the horizontal.
        write!(
            text,
            "[[bodies]]\nname = 'link{k}'\nmotion = 'free'\nmass = '50 g'\ninertia = '4.2e-5 kg m^2'\n\
             centre_of_mass = ['50 mm', '0 mm']\nstart_position = ['{x} m', '0 m']\nstart_angle = '0 deg'\n\
             points = {{ start = ['0 m', '0 m'], end = ['100 mm', '0 m'] }}\n\
             [[joints]]\nname = 'hinge{k}'\ntype = 'revolute'\n\
             a = {{ body = 'link{k}', point = 'start' }}\nb = {{ body = 'link{before}', point = 'end' }}\n"
        )?;
    }
    Ok(SceneSource::parse(&text, "chain")?)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for links in 1..=4 {
        let source = chain(links)?;
        let evaluation = simulate(source.nominal(), &Accuracy::balanced(), SimulateOptions::default())?;
        println!("{links} links: largest force {:.2} N at the support", evaluation.histories[0][0]);
    }
    Ok(())
}
