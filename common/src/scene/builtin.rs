//! The built-in scenes, embedded in the program.

/// Name and text of each built-in scene.
pub(super) const SCENES: [(&str, &str); 8] = [
    ("flapping-wing", include_str!("../../scenes/flapping-wing.toml")),
    ("flapping-wing-tolerances", include_str!("../../scenes/flapping-wing-tolerances.toml")),
    ("flapping-wing-experiment", include_str!("../../scenes/flapping-wing-experiment.toml")),
    ("flapping-wing-as-published", include_str!("../../scenes/flapping-wing-as-published.toml")),
    ("four-bar", include_str!("../../scenes/four-bar.toml")),
    ("slider-crank", include_str!("../../scenes/slider-crank.toml")),
    ("pendulum", include_str!("../../scenes/pendulum.toml")),
    ("andrews-squeezer", include_str!("../../scenes/andrews-squeezer.toml")),
];

/// Text of a built-in scene; none if there is no scene of this name.
pub(super) fn text(name: &str) -> Option<&'static str> {
    SCENES.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
}

/// Text of the published results of a built-in scene; none if there are none.
pub(super) fn reference(name: &str) -> Option<&'static str> {
    (name == "flapping-wing").then_some(include_str!("../../scenes/flapping-wing.reference.toml"))
}
