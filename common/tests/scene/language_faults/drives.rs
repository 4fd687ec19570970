//! Faults of drives and of tables.

use super::faults;

#[test]
fn drives() {
    let both = faults("name = \"wheel\"", "[[bodies]]", "centre_of_mass = [\"0 m\", \"0 m\"]\n[[bodies]]");
    assert_eq!(both.len(), 2, "{both:#?}");
    assert!(both[0].contains("wheel.mass: is missing") && both[1].contains("wheel.inertia: is missing"));
}

#[test]
fn tables() {
    // Two points that repeat would be a straight line.
    let all = faults("name = \"wheel\"", "\"20 ms\", \"50 ms\"]", "\"20 ms\", \"5 ms\", \"1 ms\"]");
    assert_eq!(all.len(), 3, "{all:#?}");
}
