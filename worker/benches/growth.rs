//! How the cost of a time step grows with the joints: links that hang by joints with clearance, swing a little under their
//! weight and do not wear, for one cycle of 5 ms and what its stated error takes.
//!
//! `pendulums` are n links on the frame, n islands with steps of their own; `chain` is n links one below the other,
//! one island. `cargo bench -p worker --bench growth` prints a table: time steps of an island, and the time of one step
//! per joint it carries, relative to that of a single joint: 1 wherever the cost grows linearly. Of the time only what the
//! processor spent on this program counts, where the system tells.

use common::accuracy::Accuracy;
use common::scene::{Scene, SceneSource};
use std::fmt::Write;
use std::time::Instant;
use worker::simulate::{SimulateOptions, simulate};

const LENGTH_MM: f64 = 50.0;
const ANGLE_DEG: f64 = -80.0;

/// `links` links, side by side or, if `chained`, one below the other.
fn hanging(links: usize, chained: bool) -> Scene {
    let mut text = String::from(
        r#"
        gravity = ["0 m/s^2", "-9.81 m/s^2"]
        scene.name = "hanging-links"
        life = { cycles = 1, checkpoint_every = 1, settle_cycles = 0, period = "5 ms" }
        outputs = [{ name = "force", type = "peak-joint-force" }]
        [materials.steel]
        elastic_modulus = "206 GPa"
        poisson_ratio = 0.3
        [[bodies]]
        name = "frame"
        motion = "fixed"
        points.pin = ["0 mm", "0 mm"]
        "#,
    );
    let (sin, cos) = ANGLE_DEG.to_radians().sin_cos();
    for k in 0..links {
        let place = if chained { k as f64 * LENGTH_MM } else { 0.0 };
        let (x, y) = (place * cos, place * sin);
        let bushing = if chained && k > 0 {
            format!(r#"{{ body = "link{}", point = "end" }}"#, k - 1)
        } else {
            r#"{ body = "frame", point = "pin" }"#.to_owned()
        };
        write!(
            text,
            r#"
            [[bodies]]
            name = "link{k}"
            motion = "free"
            mass = "20 g"
            inertia = "4.2e-6 kg m^2"
            centre_of_mass = ["25 mm", "0 mm"]
            start_position = ["{x} mm", "{y} mm"]
            start_angle = "{ANGLE_DEG} deg"
            points.pin = ["0 mm", "0 mm"]
            points.end = ["{LENGTH_MM} mm", "0 mm"]
            [[joints]]
            name = "joint{k}"
            type = "clearance"
            journal = {{ body = "link{k}", point = "pin" }}
            bushing = {bushing}
            journal_radius = "4 mm"
            radial_clearance = "30 um"
            width = "10 mm"
            journal_material = "steel"
            bushing_material = "steel"
            contact_law = "local-hertz"
            contact_damping = {{ hunt_crossley = "2 s/m" }}
            film_damping = "100 N s/m"
            friction = 0.05
            friction_speed = "5 mm/s"
            wear = false
            "#
        )
        .expect("a string takes all");
    }
    let source = SceneSource::parse(&text, "hanging links");
    source.unwrap_or_else(|faults| panic!("{faults}")).nominal().clone()
}

/// Processor time this program has had [s], which Linux tells to a hundredth of a second; elsewhere the time since `start`.
fn spent(start: Instant) -> f64 {
    const TICKS_PER_SECOND: f64 = 100.0;
    let told = std::fs::read_to_string("/proc/self/stat").ok();
    // The name of the program, in parentheses, may hold anything; user and system time are fields 12 and 13 after it.
    let ticks = told.and_then(|text| {
        let fields = text.rsplit(") ").next()?.split(' ').skip(11).take(2);
        fields.map(|field| field.parse::<f64>().ok()).sum::<Option<f64>>()
    });
    ticks.map_or_else(|| start.elapsed().as_secs_f64(), |ticks| ticks / TICKS_PER_SECOND)
}

/// Time steps of all islands together, and the mean time of as many runs as take a second [s].
fn run(scene: &Scene) -> (u64, f64) {
    const LONG_ENOUGH: f64 = 1.0;
    let start = Instant::now();
    let before = spent(start);
    let mut runs = 0;
    loop {
        let found = simulate(scene, &Accuracy::draft(), SimulateOptions::default())
            .expect("hanging links can be simulated");
        runs += 1;
        let all = spent(start) - before;
        if all > LONG_ENOUGH {
            let steps = found.diagnostics.steps + found.diagnostics.rejected_steps;
            return (steps, all / f64::from(runs));
        }
    }
}

fn main() {
    println!(
        "| joints | pendulums: steps | time per step and joint | chain: steps | time per step and joint |"
    );
    println!("| --- | --- | --- | --- | --- |");
    let mut single = [f64::NAN; 2];
    for links in [1, 2, 6, 20, 60] {
        let mut line = format!("| {links} |");
        for (chained, single) in [false, true].into_iter().zip(&mut single) {
            let (steps, seconds) = run(&hanging(links, chained));
            // A step of the chain carries all joints, one of a pendulum its own.
            let islands = if chained { 1 } else { links as u64 };
            let each = seconds / (steps * links as u64 / islands) as f64;
            if links == 1 {
                *single = each;
            }
            write!(line, " {} | {:.2} |", steps / islands, each / *single).expect("a string takes all");
        }
        println!("{line}");
    }
}
