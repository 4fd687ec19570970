use super::super::problem_costs::grade_width;
use super::*;
use common::scene::{Fault, SceneSource};

const SCENE: &str = r#"
    scene = { name = "stack" }
    simulator = { program = ["closure"] }
    life = { cycles = 300, checkpoint_every = 100 }
    outputs = [{ name = "gap", unit = "um" }]
    limit_states = [{ name = "touch", output = "gap", threshold = 0, fails = "below" }]
    variables = [
        { name = "a", mean = "10 mm", std = "5 um", unit = "mm", distribution = "normal" },
        { name = "b", mean = "10 mm", std = "5 um", unit = "mm", distribution = "normal" },
        { name = "c", mean = "2 mm", std = "5 um", unit = "mm", distribution = "lognormal" },
        { name = "n", mean = 3, std = 0.1, distribution = "normal" },
        { name = "r", mean = 4, std = "5 %", distribution = "normal" },
    ]
"#;

fn read(text: &str) -> Result<DesignProblem, Vec<String>> {
    let source = SceneSource::parse(SCENE, "stack").unwrap();
    let line = |fault: &Fault| {
        let line = fault.location.as_ref().expect("every fault has its line").line;
        format!("{line}: {}: {}", fault.key, fault.kind)
    };
    let read = InputFile::parse(text, "p.toml").and_then(|file| super::read(&file, &source, None));
    read.map_err(|Faults(faults)| faults.iter().map(line).collect())
}

#[test]
fn quantities_are_read_in_their_units() {
    let problem = read(
        r#"
        quantities = [
            { change = ["a.tolerance", "b.tolerance"], grades = ["IT8", "IT6", "IT12"], diameter = "10 mm", capability = 1.33,
              cost = { model = "table", points = [["IT6", 9], ["IT8", 4], ["IT12", 1]], unit = "um" } },
            { change = "c.std", lower = "0.1 %", upper = "10 um", cost = { model = "reciprocal-power", c1 = 2, k = 1, unit = "um" } },
            { change = "n.mean", lower = 2, upper = 4, cost = { model = "linear", c1 = 1 } },
        ]
        targets = [{ reliability = "99 %" }, { limit_state = "touch", cycles = 200, reliability = 0.999 }]
        "#,
    )
    .unwrap();
    let [zones, spread, mean] = &problem.quantities[..] else { panic!() };
    // 10 mm lies in the range 6 to 10 mm: 9, 22 and 150 um.
    let widths: Vec<f64> = zones.grades.iter().map(|grade| (grade.width * 1e7).round() / 10.0).collect();
    assert_eq!((zones.variables.as_slice(), widths.as_slice()), (&[0, 1][..], &[9.0, 22.0, 150.0][..]));
    assert!((zones.cost_at(22e-6).0 - 4.0).abs() < 1e-9);
    assert!((spread.lower - 2e-6).abs() < 1e-15 && (spread.cost_at(4e-6).0 - 0.5).abs() < 1e-12);
    assert!((spread.cost_at(4e-6).1 + 0.125e6).abs() < 1e-3);
    assert_eq!((mean.lower, mean.upper, mean.cost_at(3.0)), (2.0, 4.0, (3.0, 1.0)));
    assert_eq!(problem.targets[0].name, "R total at 300");
    assert_eq!((problem.targets[1].limit_state, problem.targets[1].checkpoint), (Some(0), 1));
    // Six standard deviations of the capability fill the zone.
    let inputs = InputModel::from_scene(SceneSource::parse(SCENE, "stack").unwrap().nominal());
    let changed = problem.variables(&inputs, &[7.98e-6, 3e-6, 3.5]).unwrap();
    assert!((changed[1].std() - 1e-6).abs() < 1e-12 && (changed[2].std() - 3e-6).abs() < 1e-12);
    assert_eq!(changed[3].mean(), 3.5);
}

#[test]
fn issue_a_standard_deviation_in_per_cent_follows_a_changed_mean() {
    let quantity = |change: &str, [lower, upper]: [f64; 2]| {
        format!(
            "{{ change = \"{change}\", lower = {lower}, upper = {upper}, cost = {{ model = \"linear\", c1 = 1 }} }}"
        )
    };
    let [mean, spread] = [quantity("r.mean", [2.0, 8.0]), quantity("r.std", [0.1, 0.5])];
    let inputs = InputModel::from_scene(SceneSource::parse(SCENE, "stack").unwrap().nominal());
    for (quantities, values, std) in
        [(vec![&mean], vec![6.0], 0.3), (vec![&spread, &mean], vec![0.4, 6.0], 0.4)]
    {
        let rows = quantities.into_iter().map(String::as_str).collect::<Vec<_>>().join(", ");
        let problem = read(&format!("quantities = [{rows}]\ntargets = [{{ reliability = 0.99 }}]")).unwrap();
        let law = &problem.variables(&inputs, &values).unwrap()[4];
        assert!((law.mean() - 6.0).abs() + (law.std() - std).abs() < 1e-12, "{law:?}");
    }
}

#[test]
fn grades_follow_the_standard_tolerance_unit() {
    // IT6, ..., IT12 are 10, 16, 25, 40, 64, 100 and 160 units i = 0.45 D^(1/3) + 0.001 D [um], D the geometric mean of
    // the range [mm]; the tables are rounded.
    for (size, from, to) in [(15.0, 10.0, 18.0), (40.0, 30.0, 50.0), (100.0, 80.0, 120.0)] {
        let mean = f64::sqrt(from * to);
        let unit = 0.45 * mean.cbrt() + 0.001 * mean;
        for (grade, units) in
            [(6, 10.0), (7, 16.0), (8, 25.0), (9, 40.0), (10, 64.0), (11, 100.0), (12, 160.0)]
        {
            let width = grade_width(&format!("IT{grade}"), size * 1e-3).unwrap() * 1e6;
            assert!(
                (width / (units * unit) - 1.0).abs() < 0.06,
                "IT{grade} at {size}: {width} {}",
                units * unit
            );
        }
    }
    assert!(grade_width("IT4", 0.01).is_err() && grade_width("IT7", 0.6).is_err());
}

#[test]
fn all_faults_are_reported_at_once() {
    let faults = read(
        r#"
        quantities = [
            { change = "d.std", lower = 1, upper = 2, cost = { model = "linear", c1 = 1 } },
            { change = "a.std", lower = "9 um", upper = "3 um", cost = { model = "cubic" } },
            { change = "b.std", lower = "-1 um", upper = 3, cost = { model = "exponential", c1 = 1 } },
            { change = "c.median", lower = 1, upper = 2, cost = { model = "linear", c1 = 1 } },
            { change = "n.tolerance", grades = ["IT7", "IT8"], diameter = "9 mm", cost = { model = "linear", c1 = 1 } },
        ]
        targets = [{ reliability = 1.5 }, { limit_state = "wear", cycles = 400, reliability = 0.9 }]
        "#,
    )
    .unwrap_err();
    let expected = [
        "3: quantities[1].change: there is no random variable \"d\"; there are: a, b, c, n, r",
        "4: quantities[2].lower: 0.009 mm is out of range, allowed: below upper, 0.003 mm",
        "4: quantities[2].cost.model: \"cubic\" is unknown; allowed: reciprocal-power, exponential, linear, table",
        "5: quantities[3].upper: 3 has no unit, expected a length (mm, um, m, ...)",
        "5: quantities[3].cost.k: is missing, expected a plain number",
        "6: quantities[4].change: \"median\" is unknown, did you mean \"mean\"?; allowed: mean, std, tolerance",
        "7: quantities[5].grades: grades are for the tolerance of a length, e.g. \"rod_length.tolerance\"",
        "9: targets[1].reliability: 1.5 is out of range, allowed: > 0 and < 1",
        "9: targets[2].limit_state: there is no limit state \"wear\"; there are: touch, total",
        "9: targets[2].cycles: 400 is out of range, allowed: a checkpoint of the life: 100 to 300 by 100",
    ];
    assert_eq!(faults, expected);
}

#[test]
fn issue_a_fault_of_a_row_hides_no_other_and_names_what_was_meant() {
    let faults = read(
        r#"
        [[quantities]]
        change = "a.sdt"
        capability = 2
        lower = "1 um"
        upper = "2 um"
        cost = { model = "reciprocal-powr", c1 = 1 }
        [[quantities]]
        change = "stp.std"
        lower = "4 N"
        [quantities.cost]
        model = "linear"
        c1 = "1 mm"
        c2 = 3
        [[targets]]
        limit_state = "tuoch"
        cycles = 301
        reliability = 1.99
        "#,
    )
    .unwrap_err();
    let said = |line: usize, parts: &[&str]| {
        let line = format!("{line}: ");
        let found = faults.iter().any(|f| f.starts_with(&line) && parts.iter().all(|part| f.contains(part)));
        assert!(found, "{line}{parts:?} {faults:#?}");
    };
    said(3, &["did you mean \"std\"?"]);
    said(7, &["did you mean \"reciprocal-power\"?"]);
    said(9, &["there is no random variable \"stp\""]);
    said(13, &["c1", "a length, expected a plain number"]);
    said(14, &["unknown key"]);
    said(16, &["did you mean \"touch\"?"]);
    said(17, &["301", "100 to 300 by 100"]);
    said(18, &["1.99"]);
}

#[test]
fn bounds_at_which_no_distribution_exists_are_refused() {
    let with = |row: &str| {
        read(&format!("quantities = [{row}]\ntargets = [{{ reliability = 0.9 }}]")).unwrap_err().join("\n")
    };
    let spread = with(
        "{ change = \"b.std\", lower = \"0 um\", upper = \"3 um\", cost = { model = \"linear\", c1 = 1 } }",
    );
    assert_eq!(spread, "1: quantities[1].lower: 0 mm is out of range, allowed: > 0: it is a spread");
    let mean = with(
        "{ change = \"c.mean\", lower = \"-1 mm\", upper = \"3 mm\", cost = { model = \"linear\", c1 = 1 } }",
    );
    assert!(mean.starts_with("1: quantities[1].lower: -1 mm: mean = -0.001 is out of range"), "{mean}");
}

#[test]
fn a_confidence_is_a_share_from_a_half_on() {
    let with = |confidence: &str| {
        let quantity = "{ change = \"n.mean\", lower = 2, upper = 4, cost = { model = \"linear\", c1 = 1 } }";
        read(&format!("quantities = [{quantity}]\ntargets = [{{ reliability = 0.9{confidence} }}]"))
    };
    assert_eq!(with("").unwrap().targets[0].confidence, None);
    for (given, confidence) in [("0.95", 0.95), ("\"90%\"", 0.9), ("\"90 %\"", 0.9)] {
        let problem = with(&format!(", confidence = {given}")).unwrap();
        assert_eq!(problem.targets[0].confidence, Some(confidence));
    }
    for (given, said) in [
        ("0", "0 is out of range, allowed: 0.5 to 0.999"),
        ("\"100 %\"", "\"100 %\" is out of range, allowed: 0.5 to 0.999"),
        ("\"high\"", "high"),
    ] {
        let faults = with(&format!(", confidence = {given}")).unwrap_err();
        assert!(faults.len() == 1 && faults[0].starts_with("2: targets[1].confidence: "), "{faults:?}");
        assert!(faults[0].contains(said), "{faults:?}");
    }
}
