//! Rounds of chaos: `cargo run --release -p tests --example chaos [MINUTES] [SEED]`. The built-in four-bar linkage with results checked
//! by a second worker, and an external program, in turns; coordinator and workers are killed and stopped at random, and the results must
//! be those of an undisturbed run. Build the programs first: `cargo build --release`.

use std::error::Error;
use std::time::{Duration, Instant};
use tests::beam_study::beam_scene;
use tests::deployed::small_scene;
use tests::faults::{ChaosStudy, chaos, same_results};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let minutes: f64 = arguments.next().map_or(Ok(15.0), |text| text.parse())?;
    let seed: u64 = arguments.next().map_or(Ok(1), |text| text.parse())?;
    let folder = tempfile::tempdir()?;
    let [linkage, beam] = ["linkage.toml", "beam.toml"].map(|name| folder.path().join(name));
    std::fs::write(&linkage, small_scene(40))?;
    std::fs::write(&beam, beam_scene(folder.path(), 0.2, "1"))?;
    let simulator = beam.display().to_string();
    let checked: &[&str] = &["--cross-check", "20%"];
    let small: &[&str] = &["--initial", "20", "--max-evaluations", "60", "--cross-check", "20%"];
    let studies = [
        ("four-bar", ChaosStudy { scene: &linkage, options: [checked, checked], of_workers: &[] }),
        (
            "beam",
            ChaosStudy { scene: &beam, options: [small, checked], of_workers: &["--simulator", &simulator] },
        ),
    ];
    let undisturbed = |name: &str| folder.path().join(format!("{name}-undisturbed"));
    for (name, study) in &studies {
        chaos(study, &undisturbed(name), 0);
    }
    let until = Instant::now() + Duration::from_secs_f64(60.0 * minutes);
    println!(
        "| round | workers killed | stopped | coordinators killed | stopped | given up | s | same results |\n|---|---|---|---|---|---|---|---|"
    );
    let mut differing = 0;
    for round in 0.. {
        if Instant::now() > until {
            break;
        }
        let (name, study) = &studies[round % studies.len()];
        let (out, begun) = (folder.path().join(format!("round-{round}")), Instant::now());
        let faults = chaos(study, &out, seed + round as u64);
        let same = same_results(&out, &undisturbed(name));
        differing += usize::from(!same);
        println!(
            "| {round}, {name} | {} | {} | {} | {} | {} | {:.0} | {same} |",
            faults.workers_killed,
            faults.workers_stopped,
            faults.coordinators_killed,
            faults.coordinators_stopped,
            faults.given_up,
            begun.elapsed().as_secs_f64()
        );
        if same {
            std::fs::remove_dir_all(out)?;
        }
    }
    if differing > 0 {
        return Err(format!("{differing} rounds have other results: {}", folder.keep().display()).into());
    }
    Ok(())
}
