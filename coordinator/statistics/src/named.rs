//! Names of the values of a setting, as they stand in campaign files, in results and on the command line.

use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt::Display;
use std::str::FromStr;
use thiserror::Error;

/// A name that stands for no value of a setting.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("unknown name {name:?}, allowed: {allowed}")]
pub struct UnknownName {
    /// The name as given.
    pub name: String,
    /// Allowed names, separated by commas.
    pub allowed: String,
}

/// Names the variants of a fieldless enum: defines `ALL`, `NAMES`, `name`, and implements `Display`, `FromStr`,
/// `Serialize` and `Deserialize` by these names.
#[macro_export]
macro_rules! named {
    ($type:ident { $($variant:ident = $name:literal),+ $(,)? }) => {
        impl $type {
            /// All values, in the order of [`Self::NAMES`].
            pub const ALL: [Self; [$($name),+].len()] = [$(Self::$variant),+];

            /// Names of all values, as on the command line and in files.
            pub const NAMES: [&'static str; [$($name),+].len()] = [$($name),+];

            /// Name of this value, as on the command line and in files.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $name),+
                }
            }
        }

        impl std::fmt::Display for $type {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.pad(self.name())
            }
        }

        impl std::str::FromStr for $type {
            type Err = $crate::named::UnknownName;

            fn from_str(name: &str) -> Result<Self, Self::Err> {
                Self::ALL.into_iter().find(|value| value.name() == name).ok_or_else(|| Self::Err {
                    name: name.to_owned(),
                    allowed: Self::NAMES.join(", "),
                })
            }
        }

        impl serde::Serialize for $type {
            fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.serialize_str(self.name())
            }
        }

        impl<'de> serde::Deserialize<'de> for $type {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                let name = <String as serde::Deserialize>::deserialize(deserializer)?;
                name.parse().map_err(serde::de::Error::custom)
            }
        }
    };
}
pub use named;

/// The name of a choice that is left to the program.
pub const AUTO: &str = "auto";

/// Reads the name of a value, or [`AUTO`] as `None`.
///
/// # Errors
/// The error of the value's own `FromStr`.
pub fn parse_or_auto<T: FromStr>(name: &str) -> Result<Option<T>, T::Err> {
    if name == AUTO { Ok(None) } else { name.parse().map(Some) }
}

/// Writes an optional value by its name, `None` as [`AUTO`].
pub(crate) fn serialize<T: Display, S: Serializer>(value: &Option<T>, to: S) -> Result<S::Ok, S::Error> {
    value.as_ref().map_or_else(|| AUTO.to_owned(), T::to_string).serialize(to)
}

/// Reads what [`serialize`] wrote.
pub(crate) fn deserialize<'de, T, D>(from: D) -> Result<Option<T>, D::Error>
where
    T: FromStr<Err: Display>,
    D: Deserializer<'de>,
{
    parse_or_auto(&String::deserialize(from)?).map_err(serde::de::Error::custom)
}

#[cfg(test)]
mod tests {
    use crate::learning::LearningFunction;
    use crate::named::parse_or_auto;
    use crate::surrogate::{FormSettings, Kernel, StatedErrors, Trend};

    #[test]
    fn every_name_is_read_back_and_no_other() {
        fn check<T: std::str::FromStr<Err: std::fmt::Display> + ToString>(all: impl IntoIterator<Item = T>) {
            for value in all {
                let read = value.to_string().parse::<T>().ok().map(|read| read.to_string());
                assert_eq!(read, Some(value.to_string()));
            }
            assert!("exact".parse::<T>().is_err_and(|error| error.to_string().contains("allowed: ")));
        }
        check(LearningFunction::ALL);
        check(Kernel::ALL);
        check(Trend::ALL);
        check(StatedErrors::ALL);
    }

    #[test]
    fn an_open_choice_is_auto() {
        assert_eq!(parse_or_auto::<Kernel>("auto"), Ok(None));
        let forms = FormSettings { kernel: Some(Kernel::Matern52), trend: None };
        let text = serde_json::to_string(&forms).unwrap();
        assert_eq!(text, r#"{"kernel":"matern52","trend":"auto"}"#);
        assert_eq!(serde_json::from_str::<FormSettings>(&text).unwrap(), forms);
        assert_eq!(serde_json::from_str::<FormSettings>("{}").unwrap(), FormSettings::default());
    }
}
