//! The input model of a study, the Monte Carlo population of its random variables, and the initial design.
//!
//! Every random draw of a study comes from one of its streams, so that equal seeds give equal studies.
//!
//! # Source
//! The generator is ChaCha with 12 rounds: Bernstein (2008), ChaCha, a variant of Salsa20.

mod coordinate;
mod deviation;
mod input_model;
mod latin_hypercube;
mod moments;
mod population;

pub use deviation::deviation;
pub use input_model::InputModel;
pub use latin_hypercube::latin_hypercube;
pub use moments::{fixed_bounds, relative_spreads, with_moments};
pub use population::{Population, choose_by_latin_hypercube, nominal_and_random};

use rand_chacha::ChaCha12Rng;
use rand_chacha::rand_core::SeedableRng;

/// The independent random streams of a study: each is a separate ChaCha12 stream under the study's seed, so a
/// draw from one stream never shifts another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stream {
    /// Points of the Monte Carlo population, point by point, one uniform number per variable.
    Population,
    /// Strata and places of a Latin hypercube.
    Design,
    /// Sample of the uncertain points for the pool; a stream per round.
    Pool(u32),
    /// Realisations of the joint posterior; a stream per round.
    Realisations(u32),
    /// Subset simulation; a stream per draw.
    Subset(u32),
    /// Directions in which the rim is explored; a stream per round.
    Rim(u32),
    /// Sample of the population whose gaps are explored; a stream per round.
    Gaps(u32),
    /// Updating of a unit by its measurements; a stream per unit.
    Unit(u32),
    /// Parameters of a population, and samples that might have been measured; a stream per pass.
    Parameters(u32),
    /// Realisations of a curve of reliability, and errors of inspections.
    Curve,
}

/// Returns the generator of a stream under a seed, at its beginning.
pub fn open_stream(seed: u64, stream: Stream) -> ChaCha12Rng {
    let number = match stream {
        Stream::Population => 1,
        Stream::Design => 2,
        Stream::Pool(round) => (1 << 32) + u64::from(round),
        Stream::Realisations(round) => (2 << 32) + u64::from(round),
        Stream::Subset(draw) => (3 << 32) + u64::from(draw),
        Stream::Rim(round) => (4 << 32) + u64::from(round),
        Stream::Gaps(round) => (5 << 32) + u64::from(round),
        Stream::Unit(unit) => (9 << 32) + u64::from(unit),
        Stream::Curve => 10 << 32,
        Stream::Parameters(pass) => (11 << 32) + u64::from(pass),
    };
    let mut rng = ChaCha12Rng::seed_from_u64(seed);
    rng.set_stream(number);
    rng
}
