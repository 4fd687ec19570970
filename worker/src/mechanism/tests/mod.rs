//! Tests of the mechanism over several of its files.

mod acceleration;
mod constraint;
mod derivative;
mod friction;
mod guide;
mod order;
mod worn_guide;
