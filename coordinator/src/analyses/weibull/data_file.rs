//! Reader of lives of a population, CSV with a heading. One row for each unit, with the columns `unit, cycles, state` and, where they
//! apply, `mode` and `from`:
//!
//! | state | meaning |
//! |---|---|
//! | `failed` | failed at `cycles`, by the limit state `mode` |
//! | `running` | had not failed by `cycles` |
//! | `interval` | failed after `from` and by `cycles` |
//!
//! Or the observations of `coordinator update` with the columns `unit, cycles, quantity, value, error`, several rows for each unit:
//! `survived` and `failed`, whose value is the limit state; a failure without an error was found at its life and lies after the last
//! life survived. What was measured is left out. Further columns are left out, too.

use crate::analyses::quantity::positive;
use crate::statistics::life_data::UnitLife;
use common::scene::{Faults, Section, csv_rows, read_rows, read_text};
use std::path::Path;

/// What the data are to be about.
#[derive(Debug, Clone, Copy)]
pub struct LifeQuestion<'a> {
    /// The limit state whose failures count: those by others are suspensions. `None` for all failures.
    pub mode: Option<&'a str>,
    /// Names of all limit states, if they are known.
    pub known: Option<&'a [String]>,
    /// Largest life allowed: the end of the study [cycles].
    pub end: f64,
}

/// What is known of a unit from its rows.
struct UnitRows {
    name: String,
    /// Last life survived [cycles].
    survived: f64,
    /// Life of its failure, or by which it was found failed [cycles], whether that is exact, and its limit state.
    failed: Option<(f64, bool, Option<String>)>,
}

impl UnitRows {
    /// The life of the unit for a question; `None` if nothing is known of it.
    fn life(&self, mode: Option<&str>) -> Option<UnitLife> {
        let survived = (self.survived > 0.0).then_some(UnitLife::Running(self.survived));
        let Some((cycles, is_exact, by)) = &self.failed else { return survived };
        let counts = mode.is_none() || by.as_deref() == mode;
        match (is_exact, counts) {
            (true, true) => Some(UnitLife::Failed(*cycles)),
            (true, false) => Some(UnitLife::Running(*cycles)),
            (false, true) => Some(UnitLife::Interval(self.survived, *cycles)),
            (false, false) => survived,
        }
    }
}

/// Reads a file of lives.
///
/// # Errors
/// All faults.
pub fn read(path: &Path, question: &LifeQuestion<'_>) -> Result<Vec<UnitLife>, Faults> {
    parse(&read_text(path)?, &path.display().to_string(), question)
}

/// Reads the text of such a file.
///
/// # Errors
/// All faults.
pub fn parse(text: &str, file: &str, question: &LifeQuestion<'_>) -> Result<Vec<UnitLife>, Faults> {
    let head = csv_rows(text).into_iter().next().map_or(vec![], |row| row.cells);
    let named: Vec<&str> = head.iter().map(|cell| cell.text).collect();
    let has_head = named.iter().any(|name| name.eq_ignore_ascii_case("unit"));
    let columns = if has_head { named } else { vec!["unit", "cycles", "state", "mode", "from"] };
    let word = if columns.contains(&"quantity") { "quantity" } else { "state" };
    read_rows(text, file, &columns, |rows| {
        let mut units = Vec::<UnitRows>::new();
        for (_, row) in rows.iter_mut() {
            add(row, word, question, &mut units);
        }
        units.iter().filter_map(|unit| unit.life(question.mode)).collect()
    })
}

/// Adds a row to what is known of its unit.
fn add(row: &mut Section, word: &'static str, question: &LifeQuestion<'_>, units: &mut Vec<UnitRows>) {
    let is_observation = word == "quantity";
    let name = row.text("unit", "the name of the unit");
    let state = row.text(word, "failed, running or interval");
    let counts = |state: &&str| !is_observation || ["failed", "survived"].contains(state);
    let (Some(name), Some(state)) = (name, state.filter(counts)) else { return };
    let Some(cycles) = life(row, "cycles", question.end, ", the end of the study") else { return };
    let before = units.iter().position(|unit| unit.name == name);
    if before.is_some_and(|place| !is_observation || units[place].failed.is_some()) {
        let what = if is_observation { "has failed in a row before" } else { "has a row already" };
        row.inconsistent("unit", format!("unit {name} {what}"));
        return;
    }
    let place = before.unwrap_or(units.len());
    if place == units.len() {
        units.push(UnitRows { name: name.to_owned(), survived: 0.0, failed: None });
    }
    let unit = &mut units[place];
    let by = |row: &mut Section| {
        let column = if is_observation { "value" } else { "mode" };
        let mode = row.text_or(column, "a limit state", "").filter(|mode| !mode.is_empty());
        if let (Some(mode), Some(known)) = (mode, question.known) {
            row.reference(column, "limit state", mode, known.iter().map(String::as_str));
        } else if mode.is_none() && question.mode.is_some() {
            row.inconsistent(column, "by which limit state it failed is needed with --mode");
        }
        mode.map(str::to_owned)
    };
    if state != "interval" && row.get("from").is_some() {
        row.inconsistent("from", "allowed with the state interval alone");
    }
    match state {
        "running" | "survived" => unit.survived = unit.survived.max(cycles),
        "failed" => {
            let is_exact = !is_observation || row.get("error").is_some();
            unit.failed = Some((cycles, is_exact, by(row)));
            if unit.survived >= cycles {
                row.inconsistent("cycles", format!("unit {name} had survived {} cycles", unit.survived));
            }
        }
        "interval" => {
            let from = match row.get("from") {
                Some(value) if value.as_str() == Some("0") => Some(0.0),
                _ => life(row, "from", cycles, ""),
            };
            if from.is_some_and(|from| from >= cycles) {
                row.inconsistent("from", format!("allowed: a life before {cycles} cycles"));
            }
            unit.survived = from.unwrap_or(0.0);
            unit.failed = Some((cycles, false, by(row)));
        }
        other => drop(row.inconsistent(word, format!("{other:?}: allowed: failed, running or interval"))),
    }
}

/// A number of cycles above 0, up to `end`, which is `what`.
fn life(row: &mut Section, column: &'static str, end: f64, what: &str) -> Option<f64> {
    let text = row.text(column, "a number of cycles")?;
    let up_to = if end.is_finite() { format!(" and up to {end:.0}{what}") } else { String::new() };
    positive(row, column, text, end, &format!("a number of cycles above 0{up_to}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: LifeQuestion = LifeQuestion { mode: None, known: None, end: f64::INFINITY };

    fn faults(text: &str, question: &LifeQuestion<'_>) -> Vec<String> {
        let Faults(faults) = parse(text, "fleet.csv", question).unwrap_err();
        faults.iter().map(|fault| format!("{} {fault}", fault.location.as_ref().unwrap())).collect()
    }

    #[test]
    fn both_forms_have_the_same_lives() {
        let one = "unit;cycles;state;mode;from;depth [um]\nA;61200;failed;wear;;3\nB;40000;running\nC;50000;interval;wear;45000\n\
            D;300;interval;rattle;0\nE;20000;failed;rattle\n";
        let other = "unit,cycles,quantity,value,error\nA,61200,failed,wear,10\nA,30000,max_wear_depth,15 um,1 um\nB,30000,survived\n\
            B,40000,survived\nC,45000,survived\nC,50000,failed,wear\nD,300,failed,rattle\nE,20000,failed,rattle,1\n\
            F,30000,max_wear_depth,15 um,1 um\n";
        let other = other.replace(
            "A,61200,failed,wear,10\nA,30000,max_wear_depth,15 um,1 um",
            "A,30000,max_wear_depth,15 um,1 um\nA,61200,failed,wear,10",
        );
        let lives = [
            UnitLife::Failed(61_200.0),
            UnitLife::Running(40_000.0),
            UnitLife::Interval(45_000.0, 50_000.0),
            UnitLife::Interval(0.0, 300.0),
            UnitLife::Failed(20_000.0),
        ];
        // Failures by the other mode are suspensions.
        let by_wear = [lives[0], lives[1], lives[2], UnitLife::Running(20_000.0)];
        for text in [one, &other] {
            assert_eq!(parse(text, "f", &ALL).unwrap(), lives, "{text}");
            let question = LifeQuestion { mode: Some("wear"), ..ALL };
            assert_eq!(parse(text, "f", &question).unwrap(), by_wear, "{text}");
        }
    }

    #[test]
    fn faults_have_their_lines() {
        let known = ["wear".to_owned()];
        let question = LifeQuestion { mode: Some("wear"), known: Some(&known), end: 9000.0 };
        let text = "unit,cycles,state,mode,from\nA,0,running\nA,5,stopped\nA,9001,failed,wear\nB,50,failed,waer\nC,50,failed\n\
            D,50,interval,wear,60\nB,60,running\nE,50,interval,wear\n,5,running\nF,50,failed,wear,40\n";
        let found = faults(text, &question).join("\n");
        for says in [
            "fleet.csv:2:3",
            "\"0\": allowed: a number of cycles above 0 and up to 9000, the end of the study",
            "\"stopped\": allowed: failed, running or interval",
            "fleet.csv:4:3",
            "did you mean \"wear\"?",
            "needed with --mode",
            "fleet.csv:7:20",
            "unit B has a row already",
            "fleet.csv:9",
            "fleet.csv:10",
            "allowed with the state interval alone",
        ] {
            assert!(found.contains(says), "{says}: {found}");
        }
        let observed = "unit,cycles,quantity,value,error\nA,50,survived\nA,40,failed,wear,1\nA,60,survived\n";
        let found = faults(observed, &ALL).join("\n");
        assert!(found.contains("had survived 50") && found.contains("has failed in a row before"), "{found}");
        assert!(faults("unit,cycles,state\n", &ALL)[0].contains("no row"));
        let other_order = parse("state,cycles,unit\nrunning,50,A\n", "f", &ALL);
        assert_eq!(other_order.unwrap(), [UnitLife::Running(50.0)]);
    }
}
