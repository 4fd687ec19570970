//! The settings that are tried: the presets, and `balanced` with one knob turned at a time or several together.

use common::accuracy::{Accuracy, Tier};

/// A named setting.
#[derive(Debug, Clone, PartialEq)]
pub struct Setting {
    /// Name: of the preset, or of what is different from `balanced`.
    pub name: String,
    /// The setting.
    pub accuracy: Accuracy,
    /// Whether it is one of the presets.
    pub preset: bool,
}

/// All settings, presets first; `reference` is not among them, it is what they are compared with.
pub fn settings() -> Vec<Setting> {
    let balanced = Accuracy::balanced();
    let mut all = Vec::new();
    let mut add =
        |name: String, accuracy: Accuracy, preset: bool| all.push(Setting { name, accuracy, preset });
    add("draft".into(), Accuracy::draft(), true);
    add("balanced".into(), balanced, true);
    for factor in [0.5, 0.71, 1.41, 2.0] {
        add(format!("steps x {:.2}", 1.0 / factor), balanced.refined(factor), false);
    }
    for cycle_jump in [250, 500, 1000, 4000, 8000] {
        add(format!("jump of {cycle_jump} cycles"), Accuracy { cycle_jump, ..balanced }, false);
    }
    for wear_samples in [150, 300, 1200] {
        add(format!("{wear_samples} wear samples"), Accuracy { wear_samples, ..balanced }, false);
    }
    for warm_up in [0.02, 0.2, 1.0] {
        add(format!("warm-up of {warm_up} cycles"), Accuracy { warm_up, ..balanced }, false);
    }
    add("always dynamic".into(), Accuracy { tier: Tier::Dynamic, ..balanced }, false);
    for (factor, cycle_jump) in [(0.71, 4000), (0.5, 4000), (0.5, 8000), (1.41, 1000)] {
        let accuracy = Accuracy { cycle_jump, ..balanced.refined(factor) };
        add(format!("steps x {:.2}, jump of {cycle_jump} cycles", 1.0 / factor), accuracy, false);
    }
    all
}
