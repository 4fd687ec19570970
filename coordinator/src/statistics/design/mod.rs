//! Where a study looks: the Monte Carlo population of its random variables and the initial design among it.

mod input_model;
mod latin_hypercube;
mod points;
mod population;

pub use input_model::InputModel;
pub use latin_hypercube::{choose_by_latin_hypercube, latin_hypercube};
pub use points::nominal_and_random;
pub use population::Population;

use rand_chacha::ChaCha12Rng;
use rand_chacha::rand_core::SeedableRng;

/// The independent random streams of a study. Each is a ChaCha12 stream of its own under the study's seed, so a
/// draw from one never shifts another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stream {
    /// Points of the Monte Carlo population, one point after the other, one uniform per variable.
    Population,
    /// Latin hypercube of the initial design.
    Design,
    /// Choice of the pool of uncertain points, one sub-stream per round.
    Pool(u32),
    /// Joint posterior realisations, one sub-stream per round.
    Realisations(u32),
    /// Subset simulation, one sub-stream per draw.
    Subset(u32),
}

/// Opens a stream under a seed.
pub fn open_stream(seed: u64, stream: Stream) -> ChaCha12Rng {
    let number = match stream {
        Stream::Population => 1,
        Stream::Design => 2,
        Stream::Pool(round) => (1 << 32) + u64::from(round),
        Stream::Realisations(round) => (2 << 32) + u64::from(round),
        Stream::Subset(draw) => (3 << 32) + u64::from(draw),
    };
    let mut rng = ChaCha12Rng::seed_from_u64(seed);
    rng.set_stream(number);
    rng
}
