//! Reads the operating conditions of a life: `[[conditions]]`, each with a share of the cycles and the quantities that it changes.
//!
//! The value of a change is read like any other quantity, with the parameters as they are without the condition: `"1.2 * torque"` is more
//! than the scene has. It takes precedence over a random variable that changes the same key.

use super::context::{Overrides, Range};
use super::model::Life;
use super::quantity::{NUMBER, Quantity};
use super::section::Section;
use toml::Value;

/// Largest distance of the sum of all shares from one: rounding [1].
const WHOLE: f64 = 1e-9;

/// Tables whose quantities are no property of the motion.
const FIXED_TABLES: [&str; 2] = ["limit_states.", "conditions."];
/// Beginning of the keys of parameters.
pub(super) const PARAMETERS: &str = "parameters.";

/// A row of `[[conditions]]`: its name, its share of the cycles [1] and the keys that it changes with their values [SI].
pub(super) struct ConditionRow {
    pub(super) name: String,
    pub(super) share: f64,
    pub(super) changes: Overrides,
}

/// Reads `[[conditions]]`, after everything that a condition may change.
pub(super) fn condition_rows(file: &mut Section, life: Option<&Life>) -> Vec<ConditionRow> {
    let before = file.cx.fault_count();
    let rows = file.each_row("conditions", |name, row| {
        let share = row.quantity("share", NUMBER, Range::Above(0.0, 1.0));
        let mut changes = Overrides::new();
        if let Some(table) = row.section_if_any("changes") {
            for (key, value) in table.entries() {
                read_changes(&table, key, value, &mut changes);
            }
        }
        share.map(|share| ConditionRow { name: name.to_owned(), share, changes })
    });
    let rows: Vec<ConditionRow> = rows.into_iter().flatten().collect();
    if file.cx.fault_count() == before && !rows.is_empty() {
        check(file, &rows, life);
    }
    rows
}

/// Reads the quantity at `key` of the table `changes`, or those of a table there.
fn read_changes(changes: &Section, key: &str, value: &Value, found: &mut Overrides) {
    if let Some(table) = value.as_table() {
        for (part, value) in table {
            read_changes(changes, &format!("{key}.{part}"), value, found);
        }
        return;
    }
    let (cx, path) = (changes.cx, changes.key(key));
    if FIXED_TABLES.iter().any(|table| key.starts_with(table)) {
        cx.inconsistent(path, "conditions change what a cycle depends on, not limit states or conditions");
        return;
    }
    let Some(kind) = cx.seen.borrow().get(key).map(Quantity::kind) else {
        // After another fault, a quantity may be unread only because of it.
        if cx.fault_count() == 0 {
            changes.reference(key, "quantity", key, cx.seen.borrow().keys().map(String::as_str));
        }
        return;
    };
    if let Some(value) = cx.quantity(&path, value, kind, Range::Any) {
        found.insert(key.to_owned(), value);
    }
}

/// Checks that the shares are those of a whole, and that the life has cycles to share.
fn check(file: &Section, rows: &[ConditionRow], life: Option<&Life>) {
    let sum: f64 = rows.iter().map(|row| row.share).sum();
    if (sum - 1.0).abs() > WHOLE {
        let message = format!(
            "the shares add up to {}, not to 1; shares that vary are written by a parameter p, \"p\" and \"1 - p\", which a \
             variable changes",
            (sum * 1e12).round() / 1e12
        );
        file.inconsistent("conditions", message);
    }
    if life.is_some_and(Life::is_single_cycle) {
        file.inconsistent("conditions", "a motion that is seen once, in one cycle, has no conditions");
    }
}
