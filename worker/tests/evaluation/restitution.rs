//! The flapping-wing drive with damping by a coefficient of restitution.

use crate::scenes::{every_joint, scene};
use common::scene::{ContactDamping, RestitutionLaw};
use worker::integrate::{StepControl, StepCounts, Stepper};
use worker::mechanism::{ideal_cycle, islands};

#[test]
fn every_joint_of_an_island_learns_how_its_contact_began() {
    const LEAST_SPEED: f64 = 1e-6;
    let mut scene = scene("flapping-wing", &[]);
    let law = RestitutionLaw::LankaraniNikravesh;
    every_joint(&mut scene, |c| {
        c.contact_damping = ContactDamping::Restitution { law, coefficient: 0.8, least_speed: LEAST_SPEED }
    });
    let pose = ideal_cycle(&scene, 2, &mut 0).expect("the linkage closes").swap_remove(0);
    for mut island in islands(&scene).expect("all joints have clearance") {
        let pick = |from: &[Option<[f64; 3]>]| -> Vec<f64> {
            island.bodies.iter().flat_map(|&b| from[b].expect("free")).collect()
        };
        let (mut q, mut v) = (pick(&pose.q), pick(&pose.v));
        let period = scene.life.period;
        let control = StepControl::new(1e-2, period / 250.0, period * 1e-9, 100_000);
        let mut stepper = Stepper::new(island.linearised(), control);
        let mut counts = StepCounts::default();
        stepper
            .run(&mut island, 0.0..0.1 * period, &mut q, &mut v, &mut (), &mut counts)
            .expect("integrated");
        let mut learned = 0;
        for joint in &island.joints {
            // D = 0.27 / v0. The last of the bounces that lead a journal from the middle to its bore are slow; one that
            // turns round within a step counts as the slowest.
            let began = 0.27 / joint.contact.surface().damping;
            let name = &scene.joints[joint.scene_joint].name;
            println!("joint {name}: contact began with {began:.3e} m/s");
            assert!((0.99 * LEAST_SPEED..1.0).contains(&began), "joint {name}: {began} m/s");
            learned += u32::from(began > 2.0 * LEAST_SPEED);
        }
        assert!(learned > 0, "no contact began with more than the least speed");
    }
}
