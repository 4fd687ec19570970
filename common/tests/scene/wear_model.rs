//! The choices of the wear model: what is read, what is refused, and the built-in scene that has them all.

use common::scene::{BlockStep, BoreSpline, JointKind, SceneSource, WearDistribution, WearModel};

const FOUR_BAR: &str = include_str!("../../scenes/four-bar.toml");

fn four_bar(from: &str, to: &str, wear: &str) -> Result<SceneSource, String> {
    assert!(FOUR_BAR.contains(from), "the scene has no {from}");
    let text = FOUR_BAR.replace(from, to).replacen("[life]", &format!("{wear}\n[life]"), 1);
    SceneSource::parse(&text, "my.toml").map_err(|faults| {
        assert!(faults.0.iter().all(|fault| fault.location.is_some()), "without a place: {faults}");
        faults.to_string()
    })
}

#[test]
fn every_choice_has_its_words_and_a_default() {
    let read = |wear: &str| four_bar("[life]", "[life]", wear).unwrap().nominal().wear;
    assert_eq!(read(""), WearModel::default());
    assert_eq!(read("[wear]"), WearModel::default());
    assert_eq!(
        read("[wear]\nspline = \"interpolating\"\ndistribution = \"hat-shares\""),
        WearModel::default()
    );
    assert_eq!(WearModel::default().chosen(), [""; 0]);
    assert_eq!(read("[wear]\nexplicit_step = 500").explicit_step, BlockStep::Explicit(500));
    assert_eq!(read("[wear]\nspline = \"approximating\"").spline, BoreSpline::Approximating);
    let keys: Vec<&str> = WearModel::KEYS.iter().map(|key| key.name).collect();
    assert_eq!(keys, ["explicit_step", "distribution", "spline"]);
}

#[test]
fn faulty_choices_are_refused() {
    let fault = |wear: &str| four_bar("[life]", "[life]", wear).unwrap_err();
    for (wear, expected) in [
        ("[wear]\nexplicit_step = 0", "wear.explicit_step: 0 is out of range"),
        ("[wear]\nexplicit_step = \"1000 cycles\"", "wear.explicit_step"),
        ("[wear]\ndistribution = \"points\"", "wear.distribution"),
        ("[wear]\ndistribution = \"points-inside\"", "wear.distribution: needs explicit_step"),
        ("[wear]\nspline = \"b-spline\"", "wear.spline: "),
        ("[wear]\nsplines = \"approximating\"", "wear.splines"),
    ] {
        let found = fault(wear);
        assert_eq!(found.lines().count(), 1, "{found}");
        assert!(found.contains(expected), "found    {found}\nexpected {expected}");
    }
    let law = ("contact_law = \"local-hertz\"", "contact_law = \"foundation\"");
    let inside = "[wear]\nexplicit_step = 1000\ndistribution = \"points-inside\"";
    let found = four_bar(law.0, law.1, inside).unwrap_err();
    assert!(
        found.contains(
            "wear.distribution: needs contact_law = \"local-hertz\", which joint crank does not have"
        ),
        "{found}"
    );
    let journal = (
        "wear_coefficient = \"wear_coefficient\"",
        "wears = \"journal\"\nwear_coefficient = \"wear_coefficient\"",
    );
    let found = four_bar(journal.0, journal.1, "[wear]\nspline = \"approximating\"").unwrap_err();
    assert!(found.contains("wear.spline: is for bores alone, but the journal of joint"), "{found}");
}

#[test]
fn an_external_simulator_has_no_wear_model() {
    let text = "scene = { name = \"beam\" }\nsimulator = { program = [\"python3\", \"beam.py\"], timeout = \"2 min\" }\n\
                wear = { explicit_step = 1 }\n[[outputs]]\nname = \"deflection\"\nunit = \"mm\"\nvalues = 1\n";
    let found = SceneSource::parse(text, "beam.toml").unwrap_err().to_string();
    assert!(found.contains("wear"), "{found}");
}

/// The drive as published is that of the simulations but for the wear.
#[test]
fn the_drive_as_published_has_all_published_choices() {
    let drive = SceneSource::builtin("flapping-wing").unwrap().nominal().clone();
    let mut published = SceneSource::builtin("flapping-wing-as-published").unwrap().nominal().clone();
    assert_eq!(drive.wear, WearModel::default());
    let expected = WearModel {
        explicit_step: BlockStep::Explicit(1000),
        distribution: WearDistribution::PointsInside,
        spline: BoreSpline::Approximating,
    };
    assert_eq!(published.wear, expected);
    assert_eq!(expected.chosen().len(), 3);
    assert!(published.joints.iter().all(|joint| matches!(&joint.kind, JointKind::Clearance(_))));
    published.wear = drive.wear;
    (published.name, published.title) = (drive.name.clone(), drive.title.clone());
    assert_eq!(published, drive);
}
