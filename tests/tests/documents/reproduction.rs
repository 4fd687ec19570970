//! The tables that set published numbers beside ours say what the targets, the scene, the kept study and a simulation say now, and the
//! page of the validation says what they say.

use crate::markdown::{read, table_rows};
use common::accuracy::Accuracy;
use common::scene::{SceneSource, published_results};
use worker::simulate::{SimulateOptions, simulate};

/// Rows of a table of the folder, cells between commas; cells with commas are in quotes.
fn table(name: &str) -> Vec<Vec<String>> {
    let text = read(&format!("coordinator/doc/reproduction/{name}.csv"));
    let cells = |line: &str| {
        let quoted = line.split('"').enumerate();
        let marked =
            quoted.map(|(k, part)| if k % 2 == 0 { part.replace(',', "\n") } else { part.to_owned() });
        marked.collect::<String>().split('\n').map(str::to_owned).collect()
    };
    text.lines().skip(1).map(cells).collect()
}

/// Published numbers of the drive beside ours.
fn drive() -> Vec<Vec<String>> {
    table("drive")
}

/// The number a cell begins with.
fn number(cell: &str) -> Option<f64> {
    cell.split_whitespace().next()?.parse().ok()
}

/// The row of a quantity.
fn row_of<'a>(table: &'a [Vec<String>], what: &str) -> &'a Vec<String> {
    table.iter().find(|row| row[0] == what).unwrap_or_else(|| panic!("no row {what}"))
}

#[test]
fn every_target_of_the_calibration_is_in_the_table_as_fitted() {
    let drive = drive();
    let targets: toml::Table = toml::from_str(&read("common/scenes/flapping-wing.targets.toml")).unwrap();
    let targets = targets["targets"].as_array().unwrap();
    let reference: toml::Table = toml::from_str(&read("common/scenes/flapping-wing.reference.toml")).unwrap();
    let published = &reference["published"];
    assert!(targets.len() >= 14);
    for target in targets {
        let value = match &published[target["value"].as_str().unwrap()] {
            toml::Value::String(text) => number(text).unwrap(),
            other => other.as_float().unwrap(),
        };
        let met = |row: &&Vec<String>| number(&row[1]) == Some(value) && row[6] == "fitted";
        assert!(drive.iter().any(|row| met(&row)), "{value} is not there as fitted");
    }
}

#[test]
fn reliabilities_are_those_of_the_kept_study() {
    let drive = drive();
    let csv = read("coordinator/doc/reliability.csv");
    let columns: Vec<&str> = csv.lines().next().unwrap().split(',').collect();
    let rows = [
        ("wear", 63),
        ("wear", 64),
        ("wear", 66),
        ("wear", 68),
        ("wear", 70),
        ("asymmetry", 64),
        ("asymmetry", 66),
        ("asymmetry", 68),
    ];
    let results = published_results("flapping-wing").unwrap();
    for (limit, thousands) in rows {
        let cycles = 1000 * thousands;
        let published = results[&format!("{limit}_reliability_{cycles}")];
        let column = format!("R_{limit}");
        let column = columns.iter().position(|name| *name == column).unwrap();
        let line = csv.lines().find(|line| line.starts_with(&format!("{cycles},"))).unwrap();
        let kept: f64 = line.split(',').nth(column).unwrap().parse().unwrap();
        let row = row_of(&drive, &format!("R of {limit}, {thousands} 000 cycles"));
        assert_eq!(number(&row[1]), Some(published));
        let shown = number(&row[2]).unwrap();
        assert!((shown - kept).abs() < 1e-4, "{row:?}, {kept} in the study");
    }
}

/// Goals that are missed are named in `coordinator/doc/validation.md`; none is added unseen.
#[test]
fn no_goal_is_missed_but_those_that_are_known() {
    let drive = drive();
    let missed: Vec<&str> =
        drive.iter().filter(|row| row[5].ends_with("MISSED")).map(|row| row[0].as_str()).collect();
    assert_eq!(missed, KNOWN);
    let tables = [drive, table("experiment")].concat();
    assert!(tables.iter().filter(|row| row[5].ends_with("met")).count() >= 14);
}

/// The angle for which the limit of the angular velocities stands.
const ANGLE: &str = "difference of the angles of the wings where the angular velocities differ by 25 r/min";

/// A mean, and that angle.
const KNOWN: [&str; 2] = ["mean angular-velocity difference, 64 000 cycles", ANGLE];

/// Every number of the drive that the page shows beside a published one is that of the table.
#[test]
fn the_page_shows_the_numbers_of_the_table() {
    let page = read("coordinator/doc/validation.md");
    let drive = drive();
    let shown: Vec<Vec<&str>> = table_rows(&page)
        .into_iter()
        .filter(|row| row.len() == 5 && ["fitted", "free"].contains(&row[4]))
        .collect();
    assert!(shown.len() >= 18, "{shown:?}");
    for row in shown {
        let kept = row_of(&drive, row[0]);
        let same = (1..3).all(|k| number(row[k]) == number(&kept[k]));
        assert!(same && row[3] == kept[5] && row[4] == kept[6], "{row:?} on the page, {kept:?} in the table");
    }
}

/// What the last bits of the input move of the difference [r/min], three times their root mean square.
const NOISE: f64 = 0.33;

#[test]
fn the_nominal_drive_is_simulated_as_the_tables_say() {
    let (drive, choices, kinematics) = (drive(), table("choices"), table("kinematics"));
    let source = SceneSource::builtin("flapping-wing").unwrap();
    let scene = source.nominal();
    let evaluation = simulate(scene, &scene.accuracy.accuracy, SimulateOptions::WITH_FIRST_CYCLE).unwrap();
    let shown = |what: &str, column: usize| {
        let mut tables = [&drive, &choices, &kinematics].into_iter().flatten();
        let row = tables.find(|row| row[0] == what).unwrap_or_else(|| panic!("no row {what}"));
        number(&row[column]).unwrap()
    };
    let close = |shown: f64, now: f64, tolerance: f64| {
        assert!((shown - now).abs() <= tolerance, "{shown} in the table, {now} now");
    };
    let peak = |joints: &[usize]| {
        joints.iter().map(|joint| evaluation.joints[*joint].peak_force).fold(0.0, f64::max)
    };
    close(shown("peak force, joints 5 and 6", 2), peak(&[4, 5]), 0.011);
    close(shown("peak force, joints 1 to 4", 2), peak(&[0, 1, 2, 3]), 0.011);
    let right = &evaluation.first_cycle.as_ref().unwrap().bodies[0];
    assert_eq!(right.label, "right");
    let highest = right.angle.iter().copied().fold(f64::MIN, f64::max).to_degrees();
    close(shown("highest rocker angle, right", 2), highest, 0.011);
    let left = &evaluation.first_cycle.as_ref().unwrap().bodies[1];
    assert_eq!(left.label, "left");
    let apart = right.angle.iter().zip(&left.angle).map(|(right, left)| (right - left).abs());
    let apart = apart.fold(0.0, f64::max).to_degrees();
    close(shown("rotations in joints 5 and 6, largest difference", 2), apart, 0.011);
    let rpm = 30.0 / std::f64::consts::PI;
    // Closed form of the links without mass: clearance alone.
    close(shown("difference, unworn", 2), rpm * evaluation.start[1].unwrap(), 0.05);
    let lives = [64_000, 66_000, 68_000];
    for (k, life) in lives.into_iter().enumerate() {
        let n = evaluation.cycles.iter().position(|cycles| *cycles == life).unwrap();
        close(shown("as it stands", 1 + k), 1e3 * evaluation.histories[0][n], 2e-5);
        close(shown("as it stands", 4 + k), rpm * evaluation.histories[1][n], NOISE);
    }
}

/// The bore of the drive in the wind tunnel has the two published depths, opposite each other, and the table says so.
#[test]
fn the_bore_of_the_experiment_is_simulated_as_the_table_says() {
    let experiment = table("experiment");
    let mut scene = SceneSource::builtin("flapping-wing-experiment").unwrap().nominal().clone();
    scene.life.cycles = 72_000;
    let evaluation = simulate(&scene, &Accuracy::draft(), SimulateOptions::default()).unwrap();
    let published = published_results("flapping-wing").unwrap();
    let bore = &evaluation.joints[0].wear_depth;
    let [first, second] = [0..9, 9..27].map(|points| points.map(|k| bore[k]).fold(0.0, f64::max));
    for (what, found) in [("first", first), ("second", second)] {
        let wanted = published[&format!("specimen_{what}_peak")];
        assert!((found - wanted).abs() < 0.03 * wanted, "{what}: {found} m, published {wanted} m");
        let row = row_of(&experiment, &format!("depth of the {what} place"));
        assert!((number(&row[2]).unwrap() - 1e3 * found).abs() < 2e-4, "{row:?}, {found} m now");
    }
    let deepest = |range: std::ops::Range<usize>| range.max_by(|a, b| bore[*a].total_cmp(&bore[*b])).unwrap();
    assert_eq!((deepest(0..36) % 36, deepest(9..27)), (0, 18));
}
