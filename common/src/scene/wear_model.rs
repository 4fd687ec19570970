//! Choices of the wear model, read from `[wear]`: how a block of cycles wears, how the wear of a contact arc is distributed over the control
//! points, and the curve through them.
//!
//! The table of [`WearModel`] gives its fields, its reader, the schema of scenes, the page about their language and the lines of `explain`.

use super::joint::{ContactLaw, Joint, JointKind};
use super::key_table::{Form, Key};
use super::section::{COUNT_LIMIT, Section};
use serde::{Deserialize, Serialize};

/// A choice of the wear model as scenes write it.
trait Choice: Copy + Default + PartialEq {
    /// How it is written.
    const FORM: Form;

    /// Reads it, if it is written; the default otherwise.
    fn read(section: &mut Section, key: &'static str) -> Option<Self>;

    /// What it is, in words.
    fn in_words(self) -> String;
}

/// Declares a choice between words; the first one is the default.
macro_rules! choice {
    ($(#[doc = $about:literal])* pub enum $Choice:ident; $($(#[doc = $doc:literal])* $word:literal => $Variant:ident $sentence:literal)*) => {
        $(#[doc = $about])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
        pub enum $Choice {
            $($(#[doc = $doc])* $Variant,)*
        }

        impl $Choice {
            /// Every choice by its word in a scene.
            const WORDS: &'static [(&'static str, Self)] = &[$(($word, Self::$Variant)),*];
        }

        impl Default for $Choice {
            fn default() -> Self {
                Self::WORDS[0].1
            }
        }

        impl Choice for $Choice {
            const FORM: Form = Form::Word(&[$($word),*]);

            fn read(section: &mut Section, key: &'static str) -> Option<Self> {
                section.word_or(key, Self::WORDS, Self::default())
            }

            fn in_words(self) -> String {
                match self {
                    $(Self::$Variant => $sentence.to_owned(),)*
                }
            }
        }
    };
}

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

impl Choice for BlockStep {
    const FORM: Form = Form::Cycles;

    fn read(section: &mut Section, key: &'static str) -> Option<Self> {
        if section.get(key).is_none() {
            return Some(BlockStep::Controlled);
        }
        // It fits: COUNT_LIMIT is below u32::MAX.
        section.integer(key, 1..=COUNT_LIMIT, None).map(|cycles| BlockStep::Explicit(cycles as u32))
    }

    fn in_words(self) -> String {
        match self {
            BlockStep::Controlled => "the wear of a block is integrated with error control".to_owned(),
            BlockStep::Explicit(cycles) => format!(
                "one explicit Euler step wears a block of {cycles} cycles, without error control, as published"
            ),
        }
    }
}

/// Declares the wear model from the table of its choices.
macro_rules! choices {
    ($(#[doc = $about:literal])* pub struct $Model:ident; $($(#[doc = $doc:literal])* $key:ident: $type:ty,)*) => {
        $(#[doc = $about])*
        #[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
        #[serde(default)]
        pub struct $Model {
            $($(#[doc = $doc])* pub $key: $type,)*
        }

        impl $Model {
            /// Its keys in a scene.
            pub const KEYS: &'static [Key] =
                &[$(Key { name: stringify!($key), form: <$type as Choice>::FORM, about: concat!($($doc),*) }),*];

            /// Reads all keys of `[wear]`; none if one is faulty.
            fn keys(section: &mut Section) -> Option<Self> {
                $(let $key = <$type as Choice>::read(section, stringify!($key));)*
                Some($Model { $($key: $key?,)* })
            }

            /// The choices that are not the default, in words.
            pub fn chosen(&self) -> Vec<String> {
                let mut chosen = vec![];
                $(if self.$key != <$type>::default() {
                    chosen.push(self.$key.in_words());
                })*
                chosen
            }
        }
    };
}

choices! {
    /// Choices of the wear model; the default is what this program recommends, the others are there to compute as published.
    pub struct WearModel;
    /// Length of the blocks that one explicit Euler step wears, each under the contact of the cycle before it, instead of the blocks of the
    /// accuracy and their error control [cycles].
    explicit_step: BlockStep,
    /// How the wear of a contact arc is distributed over the control points under `local-hertz`.
    distribution: WearDistribution,
    /// The periodic cubic spline of the radii of a bore.
    spline: BoreSpline,
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
    let model = WearModel::keys(&mut section);
    section.finish();
    let WearModel { explicit_step, distribution, spline } = model?;
    if distribution == WearDistribution::PointsInside && explicit_step == BlockStep::Controlled {
        // The published drive fails at 66 000 cycles: no sub-step passes a jump of the rate within its tolerance.
        section.inconsistent(
            "distribution",
            "needs explicit_step: its wear rate jumps where a point comes into the arc",
        );
        return None;
    }
    for Joint { name, kind, .. } in joints {
        let JointKind::Clearance(clearance) = kind else { continue };
        let [of_bushing, of_journal] = clearance.wear_coefficients().map(|coefficient| coefficient > 0.0);
        let is_local = clearance.contact_law == ContactLaw::LocalHertz;
        if distribution == WearDistribution::PointsInside && (of_bushing || of_journal) && !is_local {
            let message = format!("needs contact_law = \"local-hertz\", which joint {name} does not have");
            section.inconsistent("distribution", message);
            return None;
        }
        if spline == BoreSpline::Approximating && of_journal {
            let message = format!("is for bores alone, but the journal of joint {name} wears");
            section.inconsistent("spline", message);
            return None;
        }
    }
    model
}
