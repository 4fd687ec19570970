//! Tests of the wear over several of its files.

mod equilibrium;
mod journal;
mod local_arcs;
mod published;
mod rail;
mod random_load;
mod step;
mod volume;
