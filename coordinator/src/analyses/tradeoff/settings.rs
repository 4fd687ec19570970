//! The settings of the grid: the presets, `balanced` with single parameters changed, and combinations. A setting is its name
//! (`common::accuracy::NamedAccuracy`); a new parameter needs a word there and a line here.

use common::accuracy::{AccuracyNameError, NamedAccuracy};

/// The setting that all others are compared with.
pub const REFERENCE: &str = "reference";

/// The presets and the combinations that have been on a Pareto front: enough to characterise a scene.
pub const QUICK: [&str; 10] = [
    "draft",
    "balanced",
    "draft+step-x1.41",
    "draft+step-x1.1",
    "draft+step-x0.71",
    "step-x1.41",
    "step-x0.71",
    "step-x0.71+jump-2000",
    "jump-8000",
    "jump-2000",
];

/// Single parameters, then combinations, in addition to [`QUICK`].
const MORE: [&str; 24] = [
    "step-x2",
    "step-x0.5",
    "jump-100",
    "jump-250",
    "jump-500",
    "jump-1000",
    "wear-tolerance-5e-3",
    "wear-tolerance-1e-2",
    "wear-tolerance-5e-2",
    "samples-50",
    "samples-100",
    "samples-400",
    "samples-1000",
    "warm-up-0.02",
    "warm-up-0.2",
    "warm-up-1",
    "dynamic",
    "draft+step-x2",
    "draft+step-x0.84",
    "draft+samples-50",
    "draft+wear-tolerance-5e-2",
    "step-x0.84",
    "step-x0.71+jump-1000",
    "step-x0.5+jump-500+wear-tolerance-5e-3",
];

/// The settings of these names.
///
/// # Errors
/// [`AccuracyNameError`] for a name without meaning.
pub fn settings<'n>(
    names: impl IntoIterator<Item = &'n str>,
) -> Result<Vec<NamedAccuracy>, AccuracyNameError> {
    names.into_iter().map(str::parse).collect()
}

/// Names of the whole grid.
pub fn full() -> impl Iterator<Item = &'static str> {
    QUICK.into_iter().chain(MORE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_setting_is_another_one_and_two_are_presets() {
        let all = settings(full()).expect("every name has a meaning");
        for (k, one) in all.iter().enumerate() {
            let twin = all[..k].iter().find(|other| other.accuracy == one.accuracy);
            assert!(twin.is_none(), "{} is {}", one.name, twin.map_or("", |t| &t.name));
        }
        assert_eq!(all.iter().filter(|s| s.is_preset()).count(), 2);
        assert!(settings(["draft", "drfat"]).is_err());
    }
}
