//! What the contact parameters that are seldom measured decide, for `coordinator check --contact`: the lives of the nominal mechanism with
//! each of them changed in all hinges with clearance.

use super::nominal::nominal_evaluation;
use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::outputs::Evaluation;
use common::scene::{Clearance, ContactDamping, JointKind, Scene};
use coordinator::presentation::nominal_life::{NominalLife, nominal_lives};
use serde::Serialize;

/// A parameter, what is done to it, and whether it does anything in a hinge.
type Choice = (&'static str, fn(&mut Clearance), fn(&Clearance) -> bool);

/// The parameters in the order of the output.
const CHOICES: [Choice; 3] = [
    ("twice the film damping", |hinge| hinge.film_damping *= 2.0, |hinge| hinge.film_damping > 0.0),
    ("twice the friction speed", |hinge| hinge.friction_speed *= 2.0, |hinge| hinge.friction > 0.0),
    (
        "twice the contact damping",
        |hinge| damp(&mut hinge.contact_damping),
        |hinge| hinge.contact_damping != ContactDamping::None,
    ),
];

/// Twice the damping; with a coefficient of restitution e twice the loss 1 - e, at most until e is halved.
fn damp(damping: &mut ContactDamping) {
    match damping {
        ContactDamping::None => {}
        ContactDamping::HuntCrossley { factor } => *factor *= 2.0,
        ContactDamping::Restitution { coefficient: e, .. } => *e = (2.0 * *e - 1.0).max(0.5 * *e),
    }
}

/// The lives with one parameter changed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ContactChange {
    /// The change, in words.
    pub change: &'static str,
    /// By limit state.
    pub lives: Vec<ChangedLife>,
}

/// The life by a limit state, as the scene has it and with the change [cycles]; `null` beyond the end of the life.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChangedLife {
    /// Name of the limit state.
    pub limit_state: String,
    /// Life as the scene has it.
    pub life: Option<f64>,
    /// Life with the change.
    pub changed: Option<f64>,
}

/// The lives with each parameter changed that a hinge has, beside those of `evaluation`.
///
/// # Errors
/// [`SimulationFailure`] of a mechanism with a changed parameter.
pub fn contact_changes(
    scene: &Scene,
    accuracy: Option<&Accuracy>,
    evaluation: &Evaluation,
    say: &dyn Fn(String),
) -> Result<Vec<ContactChange>, SimulationFailure> {
    let own: Vec<Option<f64>> =
        nominal_lives(scene, evaluation).iter().map(|life| life.reached.life()).collect();
    let mut all = Vec::new();
    for (change, apply, matters) in CHOICES {
        let mut changed = scene.clone();
        let mut is_changed = false;
        let of_conditions = changed.conditions.iter_mut().map(|condition| &mut condition.scene.joints);
        for joint in std::iter::once(&mut changed.joints).chain(of_conditions).flatten() {
            if let JointKind::Clearance(hinge) = &mut joint.kind
                && matters(hinge)
            {
                apply(hinge);
                is_changed = true;
            }
        }
        if !is_changed {
            continue;
        }
        say(change.to_owned());
        let Some(found) = nominal_evaluation(&changed, accuracy, &|_| {})? else { continue };
        let lives = nominal_lives(&changed, &found);
        let of_limit = |(life, changed): (&Option<f64>, &NominalLife)| ChangedLife {
            limit_state: changed.limit.name.clone(),
            life: *life,
            changed: changed.reached.life(),
        };
        all.push(ContactChange { change, lives: own.iter().zip(&lives).map(of_limit).collect() });
    }
    Ok(all)
}

impl ContactChange {
    /// A line, e.g. `twice the film damping: life by wear +0.2 %, by asymmetry -3.1 %`.
    pub fn line(&self) -> String {
        let of = |ChangedLife { limit_state, life, changed }: &ChangedLife| match (life, changed) {
            (Some(life), Some(changed)) if *life > 0.0 => {
                format!("by {limit_state} {:+.1} %", 100.0 * (changed / life - 1.0))
            }
            (Some(_), Some(0.0)) | (None, None) => format!("by {limit_state} as before"),
            (_, Some(changed)) => format!("by {limit_state} now about {changed:.0} cycles"),
            (_, None) => format!("by {limit_state} now beyond the end"),
        };
        format!("{}: life {}\n", self.change, self.lives.iter().map(of).collect::<Vec<_>>().join(", "))
    }
}
