//! A random problem: its variables, responses and life, and what a simulation of it returns.

use super::course::Course;
use super::response::{Response, dot, hash_to_normal, hash_to_unit};
use common::failure::SimulationFailure;
use common::random::Distribution;
use coordinator::study::{Observed, ObservedOutcome};
use serde::Serialize;

/// Class of a problem.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Class {
    /// Periodic limit states with many small islands of failure.
    Islands,
    /// Rare events behind a kink, beside a gentle branch that does not fail first.
    Kink,
    /// Sums of random Fourier features.
    Fourier,
    /// Sums of random hinge functions.
    Lines,
    /// Series and parallel systems.
    System,
    /// Fourier features with a jump.
    Jump,
    /// Histories over life, monotone or not.
    History,
    /// Gaussian bumps and valleys.
    Bumps,
    /// Waves beyond a smooth step.
    Ridge,
    /// Waves throughout, with a bump.
    Periodic,
    /// A lognormal life.
    Lognormal,
    /// An exponential life.
    Exponential,
    /// A Weibull life.
    Weibull,
    /// Short lives beyond the threshold of a second variable.
    Bimodal,
    /// A product of powers of several variables.
    Wear,
    /// The lesser of two lives.
    Competing,
}

impl Class {
    /// All classes, in the order of the tables.
    pub const ALL: [Self; 16] = [
        Self::Islands,
        Self::Kink,
        Self::Fourier,
        Self::Lines,
        Self::System,
        Self::Jump,
        Self::History,
        Self::Bumps,
        Self::Ridge,
        Self::Periodic,
        Self::Lognormal,
        Self::Exponential,
        Self::Weibull,
        Self::Bimodal,
        Self::Wear,
        Self::Competing,
    ];

    /// Name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Islands => "islands",
            Self::Kink => "kink",
            Self::Fourier => "fourier",
            Self::Lines => "lines",
            Self::System => "system",
            Self::Jump => "jump",
            Self::History => "history",
            Self::Bumps => "bumps",
            Self::Ridge => "ridge",
            Self::Periodic => "periodic",
            Self::Lognormal => "lognormal",
            Self::Exponential => "exponential",
            Self::Weibull => "weibull",
            Self::Bimodal => "bimodal",
            Self::Wear => "wear",
            Self::Competing => "competing",
        }
    }
}

/// Numerical noise of a simulator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Standard deviation over that of the response [1].
    pub share: f64,
    /// Whether the simulator states it as its error.
    pub is_stated: bool,
}

/// Simulations that fail.
#[derive(Debug, Clone, PartialEq)]
pub enum Failing {
    /// None.
    Never,
    /// This share of all, anywhere.
    Sporadic(f64),
    /// All beyond a plane in the standardised variables.
    Beyond(Vec<f64>, f64),
}

/// A generated problem without its limit.
#[derive(Debug, Clone, PartialEq)]
pub struct RandomProblem {
    /// Number in the family: even ones are for settling, odd ones for reporting.
    pub index: u64,
    /// Class of the problem.
    pub class: Class,
    /// Random variables `(d,)`, independent.
    pub variables: Vec<Distribution>,
    /// Responses, one per limit state; the system fails with the first of them.
    pub modes: Vec<Response>,
    /// Unit of each limit state's output, over that of the response [1].
    pub units: Vec<f64>,
    /// Course over the life.
    pub course: Course,
    /// Numerical noise.
    pub noise: Noise,
    /// Simulations that fail.
    pub failing: Failing,
    /// Failure probability to be had at the end of life [1].
    pub wanted: f64,
    /// Centres of the samples that give the truth, in independent standard normals `(k)(d,)`: the origin, and the
    /// points where rare failures are most likely.
    pub centres: Vec<Vec<f64>>,
}

impl RandomProblem {
    /// Number of variables d.
    pub fn dimension(&self) -> usize {
        self.variables.len()
    }

    /// Number of checkpoints m.
    pub fn checkpoints(&self) -> usize {
        self.course.checkpoints()
    }

    /// Standardised point z `(d,)` [1] of independent standard normals u `(d,)` [1].
    pub fn standardised(&self, u: &[f64], z: &mut [f64]) {
        for ((variable, u), z) in self.variables.iter().zip(u).zip(z) {
            *z = if matches!(variable, Distribution::Normal(_)) {
                *u
            } else {
                (variable.from_standard_normal(*u) - variable.parent_mean()) / variable.parent_std()
            };
        }
    }

    /// Standardised point z `(d,)` [1] of values x `(d,)` of the variables.
    pub fn in_standard_deviations(&self, x: &[f64]) -> Vec<f64> {
        self.variables.iter().zip(x).map(|(v, x)| (x - v.parent_mean()) / v.parent_std()).collect()
    }

    /// Largest response of the limit states up to each checkpoint `(m,)` at z `(d,)` [1]: without noise, the truth.
    pub fn running_maximum(&self, z: &[f64], largest: &mut [f64]) {
        largest.fill(f64::NEG_INFINITY);
        let mut history = vec![0.0; largest.len()];
        for mode in &self.modes {
            self.history(mode, z, &mut history);
            let mut so_far = f64::NEG_INFINITY;
            for (largest, y) in largest.iter_mut().zip(&history) {
                so_far = so_far.max(*y);
                *largest = largest.max(so_far);
            }
        }
    }

    fn history(&self, mode: &Response, z: &[f64], history: &mut [f64]) {
        self.course.history(mode.value(z), z, history);
    }

    /// What a simulation at x `(d,)` returns: each limit state's output, which fails at the limit. `spread` is the
    /// standard deviation of the response [1].
    pub fn simulate(&self, x: &[f64], spread: f64) -> ObservedOutcome {
        let z = self.in_standard_deviations(x);
        let fails = match &self.failing {
            Failing::Never => false,
            Failing::Sporadic(share) => hash_to_unit(x, u64::MAX) < *share,
            Failing::Beyond(direction, edge) => dot(direction, &z) > *edge,
        };
        if fails {
            return Err(SimulationFailure::NotModelled { what: "this region".to_owned() });
        }
        let m = self.checkpoints();
        let output = |(k, (mode, unit)): (usize, (&Response, &f64))| {
            let mut history = vec![0.0; m];
            self.history(mode, &z, &mut history);
            let noise = |n: usize| match self.noise.share {
                0.0 => 0.0,
                share => share * spread * hash_to_normal(x, (k * m + n) as u64),
            };
            history.iter().enumerate().map(|(n, y)| unit * (y + noise(n))).collect::<Vec<f64>>()
        };
        let histories: Vec<Vec<f64>> = self.modes.iter().zip(&self.units).enumerate().map(output).collect();
        let mut observed = Observed::exact(histories);
        if self.noise.is_stated {
            observed.errors =
                self.units.iter().map(|unit| vec![unit * self.noise.share * spread; m]).collect();
        }
        if matches!(self.course, Course::Wear { .. }) {
            observed.start = vec![Some(0.0); self.modes.len()];
        }
        Ok(observed)
    }
}
