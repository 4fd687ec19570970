//! The levels of accuracy of a scene: what is read, and what is refused.

use crate::simulator::beam;
use common::scene::SceneSource;

const FOUR_BAR: &str = include_str!("../../scenes/four-bar.toml");

fn four_bar(study: &str) -> Result<SceneSource, String> {
    let text = FOUR_BAR.replacen("[study]", &format!("[study]\n{study}"), 1);
    SceneSource::parse(&text, "my.toml").map_err(|faults| {
        assert!(faults.0.iter().all(|fault| fault.location.is_some()), "without a place: {faults}");
        faults.to_string()
    })
}

#[test]
fn the_first_level_is_the_accuracy() {
    let source = four_bar("levels = [\"draft\", \"balanced\", \"reference+points-x2\"]").unwrap();
    let scene = source.nominal();
    let names: Vec<&str> = scene.levels.iter().map(|level| level.name.as_str()).collect();
    assert_eq!(
        (scene.accuracy.name.as_str(), names),
        ("draft", vec!["draft", "balanced", "reference+points-x2"])
    );
    assert_eq!((scene.levels[1].accuracy.points, scene.levels[2].accuracy.points), (1, 2));
    // An accuracy beside them is that of single evaluations.
    let both = four_bar("accuracy = \"reference\"\nlevels = [\"draft\", \"balanced\"]").unwrap();
    let (single, levels) = (&both.nominal().accuracy, &both.nominal().levels);
    assert_eq!((single.name.as_str(), levels[0].name.as_str()), ("reference", "draft"));
    assert!(four_bar("").unwrap().nominal().levels.is_empty());
}

#[test]
fn levels_out_of_order_are_refused() {
    for [study, expected] in crate::rows("levels_out_of_order_are_refused") {
        let found = four_bar(study).expect_err(study);
        assert!(found.contains(expected), "{study}: {found}");
    }
}

#[test]
fn cost_and_exactness_belong_to_levels() {
    let read = |keys: &str| SceneSource::parse(&beam("timeout = \"2 min\"", keys), "beam.toml");
    let cost = |keys: &str| read(keys).unwrap().nominal().simulator.as_ref().unwrap().level_cost;
    let levels = "levels = [\"coarse\", \"fine\"]";
    assert_eq!((cost(levels), cost(&format!("{levels}\nlevel_cost = 30"))), (4.0, 30.0));
    let low = format!("{levels}\nlevel_cost = 0.5");
    let alone = "finest_is_exact = true";
    assert!(
        read(&format!("{levels}\n{alone}")).unwrap().nominal().simulator.as_ref().unwrap().finest_is_exact
    );
    for (keys, said) in [
        ("level_cost = 8", "simulator.level_cost: belongs to levels"),
        (&low, "1 to 1000"),
        (alone, "simulator.finest_is_exact: belongs to levels"),
    ] {
        let found = read(keys).unwrap_err().to_string();
        assert!(found.contains(said), "{keys}: {found}");
    }
}
