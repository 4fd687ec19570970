//! The scene language: what is read, what is refused, and with which words.

mod bad_scenes;
mod builtin;
mod conditions;
mod couplings;
mod csv;
mod expressions;
mod faults;
mod language;
mod language_faults;
mod language_tables;
mod levels;
mod mistakes;
mod places;
mod quantity_patterns;
mod random;
mod reference;
mod rows;
mod shown_units;
mod simulator;
mod starts;
mod units;
mod wear_model;
mod wear_tables;

/// The rows of a section of `cases.txt`.
fn rows<const N: usize>(section: &str) -> Vec<[&'static str; N]> {
    rows::rows(include_str!("cases.txt"), section)
}
