//! Choices between words: one row for each, with its word in a scene, its name in the program and its explanation.

/// Declares a choice between words; the first one is the default.
macro_rules! choice {
    ($(#[doc = $about:literal])* pub enum $Choice:ident; $($(#[doc = $doc:literal])* $word:literal => $Variant:ident $sentence:literal)*) => {
        $(#[doc = $about])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
        pub enum $Choice {
            $($(#[doc = $doc])* $Variant,)*
        }

        impl $Choice {
            /// Every choice, in the order of the table.
            pub const ALL: [Self; [$($word),*].len()] = [$(Self::$Variant),*];

            /// Every choice by its word in a scene.
            pub const WORDS: [(&'static str, Self); [$($word),*].len()] = [$(($word, Self::$Variant)),*];

            /// Its word in a scene.
            pub fn word(self) -> &'static str {
                Self::WORDS[self as usize].0
            }

            /// What it is, in words.
            pub fn explanation(self) -> &'static str {
                [$($sentence),*][self as usize]
            }
        }

        impl Default for $Choice {
            fn default() -> Self {
                Self::ALL[0]
            }
        }
    };
}
pub(super) use choice;
