//! The figures of a report, from its input. Each function gives no figure where the input holds nothing to show.

mod cycle;
mod learning;
mod life;
mod numerical;

pub use cycle::{bores, first_cycle};
pub use learning::learning;
pub use life::{distributions, histories, reliability};
pub use numerical::numerical;

use super::input::ReportInput;
use super::palette::Ink;

/// A figure: name (of its file too), title, caption, and an SVG document.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Name, letters, digits and hyphens.
    pub name: String,
    /// Title, plain text.
    pub title: String,
    /// Caption, plain text.
    pub caption: String,
    /// SVG document.
    pub svg: String,
}

/// Cycles as the axes count them, and how the axes say so.
struct LifeAxis {
    divisor: f64,
    label: &'static str,
}

impl LifeAxis {
    fn of(input: &ReportInput) -> Self {
        let last = input.summary.reliability.last().map_or(0, |row| row.cycles);
        if last >= 10_000 {
            Self { divisor: 1000.0, label: "life [1000 cycles]" }
        } else {
            Self { divisor: 1.0, label: "life [cycles]" }
        }
    }

    fn at(&self, cycles: u32) -> f64 {
        f64::from(cycles) / self.divisor
    }
}

/// Colour of a limit state, the same in every figure.
pub(in crate::report) fn ink_of(input: &ReportInput, name: &str) -> Ink {
    input.limit_states.iter().position(|state| state.name == name).map_or(Ink::Ink, Ink::Series)
}

pub(super) fn figure(name: &str, title: &str, caption: &str, svg: String) -> Figure {
    Figure { name: name.into(), title: title.into(), caption: caption.into(), svg }
}

/// Smallest and largest finite value; (0, 1) if there is none.
fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let both = values.filter(|v| v.is_finite()).fold(None, |range: Option<(f64, f64)>, v| {
        Some(range.map_or((v, v), |(low, high)| (low.min(v), high.max(v))))
    });
    both.unwrap_or((0.0, 1.0))
}

/// A name of a scene as part of a file's name.
pub(in crate::report) fn file_name(name: &str) -> String {
    name.chars().map(|c| if c.is_ascii_alphanumeric() || c == '-' { c } else { '-' }).collect()
}

/// An identifier as words.
pub(in crate::report) fn words(name: &str) -> String {
    name.replace('_', " ")
}

/// With a capital first letter.
pub(in crate::report) fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}
