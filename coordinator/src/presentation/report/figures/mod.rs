//! The figures of a report, drawn from its input. A function returns no figure if the input lacks its data.

mod bores;
mod cycle;
mod influences;
mod learning;
mod outputs;
mod papers;
mod reliability;

pub use bores::{bores, journal_forces, lives_in_words, orbits};
pub use cycle::{VaryingLoads, first_cycle, last_cycle};
pub use influences::{parallel_coordinates, sensitivities, variance_contributions};
pub use learning::{learning, parts_of_interval, predicted_against_simulated};
pub use outputs::{distributions, histories};
pub use papers::papers;
pub use reliability::{
    ComparedStudy, beginning, compared, curve, first_failure, reliability, shares_of_failures,
};

pub use super::format::{capital, file_name, words};

use super::life::{governing, rows_that_matter};
use super::{Ink, ReportInput, Series, Shape};
use crate::results::summary::StudySummary;

/// Layers with label, ink and heights at `places`, each on top of those before.
fn stacked(places: &[f64], layers: impl IntoIterator<Item = (String, Ink, Vec<f64>)>) -> Vec<Series> {
    let mut below = vec![0.0; places.len()];
    let layer = |(label, ink, heights): (String, Ink, Vec<f64>)| {
        let edges = places.iter().zip(&mut below).zip(heights).map(|((place, below), height)| {
            let low = *below;
            *below += height;
            (*place, low, *below)
        });
        let band: Vec<_> = edges.collect();
        let edge = band.iter().map(|(x, _, high)| (*x, *high)).collect();
        let line = Series::unlisted(format!("{label}, upper edge"), ink, Shape::Line(edge));
        [Series::new(label, ink, Shape::Band(band)), line]
    };
    layers.into_iter().flat_map(layer).collect()
}

/// Scale of the life axes: cycles, or thousands of cycles.
pub struct LifeAxis {
    divisor: f64,
    /// Label of the axis, with its unit.
    pub label: &'static str,
}

impl LifeAxis {
    /// The scale that suits the life of a study.
    pub fn new(summary: &StudySummary) -> Self {
        let last = summary.reliability.last().map_or(0, |row| row.cycles);
        if last >= 10_000 {
            Self { divisor: 1000.0, label: "life [1000 cycles]" }
        } else {
            Self { divisor: 1.0, label: "life [cycles]" }
        }
    }

    /// Number on the axis of a life, or of a time between two cycles [cycles].
    pub fn place(&self, cycles: impl Into<f64>) -> f64 {
        cycles.into() / self.divisor
    }
}

/// First and last number on the life axis of every figure of failures: from the last checkpoint without failures, or the start of
/// life if some have failed by the first one, to the first without survivors.
pub fn span(summary: &StudySummary, axis: &LifeAxis) -> (f64, f64) {
    let rows = rows_that_matter(summary, 1);
    let from = beginning(summary, rows).unwrap_or(0);
    (axis.place(from), axis.place(rows.last().map_or(0, |row| row.cycles)))
}

/// The checkpoint where the system's reliability is nearest 1/2 [cycles].
pub fn governing_cycles(input: &ReportInput) -> u32 {
    governing(&input.summary).map_or(0, |row| row.cycles)
}

/// Colour of a limit state, the same in every figure.
pub fn ink_of(summary: &StudySummary, name: &str) -> Ink {
    summary.limit_states.iter().position(|state| state == name).map_or(Ink::Ink, Ink::Series)
}

/// Smallest and largest finite value; (0, 1) if there is none.
fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let ends = values.filter(|v| v.is_finite()).map(|v| (v, v));
    ends.reduce(|(low, high), (v, _)| (low.min(v), high.max(v))).unwrap_or((0.0, 1.0))
}
