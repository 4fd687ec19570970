//! `[units]`: what is shown in which unit, what is refused, and the parts of the schema and of the page about the language that follow from its
//! table.

use crate::language_tables::{compare, in_cell, with_definition, with_table};
use common::scene::{OutputUnit, SceneSource, Units};
use serde_json::{Map, Value, json};

const FOUR_BAR: &str = include_str!("../../scenes/four-bar.toml");

/// The four-bar with this limit of the wear and these units.
fn four_bar(limit: &str, units: &str) -> Result<SceneSource, String> {
    let text = FOUR_BAR.replacen("threshold = \"8 um\"", &format!("threshold = \"{limit}\""), 1);
    assert_ne!((limit == "8 um"), (text != FOUR_BAR));
    SceneSource::parse(&format!("{text}\n{units}"), "my.toml").map_err(|faults| faults.to_string())
}

#[test]
fn outputs_have_the_stated_unit_or_that_of_their_limit() {
    let shown = |limit: &str, units: &str| {
        let source = four_bar(limit, units).unwrap();
        let scene = source.nominal();
        let unit = scene.unit_of(&scene.outputs[scene.limit_states[0].output]);
        let shown = unit.after(&format!("{:.3}", unit.to_shown(scene.limit_states[0].threshold)));
        assert_eq!((unit.key("d"), unit.to_file(2e-6)), ("d_m".to_owned(), 2e-6));
        shown
    };
    assert_eq!(shown("8 um", ""), "8.000 µm");
    assert_eq!(shown("0.0004 in", ""), "0.000 in");
    assert_eq!(shown("0.008 mm", ""), "0.008 mm");
    assert_eq!(shown("4 um + 4 um", ""), "8.000 µm");
    assert_eq!(shown("8 um", "[units]\ndepth = \"mil\""), "0.315 mil");
    assert_eq!(shown("0.0004 in", "[units]\ndepth = \"mil\"\nlength = \"in\""), "0.400 mil");
}

#[test]
fn other_quantities_have_the_stated_unit() {
    let units = "[units]\nlength = \"in\"\ntorque = \"lbf in\"\nangular_velocity = \"deg/s\"";
    let source = four_bar("8 um", units).unwrap();
    let units = &source.nominal().units;
    assert_eq!(["mm", "um", "N m", "N"].map(|usual| units.symbol(usual)), ["in", "um", "lbf in", "N"]);
    assert_eq!(
        units.head("position [mm], torque [N m], depth [µm]"),
        "position [in], torque [lbf in], depth [µm]"
    );
    let torque = units.of(OutputUnit::Torque);
    assert!((torque.to_shown(1.0) - 1.0 / (0.0254 * 4.448_221_615_260_5)).abs() < 1e-12);
    assert_eq!((torque.axis("torque"), torque.suffix()), ("torque [lbf in]".to_owned(), "Nm"));
    assert!((units.of(OutputUnit::AngularVelocity).to_shown(1.0) - 1f64.to_degrees()).abs() < 1e-12);
    assert_eq!(units.of(OutputUnit::Force), OutputUnit::Force);
}

#[test]
fn issue_pairs_and_axes_of_explanations_did_not_have_the_stated_unit() {
    let said = |text: &str, units: &str| {
        let source = SceneSource::parse(&format!("{text}\n{units}"), "my.toml").unwrap();
        let scene = source.nominal();
        let loads = scene.loads.iter().map(|load| load.explanation(scene));
        loads
            .chain(scene.joints.iter().filter_map(|joint| joint.kind.coupling(&scene.units)))
            .collect::<Vec<_>>()
    };
    let (lift, cam) = (include_str!("../scenes/lift-table.toml"), include_str!("../scenes/geared-cam.toml"));
    assert_eq!(said(lift, "")[0], "payload: force (0, -2000) N on arm");
    assert_eq!(said(lift, "[units]\nforce = \"kN\"")[0], "payload: force (0 kN, -2 kN) on arm");
    assert!(said(cam, "")[2].ends_with("along 90.000 deg"), "{:?}", said(cam, ""));
    assert!(said(cam, "[units]\nangle = \"rad\"")[2].ends_with("along 1.5708 rad"));
}

#[test]
fn issue_random_variables_did_not_have_the_stated_unit() {
    let unit = |units: &str, name: &str| {
        let source = four_bar("8 um", units).unwrap();
        source.variables()[source.variable(name).unwrap()].unit.clone()
    };
    assert_eq!(unit("", "load_torque"), "N m");
    assert_eq!(unit("[units]\ntorque = \"lbf in\"", "load_torque"), "lbf in");
    assert_eq!(unit("[units]\nlength = \"in\"", "load_torque"), "N m");
    assert_eq!(unit("[units]\nlength = \"in\"", "friction"), "1");
}

#[test]
fn faulty_units_are_refused() {
    for (units, expected) in [
        ("length = \"inch\"", "units.length: "),
        ("length = \"N\"", "a length"),
        ("length = 25.4", "units.length: "),
        ("depths = \"mil\"", "did you mean \"depth\"?"),
    ] {
        let found = four_bar("8 um", &format!("[units]\n{units}")).unwrap_err();
        assert!(
            found.contains("my.toml:") && found.contains(expected),
            "found    {found}\nexpected {expected}"
        );
    }
}

#[test]
fn the_page_of_the_units_follows_from_its_table() {
    compare("scenes/README.md", |page| {
        let row = |(key, usual, _, about): &(&str, &str, _, &str)| {
            format!("| `{key}` | {} | `{usual}` |\n", in_cell(about))
        };
        let rows: String = Units::KEYS.iter().map(row).collect();
        with_table(&page, "units", &format!("| key | unit of | default |\n|---|---|---|\n{rows}"))
    });
}

#[test]
fn the_schema_of_the_units_follows_from_its_table() {
    let property = |(key, usual, _, about): &(&str, &str, _, &str)| {
        let about = about.trim_end_matches('.');
        (
            (*key).to_owned(),
            json!({ "description": format!("Unit of {}", about.to_lowercase()), "type": "string", "default": usual }),
        )
    };
    let properties: Map<String, Value> = Units::KEYS.iter().map(property).collect();
    let definition = json!({
        "description": "Units in which quantities are shown",
        "type": "object",
        "properties": properties,
        "additionalProperties": false,
    });
    compare("../coordinator/schemas/scene.schema.json", |text| {
        with_definition(&text, "shown_units", &definition)
    });
}
