//! Evaluations side by side in lanes: each has the result it has alone, in lanes of any width.

use crate::guides::PUBLISHED;
use crate::scenes::{RPM, every_joint, short};
use crate::worn_guides::pressed;
use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::outputs::Evaluation;
use common::scene::{ContactLaw, IdealFriction, JointKind, Scene, SceneSource, WearingSurfaces};
use worker::simulate::{LaneWidth, SimulateOptions, SimulationInput, simulate, simulate_side_by_side};

type Outcome = Result<Evaluation, SimulationFailure>;

/// The outcomes of these inputs, `most` of them side by side.
fn together(
    width: LaneWidth,
    most: usize,
    inputs: &[Result<SimulationInput, SimulationFailure>],
) -> Vec<Outcome> {
    let mut outcomes = vec![None; inputs.len()];
    let mut inputs = inputs.iter().cloned();
    simulate_side_by_side(width, most, &mut || inputs.next(), &mut |number, outcome, _| {
        assert!(outcomes[number].replace(outcome).is_none(), "number {number} ends once");
    });
    outcomes.into_iter().map(|outcome| outcome.expect("all come to their end")).collect()
}

const PLAIN: SimulateOptions = SimulateOptions { first_cycle: false };
const SHOWN: SimulateOptions = SimulateOptions::WITH_FIRST_CYCLE;

fn input(scene: Scene, accuracy: Accuracy, options: SimulateOptions) -> SimulationInput {
    SimulationInput { scene, accuracy, options }
}

/// Lives of a thousand cycles that have little in common.
fn mixed() -> Vec<SimulationInput> {
    let wing = |setting: (&str, f64)| short("flapping-wing", &[setting], 1000);
    let mut hard = short("flapping-wing", &[], 1000);
    every_joint(&mut hard, |joint| joint.friction = 0.2);
    let founded = |setting: (&str, f64)| {
        let mut scene = wing(setting);
        every_joint(&mut scene, |joint| joint.contact_law = ContactLaw::Foundation);
        scene
    };
    let both = |mut scene: Scene| {
        every_joint(&mut scene, |joint| joint.wears = WearingSurfaces::Both);
        scene
    };
    // Ideal joints, and contacts with memory under both laws, on motions that do not repeat.
    let rattling = short("slider-crank", &[], 1000);
    let mut rattling_founded = rattling.clone();
    every_joint(&mut rattling_founded, |joint| joint.contact_law = ContactLaw::Foundation);
    // Friction in every ideal joint, on pins of 2 mm and in guides of 20 mm.
    let rubbing = |mut scene: Scene| {
        for joint in &mut scene.joints {
            let size = match joint.kind {
                JointKind::Revolute => 2e-3,
                JointKind::Prismatic { .. } => 2e-2,
                _ => continue,
            };
            joint.friction = Some(IdealFriction { coefficient: 0.1, speed: 1e-2, size });
        }
        scene
    };
    // A slider with clearance in its guide: contacts with memory at four pads.
    let guided = SceneSource::parse(PUBLISHED, "guided").expect("valid").nominal().clone();
    let mut worn = pressed(|guide| guide.friction = 0.05);
    worn.life.cycles = 1000;
    // Longer time steps until the vibration grows, then a return to the last check.
    let mut quick = wing(("friction", 0.025));
    every_joint(&mut quick, |joint| joint.wear_coefficient *= 72.0);
    let many_blocks = Accuracy { cycle_jump: 50, ..Accuracy::balanced() };
    let mut few = Accuracy::draft();
    few.steps_bound = 2000;
    vec![
        input(wing(("parameters.crank_speed", 460.0 * RPM)), Accuracy::draft(), PLAIN),
        input(short("four-bar", &[], 1000), Accuracy::balanced(), SHOWN),
        input(hard, Accuracy::draft(), PLAIN),
        input(wing(("bushing_radius_2", 1.5237e-3)), Accuracy::balanced(), SHOWN),
        input(short("flapping-wing", &[], 1000), few, PLAIN),
        input(short("flapping-wing-tolerances", &[], 1000), Accuracy::draft(), PLAIN),
        input(founded(("friction", 0.03)), Accuracy::draft(), PLAIN),
        input(founded(("bushing_radius_2", 1.5237e-3)), Accuracy::balanced(), SHOWN),
        input(both(wing(("friction", 0.03))), Accuracy::draft(), PLAIN),
        input(both(founded(("friction", 0.03))), Accuracy::draft(), SHOWN),
        input(both(rattling.clone()), Accuracy::draft(), PLAIN),
        input(both(rattling_founded.clone()), Accuracy::draft(), PLAIN),
        input(rattling, Accuracy::draft(), SHOWN),
        input(rattling_founded, Accuracy::draft(), PLAIN),
        input(short("andrews-squeezer", &[], 1), Accuracy::draft(), PLAIN),
        input(rubbing(short("andrews-squeezer", &[], 1)), Accuracy::draft(), SHOWN),
        input(rubbing(short("slider-crank", &[], 1000)), Accuracy::draft(), PLAIN),
        input(guided, Accuracy::draft(), SHOWN),
        // A guide that wears, which is integrated by itself.
        input(worn, Accuracy::draft(), PLAIN),
        input(quick, many_blocks, SHOWN),
    ]
}

#[test]
fn an_evaluation_depends_neither_on_those_next_to_it_nor_on_the_width_of_the_lanes() {
    let inputs = mixed();
    let asked: Vec<_> = inputs.iter().cloned().map(Ok).collect();
    // On two processors.
    let (alone, beside): (Vec<Outcome>, _) = std::thread::scope(|scope| {
        let beside = scope.spawn(|| together(LaneWidth::Widest, 8, &asked));
        let alone = inputs.iter().map(|o| simulate(&o.scene, &o.accuracy, o.options)).collect();
        (alone, beside.join().expect("all come to their end"))
    });
    assert!(matches!(alone[4], Err(SimulationFailure::TooManySteps { .. })), "{:?}", alone[4]);
    assert_eq!(alone.iter().filter(|outcome| outcome.is_ok()).count(), 19);
    assert_eq!(beside, alone);
    // In lanes of another width, in another order and next to other evaluations.
    let every_second = |width: LaneWidth, most: usize, first: usize| {
        let inputs: Vec<_> = asked.iter().rev().skip(first).step_by(2).cloned().collect();
        let expected: Vec<Outcome> = alone.iter().rev().skip(first).step_by(2).cloned().collect();
        assert!(together(width, most, &inputs) == expected, "at most {most}");
    };
    std::thread::scope(|scope| {
        scope.spawn(|| every_second(LaneWidth::Holding(4), 3, 0));
        every_second(LaneWidth::Holding(1), 2, 1);
    });
}

#[test]
fn a_failed_input_is_its_own_result() {
    let wrong = SimulationFailure::InvalidSample { faults: "made up".into() };
    let sound = input(short("four-bar", &[], 1000), Accuracy::draft(), PLAIN);
    let outcomes = together(LaneWidth::Widest, 2, &[Err(wrong.clone()), Ok(sound), Err(wrong.clone())]);
    assert_eq!(outcomes[0], Err(wrong.clone()));
    assert!(outcomes[1].is_ok());
    assert_eq!(outcomes[2], Err(wrong));
}
