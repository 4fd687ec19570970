//! Time and largest wear of the dynamic settings.
use common::accuracy::{Accuracy, Tier};
use common::scene::{OutputKind, SceneSource};
use std::time::Instant;
use worker::simulate::simulate;

fn main() {
    for name in ["four-bar", "flapping-wing"] {
        let mut scene = SceneSource::builtin(name).expect("built in").nominal().clone();
        scene.outputs.retain(|o| matches!(o.kind, OutputKind::LargestWear { .. }));
        scene.limit_states.retain(|l| l.output == 0);
        for (preset, tier) in
            [("draft", Tier::Automatic), ("balanced", Tier::Dynamic), ("balanced", Tier::Automatic)]
        {
            let accuracy = Accuracy { tier, ..Accuracy::by_name(preset).unwrap() };
            let start = Instant::now();
            let e = simulate(&scene, &accuracy, false).expect("simulated");
            let d = &e.diagnostics;
            println!(
                "{name} {preset} {tier:?} {}: {:.3} s, {} um, cycles {} steps {} rej {} stages {}",
                d.quasi_static,
                start.elapsed().as_secs_f64(),
                e.histories[0].last().unwrap() * 1e6,
                d.simulated_cycles,
                d.steps,
                d.rejected_steps,
                d.wear_stages
            );
        }
    }
}
