//! Bodies that do not influence each other are simulated apart.

use crate::scenes::{scene, short};
use common::accuracy::Accuracy;
use common::outputs::Evaluation;
use worker::mechanism::islands;
use worker::simulate::{SimulateOptions, simulate};

#[test]
fn each_side_of_the_drive_is_an_island_of_two_bodies() {
    let scene = scene("flapping-wing", &[]);
    let islands = islands(&scene).expect("clearance joints only");
    let joints: Vec<Vec<&str>> = islands
        .iter()
        .map(|i| i.joints.iter().map(|j| scene.joints[j.scene_joint].name.as_str()).collect())
        .collect();
    assert_eq!(joints, [["1", "3", "5"], ["2", "4", "6"]]);
    assert!(islands.iter().all(|i| i.coordinates() == 6));
}

#[test]
fn the_four_bar_is_one_island() {
    let scene = scene("four-bar", &[]);
    let islands = islands(&scene).expect("clearance joints only");
    assert_eq!(islands.len(), 1);
    assert_eq!((islands[0].coordinates(), islands[0].joints.len()), (6, 3));
}

fn evaluate(settings: &[(&str, f64)]) -> Evaluation {
    simulate(&short("flapping-wing", settings, 2000), &Accuracy::draft(), SimulateOptions::WITH_FIRST_CYCLE)
        .expect("simulated")
}

#[test]
fn one_side_does_not_feel_the_other() {
    let (base, other) = (evaluate(&[]), evaluate(&[("bushing_radius_2", 1.5237e-3)]));
    for k in [0, 2, 4] {
        assert_eq!(base.joints[k], other.joints[k], "joint {}", base.joints[k].name);
    }
    for k in [1, 3, 5] {
        assert_ne!(base.joints[k], other.joints[k], "joint {}", base.joints[k].name);
    }
    let (a, b) = (base.first_cycle.expect("asked for"), other.first_cycle.expect("asked for"));
    assert_eq!((a.bodies[0].label.as_str(), a.bodies[1].label.as_str()), ("right", "left"));
    assert_eq!(a.bodies[0], b.bodies[0]);
    assert_ne!(a.bodies[1], b.bodies[1]);
}
