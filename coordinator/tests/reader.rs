//! The reader's test: from the tables of a report alone a stranger writes the scene again, and it is the same scene.

use common::scene::SceneSource;
use ring::digest::{SHA256, digest};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::process::Command;

/// A table of the page: its rows as cells by the names of their columns.
type Rows = Vec<BTreeMap<String, String>>;

/// Text of the page without elements, with the signs of the scene language.
fn plain(markup: &str) -> String {
    let mut text = String::new();
    let mut inside = false;
    for letter in markup.chars() {
        match letter {
            '<' => inside = true,
            '>' => inside = false,
            other if !inside => text.push(other),
            _ => {}
        }
    }
    let text = text.replace("&lt;", "<").replace("&gt;", ">").replace("&quot;", "\"").replace("&amp;", "&");
    text.replace('\u{2212}', "-").replace('\u{a0}', " ").replace('²', "^2").trim().to_owned()
}

/// The piece between two texts.
fn between<'t>(text: &'t str, from: &str, to: &str) -> &'t str {
    let rest = text.split_once(from).unwrap_or_else(|| panic!("{from}")).1;
    rest.split_once(to).unwrap_or_else(|| panic!("{to}")).0
}

/// A table by its name; no rows if the page has none of this name.
fn table(page: &str, name: &str) -> Rows {
    let Some((_, rest)) = page.split_once(&format!("id=\"table-{name}\"")) else { return vec![] };
    let table = between(rest, "<table", "</table>");
    let cells = |row: &str, element: &str| -> Vec<String> {
        row.split(&format!("<{element}"))
            .skip(1)
            .map(|cell| {
                plain(cell.split_once('>').unwrap().1.split(&format!("</{element}>")).next().unwrap())
            })
            .collect()
    };
    let head = cells(between(table, "<thead>", "</thead>"), "th");
    let body = between(table, "<tbody>", "</tbody>");
    body.split("<tr>").skip(1).map(|row| head.iter().cloned().zip(cells(row, "td")).collect()).collect()
}

/// A quantity as a TOML text.
fn quoted(text: &str) -> String {
    format!("\"{text}\"")
}

/// `(1, 2)` in a unit as a TOML pair; an entry with a unit of its own keeps it.
fn pair(text: &str, unit: &str) -> String {
    let entries = text.trim_start_matches('(').trim_end_matches(')').split(", ");
    let entries = entries.map(|entry| {
        let bare = entry.parse::<f64>().is_ok();
        quoted(&if bare { format!("{entry} {unit}") } else { entry.to_owned() })
    });
    format!("[{}]", entries.collect::<Vec<_>>().join(", "))
}

/// `body.point (x, y)` as a TOML place.
fn place(text: &str) -> String {
    let name = text.split(" (").next().unwrap();
    let (body, point) = name.split_once('.').unwrap();
    format!("{{ body = \"{body}\", point = \"{point}\" }}")
}

/// The scene as the tables state it, with numbers where formulas stand.
fn rebuilt(page: &str) -> toml::Table {
    let mut text = String::new();
    let facts = table(page, "facts");
    let fact = |item: &str| facts.iter().find(|row| row["item"] == item).unwrap()["value"].clone();
    let name = fact("scene").split(',').next().unwrap().to_owned();
    let title = plain(between(page, "<h1>", "</h1>"));
    writeln!(text, "[scene]\nname = \"{name}\"\ntitle = \"{title}\"").unwrap();
    for row in table(page, "parameters") {
        let value = &row["value"];
        let value = if value.parse::<f64>().is_ok() { value.clone() } else { quoted(value) };
        writeln!(text, "[[p]]\nname = \"{}\"\nvalue = {value}", row["parameter"]).unwrap();
    }
    for row in table(page, "materials") {
        writeln!(
            text,
            "[materials.{}]\nelastic_modulus = \"{}\"\npoisson_ratio = {}",
            row["material"], row["elastic modulus"], row["Poisson's ratio"]
        )
        .unwrap();
    }
    let starts = table(page, "starts");
    for row in table(page, "bodies") {
        let body = &row["body"];
        writeln!(text, "[[bodies]]\nname = \"{body}\"").unwrap();
        if row["motion"] == "fixed" {
            text += "motion = \"fixed\"\n";
        } else if let Some(how) = row["motion"].strip_prefix("driven about ") {
            let (at, how) = how.split_once("), ").unwrap();
            let (speed, start) = how.split_once(", from ").unwrap();
            let at = pair(&format!("{at})"), "mm");
            writeln!(
                text,
                "motion = \"driven\"\nposition = {at}\nspeed = \"{speed}\"\nstart_angle = \"{start}\""
            )
            .unwrap();
        } else {
            let start = starts.iter().find(|start| start["body"] == *body).unwrap();
            writeln!(
                text,
                "motion = \"free\"\nmass = \"{}\"\ninertia = \"{}\"\ncentre_of_mass = {}\nstart_position = {}\n\
                 start_angle = \"{}\"",
                row["mass"],
                row["inertia"],
                pair(&row["centre of mass [mm]"], "mm"),
                pair(&start["position [mm]"], "mm"),
                start["angle"]
            )
            .unwrap();
            let (velocity, speed) = (&start["velocity [m/s]"], &start["angular velocity"]);
            if velocity != "–" {
                write!(text, "\nstart_velocity = {}", pair(velocity, "m/s")).unwrap();
            }
            if speed != "–" {
                write!(text, "\nstart_speed = \"{speed}\"").unwrap();
            }
            text.push('\n');
        }
        text += "[bodies.points]\n";
        for point in row["points [mm]"].split("; ").filter(|point| !point.is_empty()) {
            let (name, at) = point.split_once(' ').unwrap();
            writeln!(text, "{name} = {}", pair(at, "mm")).unwrap();
        }
    }
    let (hinges, materials) = (table(page, "hinges"), table(page, "materials"));
    for row in table(page, "joints") {
        let joint = &row["joint"];
        assert_eq!(row["kind"], "hinge with clearance", "this scene has no ideal joint");
        let hinge = hinges.iter().find(|hinge| hinge["hinge"] == *joint).unwrap();
        let made_of = |part: &str| {
            let of = materials.iter().find(|row| row[part].split(", ").any(|name| name == joint));
            of.unwrap()["material"].clone()
        };
        let follows = |cell: &str| cell.starts_with('(');
        let radius = if follows(&hinge["bushing radius"]) {
            format!("radial_clearance = \"{}\"", hinge["radial clearance"])
        } else {
            format!("bushing_radius = \"{}\"", hinge["bushing radius"])
        };
        let (law, damping) = hinge["law and damping of the contact"].split_once("; ").unwrap();
        let damping = damping.strip_prefix("hunt-crossley, ").expect("this scene has this damping");
        writeln!(
            text,
            "[[joints]]\nname = \"{joint}\"\ntype = \"clearance\"\njournal = {}\nbushing = {}\njournal_radius = \"{}\"\n{radius}\n\
             width = \"{}\"\njournal_material = \"{}\"\nbushing_material = \"{}\"\ncontact_law = \"{law}\"\n\
             contact_damping = {{ hunt_crossley = \"{damping}\" }}\nfilm_damping = \"{}\"\nfriction = {}\nfriction_speed = \"{}\"\n\
             wear_coefficient = \"{}\"\ncontrol_points = {}",
            place(&row["journal, or first body [mm]"]),
            place(&row["bushing, or second body [mm]"]),
            hinge["journal radius"],
            hinge["width"],
            made_of("journals of"),
            made_of("bushings of"),
            hinge["film damping"],
            hinge["friction"],
            hinge["friction speed"],
            hinge["wear coefficient"],
            hinge["control points"]
        )
        .unwrap();
    }
    for row in table(page, "loads") {
        let (name, on, values) = (&row["load"], &row["acts on [mm]"], &row["values"]);
        writeln!(text, "[[loads]]\nname = \"{name}\"\ntype = \"{}\"", row["type"]).unwrap();
        if row["type"] == "directional-spring" {
            let (at, anchor) = on.split_once(", anchor ").unwrap();
            let along = between(values, "along ", ", stiffness").trim_matches(['(', ')']);
            let stiffness = between(values, "stiffness ", ", free length ");
            let free = values.rsplit_once("free length ").unwrap().1;
            writeln!(
                text,
                "at = {}\nanchor = {}\ndirection = [{along}]\nstiffness = \"{stiffness}\"\nfree_length = \"{free}\"",
                place(at),
                place(anchor)
            )
            .unwrap();
        } else {
            assert_eq!(row["type"], "constant-torque");
            let torque = values.strip_prefix("torque ").unwrap();
            writeln!(text, "body = \"{on}\"\ntorque = \"{torque}\"").unwrap();
        }
    }
    outputs_and_study(page, &mut text);
    let mut scene: toml::Table = text.parse().unwrap_or_else(|error| panic!("{error}\n{text}"));
    // Parameters keep the order of the table by their names.
    let rows = scene.remove("p").map_or(vec![], |rows| rows.as_array().unwrap().clone());
    let parameters = rows.iter().map(|row| (row["name"].as_str().unwrap().to_owned(), row["value"].clone()));
    scene.insert("parameters".into(), toml::Value::Table(parameters.collect()));
    for row in table(page, "formulas") {
        set(&mut scene, &row["quantity"], &row["formula"]);
    }
    scene
}

/// Outputs, limit states, life, variables and settings.
fn outputs_and_study(page: &str, text: &mut String) {
    for row in table(page, "outputs") {
        let (name, of) = (&row["output"], &row["of"]);
        let body = |signed: &str| {
            let (sign, rest) = signed.split_at(1);
            let (body, label) = rest.split_once(" (").unwrap();
            let sign = if sign == "-" { -1 } else { 1 };
            format!("{{ body = \"{body}\", sign = {sign}, label = \"{}\" }}", label.trim_end_matches(')'))
        };
        if row["quantity"].starts_with("largest wear depth") {
            let joints: Vec<String> = of.split(", ").map(quoted).collect();
            writeln!(
                text,
                "[[outputs]]\nname = \"{name}\"\ntype = \"largest-wear\"\njoints = [{}]",
                joints.join(", ")
            )
            .unwrap();
        } else {
            assert!(row["quantity"].starts_with("largest difference of angular velocity"), "{row:?}");
            let (a, b) = of.split_once("; ").unwrap();
            let (a, b) = (body(a), body(b));
            writeln!(
                text,
                "[[outputs]]\nname = \"{name}\"\ntype = \"angular-velocity-difference\"\na = {a}\nb = {b}"
            )
            .unwrap();
        }
    }
    for row in table(page, "limits") {
        let threshold = row["failed where the output is"].trim_start_matches("≥ ");
        writeln!(
            text,
            "[[limit_states]]\nname = \"{}\"\noutput = \"{}\"\nthreshold = \"{threshold}\"",
            row["limit state"], row["output"]
        )
        .unwrap();
    }
    let life = plain(between(page, "Life studied: ", "</p>")).trim_end_matches('.').to_owned();
    let cycles = life.split(" cycles").next().unwrap().replace(' ', "");
    let every = between(&life, "a checkpoint every ", " cycles").replace(' ', "");
    let settling = life.rsplit_once(": ").unwrap().1;
    let period = between(&life, " cycles of ", ", with");
    writeln!(text, "[life]\ncycles = {cycles}\ncheckpoint_every = {every}\nsettle_cycles = {settling}")
        .unwrap();
    // Without a period of its own a cycle is one of the drive.
    if !period.ends_with(", the period of the drive") {
        writeln!(text, "period = \"{period}\"").unwrap();
    }
    text.push_str("[study]\n");
    for row in table(page, "settings") {
        let value = if row["setting"] == "accuracy" { quoted(&row["value"]) } else { row["value"].clone() };
        writeln!(text, "{} = {value}", row["setting"]).unwrap();
    }
    for row in table(page, "variables") {
        let unit = if row["unit"] == "1" { String::new() } else { format!(" {}", row["unit"]) };
        let value = |cell: &str| {
            let text = if cell.parse::<f64>().is_ok() { format!("{cell}{unit}") } else { cell.to_owned() };
            if text.parse::<f64>().is_ok() { text } else { quoted(&text) }
        };
        let changes: Vec<String> = row["sets"].split(", ").map(quoted).collect();
        writeln!(
            text,
            "[[variables]]\nname = \"{}\"\nchanges = [{}]\ndistribution = \"{}\"\nmean = {}\nstd = {}",
            row["variable"],
            changes.join(", "),
            row["distribution"],
            value(&row["mean"]),
            value(&row["std"])
        )
        .unwrap();
        // "1" denotes a plain number.
        if row["unit"] != "1" {
            writeln!(text, "unit = \"{}\"", row["unit"]).unwrap();
        }
        let reach = row["upper bound"].strip_prefix("mean + ").and_then(|rest| rest.strip_suffix(" std"));
        match reach {
            Some(reach) => writeln!(text, "truncation = {reach}").unwrap(),
            None => {
                let (lower, upper) = (value(&row["lower bound"]), value(&row["upper bound"]));
                writeln!(text, "lower = {lower}\nupper = {upper}").unwrap();
            }
        }
    }
    assert!(table(page, "correlations").is_empty());
}

/// Sets the value at the path of a key: rows of lists by their names, entries of pairs by x and y.
fn set(scene: &mut toml::Table, path: &str, formula: &str) {
    let mut parts = path.split('.').peekable();
    let first = parts.next().unwrap();
    let mut at = &mut scene[first];
    for part in parts {
        at = match at {
            toml::Value::Array(rows) => {
                let named = |row: &toml::Value| row.get("name").and_then(toml::Value::as_str) == Some(part);
                let place = rows.iter().position(named).or(["x", "y"].iter().position(|axis| *axis == part));
                &mut rows[place.unwrap_or_else(|| panic!("{path}"))]
            }
            other => other.as_table_mut().unwrap().entry(part).or_insert(toml::Value::Integer(0)),
        };
    }
    *at = toml::Value::String(formula.to_owned());
}

/// Hash of everything that a scene resolves to.
fn hash(scene: &common::scene::Scene) -> String {
    let text = serde_json::to_string(scene).unwrap();
    digest(&SHA256, text.as_bytes()).as_ref().iter().map(|byte| format!("{byte:02x}")).collect()
}

#[test]
fn the_tables_of_a_four_bar_give_the_same_scene() {
    is_rebuilt("four-bar");
}

#[test]
fn the_tables_of_the_drive_give_the_same_scene() {
    is_rebuilt("flapping-wing");
}

/// Runs a small study of a built-in scene, and writes the scene again from its report.
fn is_rebuilt(scene: &str) {
    let folder = tempfile::tempdir().unwrap();
    let study = folder.path().join("study");
    let options = ["run", "--scene", scene, "--accuracy", "draft", "--samples", "2000", "-q"];
    let bounds = ["--initial", "12", "--max-evaluations", "12"];
    let mut command = Command::new(env!("CARGO_BIN_EXE_coordinator"));
    let output = command.args(options).args(bounds).arg("--out").arg(&study).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let page = std::fs::read_to_string(study.join("report.html")).unwrap();
    // The raw text of the scene, which the appendix lists, is not read.
    let (tables, appendix) = page.split_once("<summary>Scene</summary>").unwrap();
    assert!(appendix.contains("[[bodies]]") && !tables.contains("[[bodies]]"));
    let text = toml::to_string(&rebuilt(tables)).unwrap();
    let again = SceneSource::parse(&text, "again").unwrap_or_else(|faults| panic!("{faults}\n{text}"));
    let original = SceneSource::builtin(scene).unwrap();
    assert_eq!(again.nominal(), original.nominal(), "{text}");
    assert_eq!(hash(again.nominal()), hash(original.nominal()));
    // Every sample of the variables gives the same mechanism, so that a study has the same bits.
    for j in 0..50 {
        let probability = |k: usize| ((f64::from(j) + 0.5) * (2.0 + k as f64).sqrt()).fract().max(1e-3);
        let values = original.variables().iter().enumerate();
        let sample: Vec<f64> =
            values.map(|(k, variable)| variable.distribution.quantile(probability(k))).collect();
        let [a, b] = [&again, &original].map(|source| source.resolve_sample(&sample).unwrap());
        assert_eq!(hash(&a), hash(&b), "{sample:?}");
    }
    assert_ne!(
        hash(
            &again
                .resolve_sample(&original.means().iter().map(|mean| 1.01 * mean).collect::<Vec<_>>())
                .unwrap()
        ),
        hash(original.nominal())
    );
}
