//! The build of the simulation in this program.

use common::build::Build;

/// The build of the simulation in this program, from the digest that the build script makes.
pub const BUILD: Build = Build::from_digits(env!("HINGEWISE_BUILD"));
