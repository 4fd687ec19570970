//! The flapping-wing drive with the conservative contact law.

use crate::scenes::{RPM, at, every_joint, published, scene};
use common::accuracy::Accuracy;
use common::scene::ContactLaw;
use worker::simulate::{SimulateOptions, simulate};

#[test]
fn foundation_wears_more_and_keeps_the_asymmetry_where_it_began() {
    let mut scene = scene("flapping-wing", &[]);
    every_joint(&mut scene, |c| c.contact_law = ContactLaw::Foundation);
    let e = simulate(&scene, &Accuracy::draft(), SimulateOptions::default()).expect("simulated");
    let depth = at(&e, 0, 64_000);
    let published = published("wear_mean_64000");
    assert!(depth > 1.05 * published && depth < 1.2 * published, "{depth}");
    every_joint(&mut scene, |c| c.contact_law = ContactLaw::LocalHertz);
    let local = simulate(&scene, &Accuracy::draft(), SimulateOptions::default()).expect("simulated");
    for cycles in [60_000, 64_000, 72_000] {
        let ratio = at(&e, 0, cycles) / at(&local, 0, cycles);
        println!("wear of foundation over local-hertz at {cycles}: {ratio:.4}");
        assert!((1.075..1.115).contains(&ratio), "{ratio} at {cycles}");
    }
    for (cycles, gamma) in e.cycles.iter().zip(&e.histories[1]) {
        assert!((gamma / RPM - 20.6).abs() < 0.6, "{} r/min at {cycles}", gamma / RPM);
    }
}
