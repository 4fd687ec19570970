//! Hingewise worker.

fn main() {}
