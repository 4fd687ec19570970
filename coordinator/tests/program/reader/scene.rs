//! A scene as the tables of a report state it.

use super::outputs::outputs_and_study;
use super::page::{between, plain, table};
use std::fmt::Write;

/// A quantity as a TOML text.
pub fn quoted(text: &str) -> String {
    format!("\"{text}\"")
}

/// `(1, 2)` in a unit as a TOML pair; an entry with its own unit keeps it.
fn pair(text: &str, unit: &str) -> String {
    let entries = text.trim_start_matches('(').trim_end_matches(')').split(", ");
    let entries = entries.map(|entry| {
        let bare = entry.parse::<f64>().is_ok();
        quoted(&if bare { format!("{entry} {unit}") } else { entry.to_owned() })
    });
    format!("[{}]", entries.collect::<Vec<_>>().join(", "))
}

/// `body.point (x, y)` as a TOML place.
pub fn place(text: &str) -> String {
    let name = text.split(" (").next().unwrap();
    let (body, point) = name.split_once('.').unwrap();
    format!("{{ body = \"{body}\", point = \"{point}\" }}")
}

/// The scene as the tables state it, with numbers where formulas stand.
pub fn rebuilt(page: &str) -> toml::Table {
    let mut text = String::new();
    let facts = table(page, "facts");
    let fact = |item: &str| facts.iter().find(|row| row["item"] == item).unwrap()["value"].clone();
    let name = fact("scene").split(',').next().unwrap().to_owned();
    let title = plain(between(page, "<h1>", "</h1>"));
    writeln!(text, "[scene]\nname = \"{name}\"\ntitle = \"{title}\"").unwrap();
    // Stated by a note with the size of what it leaves out.
    if page.contains("declares a part of its model") {
        text.push_str("control_points_of_model = true\n");
    }
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
            let (velocity, speed) = (&start["velocity [mm/s]"], &start["angular velocity"]);
            if velocity != "–" {
                write!(text, "\nstart_velocity = {}", pair(velocity, "mm/s")).unwrap();
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
    for row in table(page, "joints") {
        let joint = &row["joint"];
        let [first, second] =
            ["journal, or first body [mm]", "bushing, or second body [mm]"].map(|end| place(&row[end]));
        match row["kind"].as_str() {
            "revolute, ideal" => {
                writeln!(
                    text,
                    "[[joints]]\nname = \"{joint}\"\ntype = \"revolute\"\na = {first}\nb = {second}"
                )
                .unwrap();
            }
            "hinge with clearance" => text += &hinge(page, joint, &first, &second),
            "slider in a guide with clearance" => text += &guide(page, joint, &first, &second),
            other => panic!("no test scene has this joint: {other}"),
        }
    }
    let mut gravity = None;
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
        } else if row["type"] == "force" {
            let along = between(values, "along (", ")");
            let curves = table(page, "curves");
            let curve = curves.iter().find(|curve| curve["curve of"] == *name).unwrap();
            let over = curve["over"].strip_prefix("angle of ").unwrap();
            let points = curve["points"].split("; ").map(|point| point.split_once(": ").unwrap());
            let (at, value): (Vec<String>, Vec<String>) =
                points.map(|(at, v)| (quoted(at), quoted(v))).unzip();
            writeln!(
                text,
                "at = {}\ndirection = [{along}]\nsize = {{ over = {{ angle = \"{over}\" }}, at = [{}], value = [{}], repeat = {} }}",
                place(on),
                at.join(", "),
                value.join(", "),
                curve["repeated"] == "yes"
            )
            .unwrap();
        } else if row["type"] == "gravity" {
            // It is beside the lists of the scene.
            text.truncate(text.rfind("[[loads]]").unwrap());
            gravity = Some(pair(between(values, "acceleration ", " m/s^2"), "m/s^2"));
        } else {
            assert_eq!(row["type"], "constant-torque");
            let torque = values.strip_prefix("torque ").unwrap();
            writeln!(text, "body = \"{on}\"\ntorque = \"{torque}\"").unwrap();
        }
    }
    outputs_and_study(page, &mut text);
    let text = gravity.map_or(String::new(), |pair| format!("gravity = {pair}\n")) + &text;
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

/// The material of a part of a joint.
fn made_of(page: &str, part: &str, joint: &str) -> String {
    let materials = table(page, "materials");
    let of = materials.iter().find(|row| row[part].split(", ").any(|name| name == joint));
    of.unwrap_or_else(|| panic!("{part} {joint}"))["material"].clone()
}

/// The damping of a contact as a TOML table.
fn damping(text: &str) -> String {
    let factor = text.strip_prefix("hunt-crossley, ").expect("test scenes have this damping");
    format!("{{ hunt_crossley = \"{factor}\" }}")
}

/// A hinge with clearance.
fn hinge(page: &str, joint: &str, journal: &str, bushing: &str) -> String {
    let hinges = table(page, "hinges");
    let hinge = hinges.iter().find(|hinge| hinge["hinge"] == *joint).unwrap();
    let follows = |cell: &str| cell.starts_with('(');
    let radius = if follows(&hinge["bushing radius"]) {
        format!("radial_clearance = \"{}\"", hinge["radial clearance"])
    } else {
        format!("bushing_radius = \"{}\"", hinge["bushing radius"])
    };
    let (law, of_contact) = hinge["law and damping of the contact"].split_once("; ").unwrap();
    let points = match hinge["control points"].as_str() {
        "by the contact arc" => "\"auto\"",
        number => number,
    };
    format!(
        "[[joints]]\nname = \"{joint}\"\ntype = \"clearance\"\njournal = {journal}\nbushing = {bushing}\n\
         journal_radius = \"{}\"\n{radius}\nwidth = \"{}\"\njournal_material = \"{}\"\nbushing_material = \"{}\"\n\
         contact_law = \"{law}\"\ncontact_damping = {}\nfilm_damping = \"{}\"\nfriction = {}\nfriction_speed = \"{}\"\n\
         wear_coefficient = \"{}\"\ncontrol_points = {points}\n",
        hinge["journal radius"],
        hinge["width"],
        made_of(page, "journals of", joint),
        made_of(page, "bushings of", joint),
        damping(of_contact),
        hinge["film damping"],
        hinge["friction"],
        hinge["friction speed"],
        hinge["wear coefficient"],
    )
}

/// A slider in a guide with clearance.
fn guide(page: &str, joint: &str, slider: &str, of_guide: &str) -> String {
    let (guides, wear) = (table(page, "guides"), table(page, "guide-wear"));
    let row = guides.iter().find(|row| row["guide"] == *joint).unwrap();
    let (from, to) = row["from end to end"].split_once(" to ").unwrap();
    let worn = wear.iter().find(|row| row["guide"] == *joint).unwrap();
    assert_eq!(worn["coefficient of the guide"], "does not wear", "test scenes have this wear");
    format!(
        "[[joints]]\nname = \"{joint}\"\ntype = \"guide\"\nslider = {slider}\nguide = {of_guide}\naxis = \"{}\"\nangle = \"{}\"\n\
         length = \"{}\"\nheight = \"{}\"\nwidth = \"{}\"\nclearance = \"{}\"\nguide_start = \"{from}\"\nguide_end = \"{to}\"\n\
         slider_material = \"{}\"\nguide_material = \"{}\"\ncontact_damping = {}\nfriction = {}\nfriction_speed = \"{}\"\n\
         wears = \"slider\"\nwear_coefficient = \"{}\"\ncontrol_points = {}\n",
        row["direction"],
        row["turned by"],
        row["length"],
        row["height"],
        row["width"],
        row["clearance"],
        made_of(page, "sliders of", joint),
        made_of(page, "guides of", joint),
        damping(&row["damping of the contact"]),
        row["friction"],
        row["friction speed"],
        worn["coefficient of the slider"],
        worn["control points of a face"],
    )
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
