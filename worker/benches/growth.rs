//! How the cost of a time step grows with the joints: links that hang by joints with clearance, swing a little under their
//! weight and do not wear, for one cycle of 5 ms and what its stated error takes.
//!
//! `pendulums` are n links on the frame, n islands with steps of their own; `chain` is n links one below the other,
//! one island. `cargo bench -p worker --bench growth`: the counted items are time steps times joints, so that the column of
//! items per second stays the same where the cost of a step grows linearly. Steps are printed before.

use common::accuracy::Accuracy;
use common::outputs::Evaluation;
use common::scene::{Scene, SceneSource};
use divan::Bencher;
use divan::counter::ItemsCount;
use std::fmt::Write;
use worker::simulate::simulate;

fn main() {
    divan::main();
}

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

fn grow(bencher: Bencher, links: usize, chained: bool) {
    let scene = hanging(links, chained);
    let run = || -> Evaluation {
        simulate(&scene, &Accuracy::draft(), false).expect("hanging links can be simulated")
    };
    let steps = run().diagnostics.steps;
    // Every step of an island carries all its joints.
    let joint_steps = if chained { steps * links as u64 } else { steps };
    eprintln!("{} of {links}: {steps} steps", if chained { "chain" } else { "pendulums" });
    bencher.counter(ItemsCount::new(joint_steps)).bench_local(run);
}

#[divan::bench(args = [1, 2, 6, 20, 60], sample_count = 10, sample_size = 1, max_time = 2)]
fn pendulums(bencher: Bencher, links: usize) {
    grow(bencher, links, false);
}

#[divan::bench(args = [1, 2, 6, 20, 60], sample_count = 10, sample_size = 1, max_time = 2)]
fn chain(bencher: Bencher, links: usize) {
    grow(bencher, links, true);
}
