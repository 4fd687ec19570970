//! The program `coordinator` from outside: its commands, files and words.

mod bad_input;
mod check;
mod command_line;
mod earlier_versions;
mod ends;
mod measured;
mod nonsense;
mod plans;
mod reader;
mod readme_picture;
mod schema;
mod simulators;
mod study;
mod terminal;
mod units_and_replacement;
