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

/// Pieces of a scene and what replaces them.
const IN_FOUR_BAR: [(&str, &str); 48] = [
    // Values and units.
    ("width = \"width\"", "width = \"20 mmm\""),
    ("width = \"width\"", "width = \"20,5 mm\""),
    ("width = \"width\"", "width = \"20\""),
    ("width = \"width\"", "width = 20"),
    ("width = \"width\"", "width = \"20 N\""),
    ("width = \"width\"", "width = \"-20 mm\""),
    ("width = \"width\"", "width = \"0 mm\""),
    ("width = \"width\"", "width = \"widht\""),
    ("width = \"width\"", "width = \"2 width\""),
    ("width = \"width\"", "width = \"1 mm + 1 N\""),
    ("width = \"width\"", "width = \"1 mm / 0\""),
    ("width = \"width\"", "width = \"sqrt(1 mm)\""),
    ("width = \"width\"", "width = \"(1 mm\""),
    ("width = \"width\"", "width = \"\""),
    ("width = \"width\"", "width = true"),
    ("width = \"width\"", "width = [\"1 mm\"]"),
    ("width = \"width\"", "width = \"10 \u{b0}\""),
    ("width = \"width\"", "widht = \"1 mm\"\nwidth = \"width\""),
    ("\"206 GPa\"", "\"206 Gpa\""),
    ("\"206 GPa\"", "\"206 N/m\""),
    ("speed = \"900 r/min\"", "speed = \"900 1/min\""),
    ("speed = \"900 r/min\"", "speed = \"900\""),
    ("speed = \"900 r/min\"", "speed = \"0 r/min\""),
    ("friction = 0.05", "friction = \"3 deg\""),
    ("friction = 0.05", "friction = 5"),
    ("width = \"10 mm\"", "width = \"width\""),
    ("width = \"10 mm\"", "width = \"10 mm\"\nmm = 3"),
    // References and words.
    ("motion = \"driven\"", "motion = \"drive\""),
    ("body = \"rocker\"\n", "body = \"roker\"\n"),
    ("type = \"constant-torque\"", "type = \"torqe\""),
    ("changes = [\"joints.crank.radial_clearance\"]", "changes = [\"joints.crank.clearance\"]"),
    ("changes = [\"joints.crank.radial_clearance\"]", "changes = []"),
    ("distribution = \"truncated-normal\"\nstd = \"2 um\"", "distribution = \"normel\"\nstd = \"2 um\""),
    ("std = \"2 um\"", "std = \"2 N\""),
    ("std = \"2 um\"", "std = \"0 um\""),
    ("std = \"2 um\"", "std = \"11 um\""),
    ("std = \"2 um\"", "fit = \"lognormal\""),
    ("std = \"2 um\"", "fit = \"H7/z99\"\ndiameter = \"8 mm\""),
    ("std = \"2 um\"", "samples = [\"20 um\", \"21 um\"]"),
    // Life and structure.
    ("cycles = 8000", "cycles = 0"),
    ("cycles = 8000", "cycles = \"8000\""),
    ("cycles = 8000", "cycles = 8500"),
    ("cycles = 8000\n", ""),
    ("friction_speed = \"friction_speed\"\n", ""),
    ("[[loads]]", "[loads]"),
    // Syntax.
    ("friction = 0.05", "friction = 0,05"),
    ("width = \"width\"", "width = 20 mm"),
    ("width = \"10 mm\"", "width = \u{201c}10 mm\u{201d}"),
];

const IN_EVERYTHING: [(&str, &str); 22] = [
    ("type = \"revolute\"", "type = \"ideal\""),
    ("axis = \"15 deg\"", "axis = \"15 mm\""),
    ("restitution = 0.9", "restitution = 2"),
    ("no_load_speed = \"-3000 r/min\"", "no_load_speed = \"0 r/min\""),
    ("settle_cycles = 3", "settle_cycles = -3"),
    ("control_points = 40", "control_points = 7"),
    ("control_points = 40", "control_points = 36.5"),
    ("direction = [0, 2]", "direction = [0]"),
    ("direction = [0, 2]", "direction = [0, 0]"),
    ("contact_damping = \"none\"", "contact_damping = \"nun\""),
    ("wear = false", "wear = \"no\""),
    ("sign = 1", "sign = 2"),
    ("seed = 7", "seed = -7"),
    ("name = \"too_deep\"", "name = \"total\""),
    ("distribution = \"constant\"", "distribution = \"constant\"\nstd = \"1 %\""),
    ("rank = -0.3", "rank = -0.3\ncoefficient = 0.2"),
    ("rank = -0.3", "rank = -1.3"),
    ("name = \"everything\"", ""),
    ("[life]", "[lief]"),
    ("name = \"weld\"", "name = \"guide\""),
    ("name = \"weld\"", "name = \"we.ld\""),
    ("\"1e-13 1/Pa\"", "\"1e-13 Pa\""),
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
    let in_four_bar = IN_FOUR_BAR.iter().map(|(from, to)| (FOUR_BAR, *from, *to));
    let in_everything = IN_EVERYTHING.iter().map(|(from, to)| (EVERYTHING, *from, *to));
    let all: Vec<_> = in_four_bar.chain(in_everything).collect();
    assert!(all.len() >= MISTAKES, "{}", all.len());
    let failed = all.iter().filter_map(|(text, from, to)| {
        let error = checked(text, from, to).err()?;
        Some(format!("`{}`: {error}", to.replace('\n', "\\n")))
    });
    let failed: Vec<String> = failed.collect();
    assert!(failed.is_empty(), "{} of {}:\n{}", failed.len(), all.len(), failed.join("\n"));
}
