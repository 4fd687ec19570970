//! Resolves a scene under each of its operating conditions, and checks that they share their bores.

use super::conditions::{ConditionRow, PARAMETERS};
use super::context::Overrides;
use super::faults::{Fault, Faults};
use super::joint::{Clearance, ContactDamping, GuideClearance, GuideWear, Joint, JointKind};
use super::model::{Condition, Scene};
use super::output::{Fails, LimitState};
use super::resolve::{Resolved, resolve};
use std::collections::BTreeSet;
use toml::Table;

/// Relative difference up to which two ratios of wear coefficients are the same: rounding of what is written [1].
const RATIO: f64 = 1e-12;

/// The conditions of a scene: `scene` as resolved with the `overrides` of the random variables, and `rows` of its conditions.
///
/// # Errors
/// Every fault of the scene under one of the conditions, at the key that the condition changes.
pub(super) fn conditions(
    origin: &str,
    document: &Table,
    overrides: &Overrides,
    scene: &Scene,
    rows: &[ConditionRow],
) -> Result<Vec<Condition>, Faults> {
    let (mut found, mut faults) = (Vec::new(), Vec::new());
    if let Some(limit) = (rows.len() > 1).then(|| two_sided(scene)).flatten() {
        let message = "over several conditions an output of the motion is its largest or its smallest value: its limit states must all \
                       fail above or all below"
            .to_owned();
        faults.push(Fault::new(origin, format!("limit_states.{limit}"), message));
    }
    let changed: BTreeSet<&String> = rows.iter().flat_map(|row| row.changes.keys()).collect();
    for ConditionRow { name, share, changes } in rows {
        let place = format!("conditions.{name}.changes");
        let fault = |key: &str, message: String| {
            let key = if changes.contains_key(key) { format!("{place}.{key}") } else { place.clone() };
            Fault::new(origin, key, message)
        };
        let mut all = overrides.clone();
        all.extend(changes.iter().map(|(key, value)| (key.clone(), *value)));
        match resolve(origin, document, &all, false) {
            // Random variables belong to the scene without the condition.
            Err(Faults(wrong)) => {
                let of_condition = wrong.iter().filter(|wrong| !wrong.key.starts_with("variables."));
                let message = |wrong: &Fault| format!("{}: {}", wrong.key, wrong.kind);
                faults.extend(of_condition.map(|wrong| fault(&wrong.key, message(wrong))));
            }
            Ok(Resolved { scene: under, seen, .. }) => {
                let value =
                    |key: &&String| Some((key.strip_prefix(PARAMETERS)?.to_owned(), seen.get(*key)?.value));
                let parameters = changed.iter().filter_map(value).collect();
                let condition = Condition { name: name.clone(), share: *share, scene: under, parameters };
                if let Some(joint) = other_surfaces(&condition.scene, scene) {
                    let surfaces = if matches!(joint.kind, JointKind::Guide(_)) { "faces" } else { "bore" };
                    let message = format!(
                        "changes the {surfaces} of joint \"{}\", which all conditions share: of a joint they may change friction, \
                         damping and, if it wears, the wear coefficient, of both surfaces by the same factor",
                        joint.name
                    );
                    faults.push(fault("", message));
                }
                if condition.scene.limit_states != scene.limit_states {
                    let message = "changes a limit state, which holds for all conditions";
                    faults.push(fault("", message.to_owned()));
                }
                found.push(condition);
            }
        }
    }
    if faults.is_empty() { Ok(found) } else { Err(Faults(faults)) }
}

/// Name of the first limit state that fails on another side than one before it of the same output of the motion, or on both; `None` if
/// there is none. Wear is the same under all conditions.
fn two_sided(scene: &Scene) -> Option<&str> {
    let of_motion = |output: usize| scene.outputs[output].kind.wear().is_none();
    let limits = || scene.limit_states.iter().filter(|limit| of_motion(limit.output));
    let is_two_sided = |(k, limit): &(usize, &LimitState)| {
        let mut before = limits().take(*k).filter(|other| other.output == limit.output);
        matches!(limit.fails, Fails::Outside { .. }) || before.any(|other| other.fails != limit.fails)
    };
    limits().enumerate().find(is_two_sided).map(|(_, limit)| limit.name.as_str())
}

/// The first joint whose bore, or whose faces if it is a guide, in the scene `under` a condition are not those of `base`; `None` if all are the same. Friction, damping
/// and the wear coefficient of a joint that wears may differ, the latter by the same factor for both surfaces.
fn other_surfaces<'s>(under: &'s Scene, base: &Scene) -> Option<&'s Joint> {
    let mut pairs = under.joints.iter().zip(&base.joints);
    let other = pairs.find(|(own, base)| match (&own.kind, &base.kind) {
        (JointKind::Clearance(own), JointKind::Clearance(base)) => {
            bore(own) != bore(base) || !wear_alike(own.wear_coefficients(), base.wear_coefficients())
        }
        (JointKind::Guide(own), JointKind::Guide(base)) => {
            faces(own) != faces(base) || !wear_alike(own.wear_coefficients(), base.wear_coefficients())
        }
        _ => false,
    });
    other.map(|(own, _)| own)
}

/// A joint with clearance with what conditions may change set to one value.
fn bore(clearance: &Clearance) -> Clearance {
    Clearance {
        contact_damping: ContactDamping::None,
        film_damping: 0.0,
        friction: 0.0,
        friction_speed: 1.0,
        wear_coefficient: 0.0,
        journal_wear_coefficient: None,
        ..clearance.clone()
    }
}

/// A guide that wears with what conditions may change set to one value; of one that does not, conditions may change everything.
fn faces(guide: &GuideClearance) -> Option<GuideClearance> {
    let wear = guide.wear.as_ref()?;
    let wear = GuideWear { coefficient: 0.0, slider_coefficient: None, ..wear.clone() };
    Some(GuideClearance {
        contact_damping: ContactDamping::None,
        friction: 0.0,
        friction_speed: 1.0,
        wear: Some(wear),
        ..guide.clone()
    })
}

/// True if the wear coefficients of the surfaces of two joints have the same ratio, up to rounding: one history of contacts wears both
/// surfaces.
fn wear_alike(own: [f64; 2], base: [f64; 2]) -> bool {
    let same_wear = own.iter().zip(&base).all(|(own, base)| (*own > 0.0) == (*base > 0.0));
    let (a, b) = (own[0] / own[1], base[0] / base[1]);
    same_wear && (own.contains(&0.0) || (a - b).abs() <= RATIO * b)
}
