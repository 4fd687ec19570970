//! What an external simulator gives: whole lives, or cycles for the wear loop of this program.

use super::section::Section;
use serde::{Deserialize, Serialize};

/// What a simulator gives in reply to a sample.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Gives {
    /// The outputs over a whole life.
    #[default]
    Life,
    /// The contacts of one cycle on the surfaces as worn so far.
    Cycle(CycleProgram),
}

/// A program that gives cycles.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct CycleProgram {
    /// What its cycles depend on.
    pub tier: CycleTier,
    /// Folder in which the replies of lives under way are kept; `None`: they are not.
    pub journal: Option<String>,
}

/// What the cycles of a program depend on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum CycleTier {
    /// Joints with clearance, on the surfaces of the request.
    Contact,
    /// Ideal joints, whose reactions depend on no surface: one cycle serves a whole life.
    Reaction,
}

impl CycleTier {
    /// The words of the tiers in a scene.
    pub const WORDS: [(&'static str, CycleTier); 2] =
        [("contact", CycleTier::Contact), ("reaction", CycleTier::Reaction)];
}

/// Reads what a simulator gives, of `[simulator]`; none if it is faulty.
pub(super) fn gives(section: &mut Section) -> Option<Gives> {
    let is_cycle = section.word_or("gives", &[("life", false), ("cycle", true)], false)?;
    if !is_cycle {
        return Some(Gives::Life);
    }
    if section.get("umbridge").is_some() {
        section.inconsistent("gives", "is \"cycle\", which a UM-Bridge server cannot give: use a program");
        return None;
    }
    let tier = section.word("tier", &CycleTier::WORDS);
    let journal = section.if_any("journal", |section, key| section.text(key, "a folder").map(str::to_owned));
    Some(Gives::Cycle(CycleProgram { tier: tier?, journal: journal? }))
}
