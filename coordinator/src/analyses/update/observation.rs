//! What was observed of a unit.

/// What of a unit can be measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Observable {
    /// The output of the scene with this index.
    Output(usize),
    /// The random variable of the scene with this index.
    Variable(usize),
}

/// The quantity of an observation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Quantity {
    /// It was measured.
    Measured {
        /// What was measured.
        of: Observable,
        /// Value [unit of the output, or SI].
        value: f64,
        /// Standard deviation of its error [unit of the output, or SI].
        error: f64,
    },
    /// The unit had not failed by then.
    Survived,
    /// The unit had failed by then.
    Failed {
        /// Index of the limit state that failed first, if it is known.
        by: Option<usize>,
        /// Standard deviation of the error of the life at which it failed; `None` if it failed at some life until then [cycles].
        error: Option<f64>,
    },
}

impl Quantity {
    /// Rank among observations at the same life: variables, survival, outputs, failure.
    pub(super) fn rank(&self) -> u8 {
        match self {
            Self::Measured { of: Observable::Variable(_), .. } => 0,
            Self::Survived => 1,
            Self::Measured { of: Observable::Output(_), .. } => 2,
            Self::Failed { .. } => 3,
        }
    }
}

/// One observation of a unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Observation {
    /// Line of the file.
    pub line: u64,
    /// Life of the unit then; a variable does not change over life [cycles].
    pub cycles: f64,
    /// Name of the quantity as written.
    pub name: String,
    /// What was observed.
    pub quantity: Quantity,
}

/// A unit with its observations, in the order of their lives.
#[derive(Debug, Clone, PartialEq)]
pub struct ObservedUnit {
    /// Name of the unit.
    pub name: String,
    /// At least one observation.
    pub observations: Vec<Observation>,
}

impl ObservedUnit {
    /// Life up to which the unit was observed [cycles].
    pub fn observed_until(&self) -> f64 {
        self.observations.iter().map(|o| o.cycles).fold(0.0, f64::max)
    }

    /// Life by which the unit had failed [cycles].
    pub fn failed_by(&self) -> Option<f64> {
        self.failure().map(|failure| failure.cycles)
    }

    /// The observation that it had failed.
    pub(super) fn failure(&self) -> Option<&Observation> {
        self.observations.iter().find(|o| matches!(o.quantity, Quantity::Failed { .. }))
    }

    /// Outputs that were measured.
    pub fn outputs(&self) -> impl Iterator<Item = usize> + '_ {
        self.observations.iter().filter_map(|o| match o.quantity {
            Quantity::Measured { of: Observable::Output(output), .. } => Some(output),
            _ => None,
        })
    }
}

/// Parameter of the population that the units come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Moment {
    /// The mean of a random variable, or the value of a design variable.
    Mean,
    /// The standard deviation.
    Std,
    /// The correlation with the variable of this index, which is larger.
    CorrelationWith(usize),
}

/// An unknown parameter as a file names it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UnknownParameter {
    /// Index of the random variable.
    pub variable: usize,
    /// What of it.
    pub moment: Moment,
    /// Value and standard deviation of its prior [SI]; `None` for a flat one.
    pub prior: Option<(f64, f64)>,
}

/// Units of a population and what of it is not known.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FleetData {
    /// The units, in the order of the file.
    pub units: Vec<ObservedUnit>,
    /// The unknown parameters that the file names, in its order.
    pub unknown: Vec<UnknownParameter>,
    /// Prices of further observations: of one measured value, or of a unit run to failure (`None`).
    pub prices: Vec<(Option<Observable>, f64)>,
}
