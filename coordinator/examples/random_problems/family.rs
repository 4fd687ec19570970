//! The families: problem `index` of a seed is drawn from the random numbers of both.

use super::course::Course;
use super::draw::direction;
use super::problem::{Class, Failing, Noise, RandomProblem};
use super::response::Response;
use super::{bulk, first, lives};
use clap::ValueEnum;
use common::random::Distribution;
use rand::RngExt;
use rand_chacha::ChaCha12Rng;
use rand_chacha::rand_core::SeedableRng;

/// A family of problems.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Family {
    /// Islands, kinks, Fourier features, hinge functions, systems, jumps, histories.
    First,
    /// Bumps, ridges and waves in the bulk of the population.
    Bulk,
    /// Lives of known distribution, or worn products of several variables.
    Lives,
}

/// Responses and what belongs to them, before noise and failures.
pub struct Shape {
    /// Random variables `(d,)`.
    pub variables: Vec<Distribution>,
    /// Responses.
    pub modes: Vec<Response>,
    /// Course over the life.
    pub course: Course,
    /// Failure probability to be had at the end of life [1].
    pub wanted: f64,
    /// Centres of the truth besides the origin.
    pub centres: Vec<Vec<f64>>,
}

impl Family {
    /// Classes in turn.
    const fn turn(self) -> &'static [Class] {
        match self {
            Self::First => &first::TURN,
            Self::Bulk => &bulk::TURN,
            Self::Lives => &lives::TURN,
        }
    }

    /// Share of the problems with noise, and with failing simulations [1].
    const fn disturbed(self) -> (f64, f64) {
        match self {
            Self::First => (0.2, 0.1),
            Self::Bulk => (0.05, 0.05),
            Self::Lives => (0.0, 0.0),
        }
    }

    /// Class of problem `index`.
    pub fn class_of(self, index: u64) -> Class {
        self.turn()[(index / 2 % self.turn().len() as u64) as usize]
    }

    /// Names of the classes, in the order of the tables.
    pub fn classes(self) -> Vec<&'static str> {
        Class::ALL.into_iter().filter(|class| self.turn().contains(class)).map(Class::name).collect()
    }

    /// Problem `index` of the family of `seed`.
    pub fn problem(self, seed: u64, index: u64) -> RandomProblem {
        let mut rng = ChaCha12Rng::seed_from_u64(seed);
        rng.set_stream(index | ((self as u64) << 32));
        let class = self.class_of(index);
        let shape = match self {
            Self::First => first::shape(&mut rng, class),
            Self::Bulk => bulk::shape(&mut rng, class),
            Self::Lives => lives::shape(&mut rng, class),
        };
        let d = shape.variables.len();
        let (noisy, failing) = self.disturbed();
        let noise = if rng.random_bool(noisy) {
            Noise { share: rng.random_range(0.001..0.02), is_stated: rng.random_bool(0.5) }
        } else {
            Noise { share: 0.0, is_stated: false }
        };
        let failing = if rng.random_bool(1.0 - failing) {
            Failing::Never
        } else if rng.random_bool(0.5) {
            Failing::Sporadic(rng.random_range(0.005..0.05))
        } else {
            Failing::Beyond(direction(&mut rng, d), rng.random_range(1.8..2.5))
        };
        let units = shape.modes.iter().map(|_| 10.0_f64.powf(rng.random_range(-2.0..2.0))).collect();
        let mut centres = shape.centres;
        centres.insert(0, vec![0.0; d]);
        RandomProblem {
            index,
            class,
            variables: shape.variables,
            modes: shape.modes,
            units,
            course: shape.course,
            noise,
            failing,
            wanted: shape.wanted,
            centres,
        }
    }
}
