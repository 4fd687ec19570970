//! The cases: a scene with one quantity at an extreme, or several at once.

use common::accuracy::Accuracy;
use common::scene::{
    Clearance, ContactDamping, ContactLaw, Drive, GuideClearance, JointKind, Motion, Over, Scene, Value,
};

/// Life of a case in checkpoints of its scene: long enough for a wear depth comparable to the clearance, short
/// enough for a table of all cases in a minute or two.
const CHECKPOINTS: u32 = 4;

/// A scene with one or several extreme quantities.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Name: the extreme quantities.
    pub name: &'static str,
    /// Contact law of every joint with clearance.
    pub law: ContactLaw,
    /// The changed scene, with a short life.
    pub scene: Scene,
    /// The accuracy, with another block length if that is the extreme quantity.
    pub accuracy: Accuracy,
}

/// Sets a quantity of a scene or an accuracy to an extreme.
type Change = fn(&mut Scene, &mut Accuracy);

/// The extreme quantities, one at a time, then several.
const CASES: [(&str, Change); 24] = [
    ("nominal", |_, _| {}),
    ("clearance 1 um", |s, _| clearance(s, 1e-6)),
    ("clearance 5 um", |s, _| clearance(s, 5e-6)),
    ("clearance 0.5 mm", |s, _| clearance(s, 0.5e-3)),
    ("modulus x 0.01", |s, _| modulus(s, 0.01)),
    ("modulus x 10", |s, _| modulus(s, 10.0)),
    ("6 r/min", |s, _| speed(s, 6.0)),
    ("6000 r/min", |s, _| speed(s, 6000.0)),
    ("friction 0", |s, _| friction(s, 0.0)),
    ("friction 0.5", |s, _| friction(s, 0.5)),
    ("masses x 0.01", |s, _| masses(s, 0.01)),
    ("masses x 100", |s, _| masses(s, 100.0)),
    ("wear coefficient x 0.1", |s, _| wear(s, 0.1)),
    ("wear coefficient x 10", |s, _| wear(s, 10.0)),
    ("jump of 100 cycles", |s, a| {
        s.life.cycles = s.life.checkpoint_every;
        a.cycle_jump = 100;
    }),
    ("jump of 8000 cycles", |s, a| jump(s, a, 8000)),
    ("wear x 10, wall of 30 um", |s, _| {
        wear(s, 10.0);
        each(s, |c| c.wall = Some(30e-6));
    }),
    ("wear x 10, wall of 10 um", |s, _| {
        wear(s, 10.0);
        each(s, |c| c.wall = Some(10e-6));
    }),
    ("no damping, no friction", |s, _| {
        friction(s, 0.0);
        each(s, |c| {
            c.film_damping = 0.0;
            c.contact_damping = ContactDamping::None;
        });
        each_guide(s, |g| g.contact_damping = ContactDamping::None);
    }),
    ("clearance 1 um, modulus x 10, friction 0.5", |s, _| {
        clearance(s, 1e-6);
        modulus(s, 10.0);
        friction(s, 0.5);
    }),
    ("clearance 0.5 mm, modulus x 0.01, 6000 r/min", |s, _| {
        clearance(s, 0.5e-3);
        modulus(s, 0.01);
        speed(s, 6000.0);
    }),
    ("masses x 100, 6000 r/min", |s, _| {
        masses(s, 100.0);
        speed(s, 6000.0);
    }),
    ("masses x 0.01, modulus x 10, 6 r/min", |s, _| {
        masses(s, 0.01);
        modulus(s, 10.0);
        speed(s, 6.0);
    }),
    ("friction 0.5, wear x 10, jump of 8000 cycles", |s, a| {
        friction(s, 0.5);
        wear(s, 10.0);
        jump(s, a, 8000);
    }),
];

/// Every case of a scene, under both contact laws.
pub fn cases(scene: &Scene, accuracy: &Accuracy) -> Vec<Case> {
    let of_law = |law: ContactLaw| {
        CASES.iter().map(move |&(name, change)| {
            let mut case = Case { name, law, scene: scene.clone(), accuracy: *accuracy };
            let conditions = case.scene.conditions.iter_mut().map(|condition| &mut condition.scene);
            for scene in conditions {
                change_case(scene, &mut case.accuracy, law, change);
            }
            change_case(&mut case.scene, &mut case.accuracy, law, change);
            case
        })
    };
    ContactLaw::ALL.into_iter().flat_map(of_law).collect()
}

/// Shortens the life of a scene, sets the contact law and applies the change.
fn change_case(scene: &mut Scene, accuracy: &mut Accuracy, law: ContactLaw, change: Change) {
    scene.life.cycles = scene.life.cycles.min(CHECKPOINTS * scene.life.checkpoint_every);
    each(scene, |c| c.contact_law = law);
    change(scene, accuracy);
}

/// Changes every guide with clearance.
fn each_guide(scene: &mut Scene, change: impl Fn(&mut GuideClearance)) {
    for joint in &mut scene.joints {
        if let JointKind::Guide(guide) = &mut joint.kind {
            change(guide);
        }
    }
}

/// Changes every hinge with clearance.
fn each(scene: &mut Scene, change: impl Fn(&mut Clearance)) {
    for joint in &mut scene.joints {
        if let JointKind::Clearance(clearance) = &mut joint.kind {
            change(clearance);
        }
    }
}

/// Sets the clearance of hinges, radial, and that of guides on either side [m].
fn clearance(scene: &mut Scene, size: f64) {
    each(scene, |c| c.bushing_radius = c.journal_radius + size);
    each_guide(scene, |g| g.clearance = size);
}

/// Scales the moduli of both materials.
fn modulus(scene: &mut Scene, factor: f64) {
    each(scene, |c| {
        c.journal_material.elastic_modulus *= factor;
        c.bushing_material.elastic_modulus *= factor;
    });
    each_guide(scene, |g| {
        g.slider_material.elastic_modulus *= factor;
        g.guide_material.elastic_modulus *= factor;
    });
}

/// Sets the friction coefficient.
fn friction(scene: &mut Scene, coefficient: f64) {
    each(scene, |c| c.friction = coefficient);
    each_guide(scene, |g| g.friction = coefficient);
}

/// Scales the wear coefficient.
fn wear(scene: &mut Scene, factor: f64) {
    each(scene, |c| {
        c.wear_coefficient *= factor;
        c.journal_wear_coefficient = c.journal_wear_coefficient.map(|coefficient| factor * coefficient);
    });
    each_guide(scene, |g| {
        if let Some(wear) = &mut g.wear {
            wear.coefficient *= factor;
            wear.slider_coefficient = wear.slider_coefficient.map(|coefficient| factor * coefficient);
        }
    });
}

/// Sets the length of a wear block [cycles], in a life of at least that.
fn jump(scene: &mut Scene, accuracy: &mut Accuracy, cycles: u32) {
    let every = scene.life.checkpoint_every;
    scene.life.cycles = scene.life.cycles.max(cycles / every * every);
    accuracy.cycle_jump = cycles;
}

/// Scales masses and inertias of all bodies that have any.
fn masses(scene: &mut Scene, factor: f64) {
    for body in &mut scene.bodies {
        match &mut body.motion {
            Motion::Free { mass, inertia, .. } => {
                *mass *= factor;
                *inertia *= factor;
            }
            Motion::Driven { inertia: Some(driven), .. } => {
                driven.mass *= factor;
                driven.inertia *= factor;
            }
            _ => {}
        }
    }
}

/// Runs the whole scene faster or slower so that a cycle takes the time of one turn at `rpm` [r/min].
fn speed(scene: &mut Scene, rpm: f64) {
    let factor = scene.life.period * rpm / 60.0;
    scene.life.period /= factor;
    for body in &mut scene.bodies {
        match &mut body.motion {
            Motion::Driven { drive: Drive::ConstantSpeed { speed, .. }, .. } => *speed *= factor,
            Motion::Driven { drive: Drive::Angle(table), .. } => {
                table.at.iter_mut().for_each(|t| *t /= factor)
            }
            Motion::Driven { drive: Drive::Speed { table, .. }, .. } => {
                table.at.iter_mut().for_each(|t| *t /= factor);
                table.value.iter_mut().for_each(|v| *v *= factor);
            }
            Motion::Free { start_velocity, start_speed, .. } => {
                start_velocity.iter_mut().flatten().for_each(|v| *v *= factor);
                start_speed.iter_mut().for_each(|speed| *speed *= factor);
            }
            Motion::Fixed => {}
        }
    }
    let faster = |value: &mut Value| {
        let curves: Vec<_> = match value {
            Value::Curve(curve) | Value::MaybeCurve(Some(curve)) => vec![curve],
            Value::TwoCurves(curves) => curves.iter_mut().flatten().collect(),
            _ => vec![],
        };
        for curve in curves.into_iter().filter(|curve| curve.over == Over::Time) {
            curve.table.at.iter_mut().for_each(|t| *t /= factor);
        }
    };
    scene.loads.iter_mut().for_each(|load| load.change(faster));
    scene.outputs.iter_mut().for_each(|output| output.kind.change(faster));
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::scene::SceneSource;
    use std::f64::consts::TAU;

    #[test]
    fn a_faster_scene_turns_as_often_in_its_cycle() {
        let mut scene = SceneSource::builtin("four-bar").expect("built in").nominal().clone();
        let turn = |scene: &Scene| {
            let speeds = scene.bodies.iter().filter_map(|b| match &b.motion {
                Motion::Driven { drive: Drive::ConstantSpeed { speed, .. }, .. } => Some(*speed),
                _ => None,
            });
            speeds.map(|speed| speed * scene.life.period / TAU).collect::<Vec<_>>()
        };
        let before = turn(&scene);
        speed(&mut scene, 6000.0);
        assert!((scene.life.period - 0.01).abs() < 1e-12);
        for (a, b) in before.iter().zip(turn(&scene)) {
            assert!((a - b).abs() < 1e-12, "{a} {b}");
        }
        assert!(!before.is_empty());
    }

    #[test]
    fn every_case_but_the_nominal_one_changes_something() {
        let scene = SceneSource::builtin("flapping-wing").expect("built in").nominal().clone();
        let all = cases(&scene, &Accuracy::balanced());
        assert_eq!(all.len(), 2 * CASES.len());
        for law in all.chunks(CASES.len()) {
            let same = |c: &&Case| c.scene == law[0].scene && c.accuracy == law[0].accuracy;
            assert_eq!(law.iter().filter(same).count(), 1);
        }
    }

    #[test]
    fn a_guide_is_changed_as_hinges_are() {
        let text = include_str!("../../../common/tests/scenes/guided-slider-crank.toml");
        let scene = SceneSource::parse(text, "guided").expect("a scene").nominal().clone();
        let all = cases(&scene, &Accuracy::balanced());
        let changed = |name: &str| {
            let case = all.iter().find(|case| case.name == name).expect("a case");
            case.scene.joints != all[0].scene.joints
        };
        let of_joints = CASES.iter().map(|(name, _)| name).filter(|name| {
            ["clearance", "modulus", "friction", "damping"]
                .iter()
                .any(|word| name.starts_with(word) || name.starts_with("no damping"))
        });
        assert!(of_joints.clone().count() > 8);
        assert!(
            of_joints.clone().all(|name| changed(name)),
            "{:?}",
            of_joints.filter(|name| !changed(name)).collect::<Vec<_>>()
        );
    }
}
