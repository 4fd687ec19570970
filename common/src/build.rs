//! Builds of the program: what determines the bits of a simulation's result besides scene, sample and settings.

use serde::{Deserialize, Serialize};
use std::fmt;

/// Digest of the sources of the simulation, of the versions of its dependencies, and of the platform. Equal builds give equal
/// results, to the last bit; of different ones that is not known.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Build(pub u64);

impl Build {
    /// A build from the 16 hexadecimal digits that the build script of the simulation prints.
    ///
    /// # Panics
    /// Where these are no such digits, at compile time.
    pub const fn from_digits(digits: &str) -> Self {
        match u64::from_str_radix(digits, 16) {
            Ok(digest) => Self(digest),
            Err(_) => panic!("a build is given by hexadecimal digits"),
        }
    }
}

/// Its hexadecimal digits.
impl fmt::Display for Build {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:016x}", self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_build_is_its_digits() {
        assert_eq!(Build::from_digits("00ff00ff00ff00ff").to_string(), "00ff00ff00ff00ff");
    }
}
