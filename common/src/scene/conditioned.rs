//! Resolves a scene under each of its operating conditions, and checks that they share their bores.

use super::condition::Condition;
use super::conditions::ConditionRow;
use super::context::Overrides;
use super::faults::{Fault, FaultKind};
use super::model::Scene;
use super::resolve::resolve;
use toml::Table;

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
) -> Result<Vec<Condition>, Vec<Fault>> {
    let (mut found, mut faults) = (Vec::new(), Vec::new());
    for ConditionRow { name, share, changes } in rows {
        let place = format!("conditions.{name}.changes");
        let fault = |key: &str, message: String| {
            let key = if changes.contains_key(key) { format!("{place}.{key}") } else { place.clone() };
            Fault::new(origin, key, FaultKind::Inconsistent { message })
        };
        let mut all = overrides.clone();
        all.extend(changes.iter().map(|(key, value)| (key.clone(), *value)));
        match resolve(origin, document, &all) {
            // Random variables belong to the scene without the condition.
            Err(wrong) => faults.extend(
                wrong
                    .iter()
                    .filter(|wrong| !wrong.key.starts_with("variables."))
                    .map(|wrong| fault(&wrong.key, format!("{}: {}", wrong.key, wrong.kind))),
            ),
            Ok(resolved) => {
                let condition = Condition { name: name.clone(), share: *share, scene: resolved.scene };
                if let Some(joint) = condition.other_bore(scene) {
                    let message = format!(
                        "changes the bore of joint \"{joint}\", which all conditions share: of a joint they may change friction, \
                         damping and, if it wears, the wear coefficient"
                    );
                    faults.push(fault("", message));
                }
                if condition.scene.limit_states != scene.limit_states {
                    faults
                        .push(fault("", "changes a limit state, which holds for all conditions".to_owned()));
                }
                found.push(condition);
            }
        }
    }
    if faults.is_empty() { Ok(found) } else { Err(faults) }
}
