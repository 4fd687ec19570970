//! Choices of the wear model, read from `[wear]`: how a block of cycles wears, how the wear of a contact arc is distributed over the control
//! points, and the curve through them.
//!
//! The schema of scenes and the page about their language follow from [`WearModel::KEYS`].

use super::choice::choice;
use super::joint::{ContactLaw, Joint, JointKind};
use super::key_table::{Form, Key};
use super::section::{COUNT_LIMIT, Section, record};
use serde::{Deserialize, Serialize};

choice! {
    /// How the wear of a contact arc under `local-hertz` is distributed over the control points.
    pub enum WearDistribution;
    /// Each control point has the mean of its hat function over the arc, so that the worn volume is Archard's for every arc.
    "hat-shares" => HatShares "the wear of a contact arc is shared by hat functions, which keep the worn volume"
    /// Each control point inside the arc has the depth of the arc, the others none: an arc between two points wears nothing.
    "points-inside" => PointsInside "the wear of a contact arc goes to the control points inside it, as published"
}

choice! {
    /// The periodic cubic spline of the bore's radius.
    pub enum BoreSpline;
    /// Through the radii of the control points.
    "interpolating" => Interpolating "the bore is the cubic spline through its control points"
    /// With the radii of the control points as coefficients of the basis of B-splines: a depth at one point alone shows as 2/3 of it.
    "approximating" => Approximating "the bore is the cubic B-spline with its control points as coefficients, as published"
}

/// How the wear advances over a block of cycles.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum BlockStep {
    /// By sub-steps with error control over blocks that the accuracy sets.
    #[default]
    Controlled,
    /// By one explicit Euler step over blocks of this length [cycles].
    Explicit(u32),
}

impl BlockStep {
    /// Reads the length of a block, if it is written.
    fn read(section: &mut Section, key: &'static str) -> Option<Self> {
        let cycles = section.if_any(key, |section, key| section.integer(key, 1..=COUNT_LIMIT, None))?;
        // It fits: COUNT_LIMIT is below u32::MAX.
        Some(cycles.map_or(BlockStep::Controlled, |cycles| BlockStep::Explicit(cycles as u32)))
    }
}

/// Choices of the wear model; the default is what this program recommends, the others are there to compute as published.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct WearModel {
    /// How the wear advances over a block of cycles.
    pub explicit_step: BlockStep,
    /// How the wear of a contact arc is distributed over the control points under `local-hertz`.
    pub distribution: WearDistribution,
    /// The periodic cubic spline of the radii of a bore.
    pub spline: BoreSpline,
}

impl WearModel {
    /// Its keys in a scene.
    pub const KEYS: &'static [Key] = &[
        Key {
            name: "explicit_step",
            form: Form::Cycles,
            about: "Length of the blocks that one explicit Euler step wears, each under the contact of the cycle before it, instead \
                    of the blocks of the accuracy and their error control [cycles].",
        },
        Key {
            name: "distribution",
            form: Form::Word(&["hat-shares", "points-inside"]),
            about: "How the wear of a contact arc is distributed over the control points under `local-hertz`.",
        },
        Key {
            name: "spline",
            form: Form::Word(&["interpolating", "approximating"]),
            about: "The periodic cubic spline of the radii of a bore.",
        },
    ];

    /// The choices that are not the default, in words.
    pub fn chosen(&self) -> Vec<String> {
        let Self { explicit_step, distribution, spline } = *self;
        let default = Self::default();
        let step = match explicit_step {
            BlockStep::Controlled => None,
            BlockStep::Explicit(cycles) => Some(format!(
                "one explicit Euler step wears a block of {cycles} cycles, without error control, as published"
            )),
        };
        let share = (distribution != default.distribution).then(|| distribution.explanation().to_owned());
        let bore = (spline != default.spline).then(|| spline.explanation().to_owned());
        [step, share, bore].into_iter().flatten().collect()
    }
}

/// Reads `[wear]` of a mechanism with these `joints`, as far as they could be read; none if it is faulty.
pub(super) fn wear_model<'a>(
    file: &mut Section,
    joints: impl Iterator<Item = &'a Joint>,
) -> Option<WearModel> {
    if file.get("wear").is_none() {
        return Some(WearModel::default());
    }
    let mut section = file.section_if_any("wear")?;
    let model = record!(WearModel {
        explicit_step: BlockStep::read(&mut section, "explicit_step"),
        distribution: section.word_or("distribution", &WearDistribution::WORDS, WearDistribution::default()),
        spline: section.word_or("spline", &BoreSpline::WORDS, BoreSpline::default()),
    });
    section.finish();
    let WearModel { explicit_step, distribution, spline } = model?;
    if distribution == WearDistribution::PointsInside && explicit_step == BlockStep::Controlled {
        // The published drive fails at 66 000 cycles: no sub-step passes a jump of the rate within its tolerance.
        let message = "needs explicit_step: its wear rate jumps where a point comes into the arc";
        return section.inconsistent("distribution", message).and(None);
    }
    for Joint { name, kind, .. } in joints {
        let JointKind::Clearance(clearance) = kind else { continue };
        let [of_bushing, of_journal] = clearance.wear_coefficients().map(|coefficient| coefficient > 0.0);
        let is_local = clearance.contact_law == ContactLaw::LocalHertz;
        if distribution == WearDistribution::PointsInside && (of_bushing || of_journal) && !is_local {
            let message = format!("needs contact_law = \"local-hertz\", which joint {name} does not have");
            return section.inconsistent("distribution", message).and(None);
        }
        if spline == BoreSpline::Approximating && of_journal {
            let message = format!("is for bores alone, but the journal of joint {name} wears");
            return section.inconsistent("spline", message).and(None);
        }
    }
    model
}
