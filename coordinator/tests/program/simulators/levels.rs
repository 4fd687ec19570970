//! Levels of accuracy of a program: the finite elements of the documents, whose mesh error is known.

use super::study;
use common::random::standard_normal_quantile;

const EXAMPLE: [&str; 2] = [
    include_str!("../../../../deploy/python/examples/beam-mesh/beam.toml"),
    include_str!("../../../../deploy/python/examples/beam-mesh/beam.py"),
];

/// R after `years` by the closed form of the deflection, times a `factor` that stands for the discretisation error of a mesh.
fn reliability(years: f64, factor: f64) -> f64 {
    // 12 times the integral of (1 - x)^2 / (1 - x / 2)^3 over the beam.
    let shape = 24.0 * (4.0 * 2.0_f64.ln() - 2.5);
    let points = 200_000;
    // A lattice of the generalised golden ratio in three dimensions.
    let step = [0.819_172_513_396_164_4, 0.671_043_606_703_789_2, 0.549_700_477_901_970_2];
    let lost = 40e-6 * years;
    let holds = |k: u32| {
        let z = step.map(|step| standard_normal_quantile((0.5 + step * f64::from(k)).fract()));
        let (load, width, height) =
            (500.0 + 50.0 * z[0], 0.02 + 2e-4 * z[1] - lost, 0.04 + 2e-4 * z[2] - lost);
        factor * load * shape / (206e9 * width * height.powi(3)) < 15e-3
    };
    (0..points).filter(|k| holds(*k)).count() as f64 / f64::from(points)
}

#[test]
fn levels_of_a_program_correct_its_results() {
    let Some(study) = study("", "1 min") else { return };
    for (name, text) in ["beam.toml", "beam.py"].iter().zip(EXAMPLE) {
        std::fs::write(study.file(name), text).unwrap();
    }
    let explained = study.done("explain beam.toml");
    assert!(
        explained.contains("levels, from the coarsest to the finest: 4 elements, 8 elements"),
        "{explained}"
    );
    study.done("run beam.toml --workers 2 --out study --quiet");
    let summary = study.summary("study");
    assert_eq!(summary["levels"]["names"].as_array().unwrap().len(), 3);
    let row = &summary["levels"]["differences"][0];
    let order = row["order"].as_f64().unwrap();
    assert!((order - 2.0).abs() < 0.1, "{row}");
    for row in summary["reliability"].as_array().unwrap() {
        let (r, years) = (row["total"].as_f64().unwrap(), row["cycles"].as_f64().unwrap());
        let (exact, coarse) = (reliability(years, 1.0), reliability(years, 1.027));
        let limits = ["lower", "upper"].map(|limit| row["interval"]["total"][limit].as_f64().unwrap());
        assert!(
            limits[0] - 1e-3 <= exact && exact <= limits[1] + 1e-3,
            "{years}: {r} {limits:?}, exact {exact}"
        );
        // Without the correction they would be far off.
        assert!(
            (0.02..0.98).contains(&exact) == ((coarse - exact).abs() > 0.01),
            "{years}: {coarse} {exact}"
        );
    }
    // By messages, the same bits.
    study.done("run beam.toml --workers 2 --listen tcp/127.0.0.1:0 --out farm --quiet");
    assert_eq!(study.summary("farm"), summary);
    // Where levels cannot be, the line says so.
    for [from, to, says] in crate::rows("levels_of_a_program_correct_its_results") {
        std::fs::write(study.file("wrong.toml"), EXAMPLE[0].replace(from, to)).unwrap();
        let output = study.command("check wrong.toml --quick").output().unwrap();
        let said = String::from_utf8_lossy(&output.stdout) + String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success() && said.contains(says), "{said}");
    }
}
