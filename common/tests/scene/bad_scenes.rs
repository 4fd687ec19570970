//! Many bad scenes: every one is refused with file, line, column and what to write instead.

use common::scene::{Fault, SceneSource};

const FOUR_BAR: &str = include_str!("../../scenes/four-bar.toml");
const EVERYTHING: &str = include_str!("../scenes/everything.toml");

/// Least number of different mistakes that are tried.
const MISTAKES: usize = 70;

/// Words of which one leads to what is to be written instead.
const REMEDIES: [&str; 12] = [
    "did you mean",
    "expected",
    "allowed",
    "write ",
    "use ",
    "give ",
    "unique",
    "must ",
    "leave ",
    "needs ",
    "instead",
    "there are",
];

fn checked(text: &str, from: &str, to: &str) -> Result<(), String> {
    let Some(at) = text.find(from) else { return Err(format!("the scene has no {from}")) };
    let changed = format!("{}{to}{}", &text[..at], &text[at + from.len()..]);
    let found = match SceneSource::parse(&changed, "my.toml") {
        Ok(_) => return Err("is accepted".to_owned()),
        Err(faults) => faults.0,
    };
    let lines: Vec<&str> = changed.lines().collect();
    for fault in &found {
        placed(fault, &lines)?;
    }
    let leads = |fault: &Fault| REMEDIES.iter().any(|word| fault.to_string().contains(word));
    if found.iter().all(leads) { Ok(()) } else { Err(format!("no remedy in {found:#?}")) }
}

/// An error if the place of a fault is not one of the file.
fn placed(fault: &Fault, lines: &[&str]) -> Result<(), String> {
    let Some(place) = &fault.location else { return Err(format!("{fault} has no place")) };
    let text = lines.get(place.line - 1).copied().unwrap_or_default();
    // What is missing at the end belongs after the last character.
    let inside = (1..=text.chars().count() + 1).contains(&place.column);
    if place.file == "my.toml" && inside && place.end_column > place.column && place.text == text {
        Ok(())
    } else {
        Err(format!("{fault} has the place {place}, which the file lacks"))
    }
}

#[test]
fn every_bad_scene_has_a_place_and_a_remedy() {
    let in_four_bar = crate::rows("bad four-bar").into_iter().map(|[from, to]| (FOUR_BAR, from, to));
    let in_everything = crate::rows("bad everything").into_iter().map(|[from, to]| (EVERYTHING, from, to));
    let all: Vec<_> = in_four_bar.chain(in_everything).collect();
    assert!(all.len() >= MISTAKES, "{}", all.len());
    let failed = all.iter().filter_map(|(text, from, to)| {
        let error = checked(text, from, to).err()?;
        Some(format!("`{}`: {error}", to.replace('\n', "\\n")))
    });
    let failed: Vec<String> = failed.collect();
    assert!(failed.is_empty(), "{} of {}:\n{}", failed.len(), all.len(), failed.join("\n"));
}
