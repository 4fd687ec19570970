//! Random variables as scenes write them: every law, fits, correlations, and what is refused.

use common::random::{Distribution, Extreme};
use common::scene::SceneSource;

const EVERYTHING: &str = include_str!("../scenes/everything.toml");
const FOUR_BAR: &str = include_str!("../../scenes/four-bar.toml");

fn law(source: &SceneSource, name: &str) -> Distribution {
    source.variables().iter().find(|variable| variable.name == name).unwrap().distribution.clone()
}

#[test]
fn every_law_has_the_parameters_of_its_keys() {
    let source = SceneSource::parse(EVERYTHING, "everything").unwrap();
    for (name, expected) in [
        ("brake", Distribution::normal(-0.8, 0.02 * 0.8)),
        ("friction_worn", Distribution::lognormal(0.05, 0.2 * 0.05)),
        ("soft", Distribution::uniform(0.5, 1.5)),
        ("hard", Distribution::gumbel(2000.0, 0.03 * 2000.0, Extreme::Maxima)),
        ("lift", Distribution::gumbel(95.0, 0.03 * 95.0, Extreme::Minima)),
        ("modulus", Distribution::weibull(206e9, 8e9)),
        ("friction_held", Distribution::exponential_from(0.04, 0.05)),
        ("poisson_ratio", Distribution::beta(0.3, 0.02, 0.2, 0.4)),
        ("width_undamped", Distribution::triangular(9.9e-3, 10e-3, 10.2 / 1e3)),
        ("torsion", Distribution::constant(0.5)),
    ] {
        assert_eq!(law(&source, name), expected.unwrap(), "{name}");
    }
    // The nominal scene has every variable at its mean, also where the scene has another value.
    let scene = source.nominal();
    let joint = scene.joints.iter().find(|joint| joint.name == "undamped").unwrap();
    let common::scene::JointKind::Clearance(clearance) = &joint.kind else { panic!() };
    assert!((clearance.width - (9.9e-3 + 10e-3 + 10.2e-3) / 3.0).abs() < 1e-15);
}

#[test]
fn a_fit_gives_the_radial_clearance_of_its_limits() {
    let source = SceneSource::parse(EVERYTHING, "everything").unwrap();
    // 8 mm H7: 0 to 15 um; e8: -47 to -25 um: a diametral clearance of 7.5 + 36 um.
    let found = law(&source, "clearance_undamped");
    let std = 0.5 * (15.0_f64 / 6.0).hypot(22.0 / 6.0) / 1.33 * 1e-6;
    assert_eq!(found.name(), "truncated normal");
    let (mean, found_std, (lower, upper)) = (found.parent_mean(), found.given_std(), found.support());
    assert!((mean - 21.75e-6).abs() < 1e-15 && (found_std - std).abs() < 1e-15, "{found:?}");
    assert!((lower - (mean - 3.0 * std)).abs() < 1e-15 && (upper - (mean + 3.0 * std)).abs() < 1e-15);
    // 8 mm f7: -28 to -13 um.
    let journal = law(&source, "journal_undamped");
    assert!((journal.mean() - (4e-3 - 10.25e-6)).abs() < 1e-15, "{journal:?}");
    assert!((journal.std() - 1.25e-6).abs() < 1e-15, "{journal:?}");
}

#[test]
fn correlations_are_those_of_the_normals() {
    let source = SceneSource::parse(EVERYTHING, "everything").unwrap();
    let names: Vec<_> = source.variables().iter().map(|variable| variable.name.as_str()).collect();
    let found: Vec<_> = (source.nominal().correlations.iter())
        .map(|c| (names[c.first], names[c.second], c.coefficient))
        .collect();
    let rank = -2.0 * (std::f64::consts::PI * 0.3 / 6.0).sin();
    assert_eq!(found[0], ("brake", "friction_worn", 0.4));
    assert_eq!((found[1].0, found[1].1, found.len()), ("friction_worn", "friction_held", 2));
    assert!((found[1].2 - rank).abs() < 1e-15);
    // A sample keeps them.
    assert_eq!(source.resolve_sample(&source.means()).unwrap().correlations, source.nominal().correlations);
}

/// The faults of the four-bar with other keys in place of the row `std = "2 um"` of its clearance, or after it.
fn faults(keys: &str) -> Vec<String> {
    let text =
        FOUR_BAR.replacen("distribution = \"truncated-normal\"\nstd = \"2 um\"\n", &format!("{keys}\n"), 1);
    assert_ne!(text, FOUR_BAR);
    match SceneSource::parse(&text, "my.toml") {
        Ok(_) => Vec::new(),
        Err(faults) => faults.0.iter().map(ToString::to_string).collect(),
    }
}

#[track_caller]
fn one_fault(keys: &str, expected: &str) {
    let found = faults(keys);
    assert_eq!(found.len(), 1, "{found:#?}");
    assert!(found[0].contains(expected), "found    {}\nexpected {expected}", found[0]);
}

#[test]
fn keys_that_a_law_does_not_take_or_misses() {
    for [keys, expected] in crate::rows("keys_that_a_law_does_not_take_or_misses") {
        one_fault(keys, expected);
    }
}

#[test]
fn fits_that_cannot_be() {
    for [keys, expected] in crate::rows("fits_that_cannot_be") {
        one_fault(keys, expected);
    }
    let elsewhere = |changes: &str, fit: &str| {
        let text = FOUR_BAR.replacen("changes = [\"joints.crank.radial_clearance\"]", changes, 1).replacen(
            "distribution = \"truncated-normal\"\nstd = \"2 um\"\nunit = \"um\"\n",
            &format!("fit = \"{fit}\"\ndiameter = \"8 mm\"\n"),
            1,
        );
        SceneSource::parse(&text, "my.toml").unwrap_err().to_string()
    };
    let found = elsewhere("changes = [\"parameters.crank_mass\"]", "H7/e8");
    assert!(
        found.contains("there is no quantity") || found.contains("is a length, expected a mass"),
        "{found}"
    );
    let found = elsewhere("changes = [\"joints.crank.journal_radius\"]", "H7/e8");
    assert!(found.contains("gives a clearance; a radius needs the class of its part alone"), "{found}");
    let found = elsewhere("changes = [\"joints.crank.journal_radius\"]", "H7");
    assert!(found.contains("is the class of a hole, a journal is a shaft"), "{found}");
}

#[test]
fn correlations_that_cannot_be() {
    let faults = |rows: &str| {
        let text = format!("{FOUR_BAR}\n{rows}");
        match SceneSource::parse(&text, "my.toml") {
            Ok(_) => Vec::new(),
            Err(faults) => faults.0.iter().map(ToString::to_string).collect::<Vec<_>>(),
        }
    };
    let row =
        |a: &str, b: &str, rest: &str| format!("[[correlations]]\nvariables = [\"{a}\", \"{b}\"]\n{rest}\n");
    assert_eq!(faults(&row("friction", "load_torque", "coefficient = 0.5")), Vec::<String>::new());
    for (rows, expected) in [
        (
            row("friction", "load_torqe", "rank = 0.5"),
            "correlations[1].variables: there is no random variable \"load_torqe\", did you mean \"load_torque\"?",
        ),
        (
            row("friction", "friction", "rank = 0.5"),
            "correlations[1].variables: is not a pair of random variables",
        ),
        (
            row("friction", "load_torque", "rank = 1.0"),
            "correlations[1].rank: 1 is out of range, allowed: > -1 and < 1",
        ),
        (
            row("friction", "load_torque", ""),
            "correlations[1].coefficient: is missing, expected a number between -1 and 1",
        ),
        (
            row("friction", "load_torque", "rank = 0.1\ncoefficient = 0.1"),
            "give either coefficient or rank, not both",
        ),
        (row("friction", "load_torque", "rho = 0.1\ncoefficient = 0.1"), "correlations[1].rho: unknown key"),
        (row("friction", "load_torque", "rank = \"1 mm\""), "correlations[1].rank: \"1 mm\" is a length"),
        (
            row("friction", "load_torque", "rank = 0.1") + &row("load_torque", "friction", "rank = 0.1"),
            "correlations[2].variables: the correlation of \"load_torque\" and \"friction\" is given twice",
        ),
        (
            row("friction", "load_torque", "rank = 0.9")
                + &row("load_torque", "wear_coefficient", "rank = 0.9")
                + &row("friction", "wear_coefficient", "rank = -0.9"),
            "not positive definite",
        ),
    ] {
        let found = faults(&rows);
        assert_eq!(found.len(), 1, "{found:#?}");
        assert!(found[0].contains(expected), "found    {}\nexpected {expected}", found[0]);
    }
    let constant = FOUR_BAR.replacen(
        "distribution = \"truncated-normal\"\nstd = \"3 %\"",
        "distribution = \"constant\"",
        1,
    );
    let found = SceneSource::parse(
        &format!("{constant}\n{}", row("friction", "load_torque", "rank = 0.1")),
        "my.toml",
    );
    assert!(found.unwrap_err().to_string().contains("\"load_torque\" is constant and cannot be correlated"));
}
