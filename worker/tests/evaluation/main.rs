//! Whole evaluations of the built-in scenes: published results, closed forms, invariances, failures.

mod backlash;
mod both_surfaces;
mod conditions;
mod energy;
mod errors;
mod expected_cost;
mod failures;
mod foundation;
mod four_bar;
mod full_turns;
mod guides;
mod hung_block;
mod ideal_friction;
mod islands;
mod kinematics;
mod loads;
mod n_four_bar;
mod nominal;
mod outputs;
mod published;
mod quasi_static;
mod rattling;
mod restitution;
mod scenes;
mod side_by_side;
mod single_cycle;
