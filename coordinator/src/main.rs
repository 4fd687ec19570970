//! Hingewise coordinator.

fn main() {}
