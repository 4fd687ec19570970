//! Where the energy of a cycle goes.

use crate::scenes::{every_joint, short};
use common::accuracy::Accuracy;
use common::outputs::Diagnostics;
use common::scene::ContactLaw;
use worker::simulate::{SimulateOptions, simulate};

fn diagnostics(scene: &str, law: ContactLaw, accuracy: &Accuracy, cycles: u32) -> Diagnostics {
    let mut scene = short(scene, &[], cycles);
    every_joint(&mut scene, |c| c.contact_law = law);
    simulate(&scene, accuracy, SimulateOptions::WITH_FIRST_CYCLE).expect("simulated").diagnostics
}

/// Input work, kinetic, elastic, dissipated: to 1e-4 of the work put in, on the round and on the worn bores.
#[test]
fn foundation_balances_its_energy() {
    let found = diagnostics("four-bar", ContactLaw::Foundation, &Accuracy::reference(), 1000);
    for energy in [found.energy.expect("asked for"), found.worn_energy.expect("asked for")] {
        println!("{energy:?}, residual {:e}", energy.residual() / energy.input);
        assert!(energy.input > 0.0 && energy.dissipated > 0.0);
        assert!(energy.residual().abs() < 1e-4 * energy.input, "{energy:?}");
        // The law has a potential.
        assert!(energy.unphysical.abs() < 1e-12 * energy.input, "{energy:?}");
    }
}

/// The paper's law gives energy away on a worn bore: measured, and reported as such.
#[test]
fn local_hertz_gains_energy_on_a_worn_bore_and_says_so() {
    let found =
        diagnostics("flapping-wing", ContactLaw::LocalHertz, &Accuracy::balanced().refined(3.0), 72_000);
    let (round, worn) = (found.energy.expect("asked for"), found.worn_energy.expect("asked for"));
    println!("round: {round:?}\nworn: {worn:?}");
    assert!(round.unphysical.abs() < 1e-12 * round.input, "{round:?}");
    assert!(worn.unphysical > 5e-4 * worn.input, "{worn:?}");
    // The account closes with it, and not without it.
    assert!(worn.residual().abs() < 0.5 * worn.unphysical, "{worn:?}");
}
