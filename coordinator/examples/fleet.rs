//! The fleet of the tutorial: `cargo run --release -p coordinator --example fleet > fleet.csv`
//!
//! Twelve mechanisms of the built-in `four-bar`, which wear 2 % faster than the scene has it, are simulated at `draft`. Each is looked at
//! after a random age: it still runs, or it has failed at a life that was noted with an error of 50 cycles.

use common::accuracy::Accuracy;
use common::scene::SceneSource;
use coordinator::statistics::design::{InputModel, Population};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha12Rng;
use rand_distr::{Distribution, StandardNormal};
use worker::simulate::{SimulateOptions, simulate};

const UNITS: usize = 12;
const SEED: u64 = 12;
/// Factor on the wear coefficient, the variable of this index.
const WORN: (usize, f64) = (0, 1.02);
/// Ages at which the units are looked at, and the error of a life [cycles].
const AGES: std::ops::Range<f64> = 5000.0..7000.0;
const ERROR: f64 = 50.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let source = SceneSource::builtin("four-bar")?;
    let scene = source.nominal();
    let limit = &scene.limit_states[0];
    let cycles: Vec<f64> = scene.life.checkpoints().into_iter().map(f64::from).collect();
    let units = Population::draw(InputModel::from_scene(scene), UNITS, SEED);
    let mut rng = ChaCha12Rng::seed_from_u64(SEED);
    println!("unit,cycles,quantity,value,error");
    for unit in 0..UNITS {
        let mut sample = units.physical(unit);
        sample[WORN.0] *= WORN.1;
        let own = source.resolve_sample(&sample)?;
        let wear = &simulate(&own, &Accuracy::draft(), SimulateOptions::default())?.histories[limit.output];
        let failed = wear.iter().position(|depth| limit.is_reached(*depth));
        // The wear is linear between two checkpoints.
        let life = failed.filter(|k| *k > 0).map_or(f64::INFINITY, |k| {
            let share = (limit.threshold - wear[k - 1]) / (wear[k] - wear[k - 1]);
            cycles[k - 1] + share * (cycles[k] - cycles[k - 1])
        });
        let (age, noise): (f64, f64) = (rng.random_range(AGES), StandardNormal.sample(&mut rng));
        let name = format!("U{}", unit + 1);
        if life > age {
            println!("{name},{:.0},survived,,", (age / 100.0).floor() * 100.0);
        } else {
            println!("{name},{:.0},failed,{},{ERROR}", life + ERROR * noise, limit.name);
        }
    }
    Ok(())
}
