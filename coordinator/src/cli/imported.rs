//! Scenes from files of linkage programs, for `coordinator init --from`: `.linkage2` (Linkage by D. Rector) and the text of PMKS.
//!
//! All formats state points and the links that join them. Every link becomes a body: the links with two points of the ground the frame, the one
//! with the input a driven body, the others free bodies with the mass of rods of steel. Joints are ideal, but for the hinges of the last link,
//! which get a clearance, so that there is something to study. Everything that was assumed, and everything that could not be read, is stated.
//!
//! # Source
//! Elements and attributes of `.linkage2` as its program writes them; lines of PMKS: links, type, x, y, angle of a slide in degrees.

mod pmks_plus;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::fmt::Write;

/// Length of a unit of the files [mm].
const UNIT: &str = "mm";

/// Speed of an input without one [r/min].
const SPEED: f64 = 30.0;

/// A point of the file.
#[derive(Debug, Clone, Default, PartialEq)]
struct Pin {
    name: String,
    at: [f64; 2],
    is_anchor: bool,
    /// Links that have the point.
    links: Vec<usize>,
    /// Direction [deg] along which the other links slide on the last one.
    slides: Option<f64>,
    /// The others may turn against the last one.
    turns: bool,
    /// Speed of the link about an anchor [r/min].
    speed: Option<f64>,
}

/// A linear drive: link whose points it joins, stroke in units of the file, cycles per minute.
#[derive(Debug, Clone, PartialEq)]
struct Cylinder {
    ends: [usize; 2],
    stroke: f64,
    rate: f64,
}

/// What a file says.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ImportedLinkage {
    pins: Vec<Pin>,
    /// Names of the links; the first one is the frame.
    links: Vec<String>,
    cylinders: Vec<Cylinder>,
    /// What was not read, with its place.
    pub unread: Vec<String>,
}

/// Reads a file by its content: XML is `.linkage2`, an address is a link of PMKS+, else lines of PMKS.
///
/// # Errors
/// What is wrong, with the line.
pub fn read(text: &str) -> Result<ImportedLinkage, String> {
    let linkage = match text.trim_start() {
        xml if xml.starts_with('<') => linkage2(text)?,
        link if link.starts_with("http") => pmks_plus::read(link.split_once('?').unwrap_or_default().1)?,
        _ => pmks(text)?,
    };
    let mut inputs = linkage.pins.iter().filter(|pin| pin.speed.is_some());
    if linkage.cylinders.is_empty() && inputs.next().is_none() {
        return Err("has no input: neither a turning link nor an actuator".to_owned());
    }
    if let Some(second) = inputs.next() {
        return Err(format!("has a second input at {}: one is allowed", second.name));
    }
    if !linkage.joints().iter().any(|joint| joint.word == "clearance") {
        return Err("has no hinge beside that of its drive: nothing could wear".to_owned());
    }
    Ok(linkage)
}

/// A name that scenes allow.
fn tame(name: &str) -> String {
    let letters =
        name.trim().chars().map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '_' });
    letters.collect()
}

fn linkage2(text: &str) -> Result<ImportedLinkage, String> {
    let document = roxmltree::Document::parse(text).map_err(|error| error.to_string())?;
    let root = document.root_element();
    if root.tag_name().name() != "linkage2" {
        return Err(format!("1:1: <{}> where <linkage2> was expected", root.tag_name().name()));
    }
    let place = |node: roxmltree::Node| document.text_pos_at(node.range().start);
    let number = |node: roxmltree::Node, key: &str| -> Result<f64, String> {
        let given = node.attribute(key).unwrap_or_default();
        let value = given.parse::<f64>().ok().filter(|value| value.is_finite());
        value.ok_or_else(|| format!("{}: {key} = {given:?} is no number", place(node)))
    };
    let is = |node: roxmltree::Node, key: &str| node.attribute(key) == Some("true");
    let mut found = ImportedLinkage { links: vec!["frame".to_owned()], ..Default::default() };
    let mut index: BTreeMap<&str, usize> = BTreeMap::new();
    let elements = |name: &'static str| {
        let is_named = move |node: &roxmltree::Node| node.tag_name().name().eq_ignore_ascii_case(name);
        root.children().filter(roxmltree::Node::is_element).filter(is_named)
    };
    let unread = |node: roxmltree::Node, keys: [&str; 3], of: &str| -> Vec<String> {
        let given = keys.into_iter().filter(|key| node.attribute(*key).is_some());
        given.map(|key| format!("{}: {key} of {of}", place(node))).collect()
    };
    for node in elements("connector") {
        let id = node.attribute("id").unwrap_or_default();
        let name = node.attribute("name").map_or_else(|| format!("p{id}"), tame);
        let pin = Pin {
            name,
            at: [number(node, "x")?, number(node, "y")?],
            is_anchor: is(node, "anchor"),
            speed: is(node, "input").then(|| number(node, "rpm")).transpose()?,
            ..Default::default()
        };
        if index.insert(id, found.pins.len()).is_some() {
            return Err(format!("{}: a second connector {id}", place(node)));
        }
        found.unread.extend(unread(node, ["slideradius", "fastenlink", "fastenconnector"], &pin.name));
        found.pins.push(pin);
    }
    let of = |node: roxmltree::Node| {
        let id = node.attribute("id").unwrap_or_default();
        index.get(id).copied().ok_or_else(|| format!("{}: there is no connector {id}", place(node)))
    };
    let within = |node: roxmltree::Node| -> Result<Vec<usize>, String> {
        node.children().filter(roxmltree::Node::is_element).map(of).collect()
    };
    for node in elements("link") {
        let id = node.attribute("id").unwrap_or_default();
        let pins = within(node)?;
        if let (true, [a, b]) = (is(node, "actuator"), &pins[..]) {
            let (stroke, rate) = (number(node, "throw")?, number(node, "cpm")?);
            found.cylinders.push(Cylinder { ends: [*a, *b], stroke, rate });
            continue;
        }
        found.unread.extend(unread(node, ["gear", "fastenlink", "fastenconnector"], &format!("link {id}")));
        let is_frame = pins.len() > 1 && pins.iter().filter(|pin| found.pins[**pin].is_anchor).count() > 1;
        let link = if is_frame { 0 } else { found.links.len() };
        if !is_frame {
            found.links.push(node.attribute("name").map_or_else(|| format!("link{id}"), tame));
        }
        pins.into_iter().for_each(|pin| found.pins[pin].links.push(link));
    }
    for node in elements("connector").filter(|node| is(*node, "slider")) {
        let (limits, pin) = (within(node)?, of(node)?);
        let slider = format!("{}: slider {}", place(node), found.pins[pin].name);
        let [from, to] = limits[..] else {
            found.unread.push(format!("{slider} without its two limits"));
            continue;
        };
        let [a, b] = [from, to].map(|limit| found.pins[limit].at);
        let both_fixed = [from, to].iter().all(|limit| found.pins[*limit].is_anchor);
        let shared = found.pins[from].links.iter().find(|link| found.pins[to].links.contains(link)).copied();
        let Some(guide) = (if both_fixed { Some(0) } else { shared }) else {
            found.unread.push(format!("{slider} between two links"));
            continue;
        };
        let own = &mut found.pins[pin];
        own.turns = true;
        own.slides = Some((b[1] - a[1]).atan2(b[0] - a[0]).to_degrees());
        own.links.push(guide);
    }
    let ratios = elements("ratios").map(|node| format!("{}: ratios of gears and chains", place(node)));
    found.unread.extend(ratios);
    for pin in found.pins.iter_mut().filter(|pin| pin.is_anchor && !pin.links.contains(&0)) {
        // First, so that a slider's line stays the last one.
        pin.links.insert(0, 0);
    }
    Ok(found)
}

fn pmks(text: &str) -> Result<ImportedLinkage, String> {
    let mut found = ImportedLinkage { links: vec!["frame".to_owned()], ..Default::default() };
    let lines = text.split(['\n', '|']).enumerate().map(|(k, line)| (k + 1, line.trim()));
    for (number, line) in lines.filter(|(_, line)| !line.is_empty()) {
        let cells: Vec<&str> = line.split([',', ' ', '\t']).filter(|cell| !cell.is_empty()).collect();
        let kind =
            cells.iter().position(|cell| ["R", "P", "RP", "G"].contains(&cell.to_uppercase().as_str()));
        let Some(kind) = kind.filter(|kind| *kind > 0) else {
            found.unread.push(format!("line {number}: {line}"));
            continue;
        };
        let value = |k: usize| -> Result<f64, String> {
            let given = cells.get(kind + 1 + k).copied().unwrap_or_default();
            given.parse().map_err(|_| format!("line {number}: {given:?} where a number was expected: {line}"))
        };
        let mut pin = Pin { name: format!("p{number}"), at: [value(0)?, value(1)?], ..Default::default() };
        for name in &cells[..kind] {
            let name = if name.eq_ignore_ascii_case("ground") { "frame".to_owned() } else { tame(name) };
            let known = found.links.iter().position(|link| *link == name);
            pin.links.push(known.unwrap_or(found.links.len()));
            if known.is_none() {
                found.links.push(name);
            }
        }
        pin.is_anchor = pin.links.contains(&0);
        let is_input = pin.is_anchor && pin.links.iter().any(|link| found.links[*link] == "input");
        match cells[kind].to_uppercase().as_str() {
            "R" => pin.speed = is_input.then_some(SPEED),
            word @ ("P" | "RP") if pin.links.len() == 2 && !is_input => {
                pin.slides = Some(if cells.len() > kind + 3 { value(2)? } else { 0.0 });
                pin.turns = word == "RP";
            }
            _ => {
                found.unread.push(format!("line {number}: {line}"));
                continue;
            }
        }
        found.pins.push(pin);
    }
    Ok(found)
}

/// A joint of the scene: name, word, links with the shared point, direction of a line [deg].
struct ImportedJoint<'l> {
    name: String,
    word: &'static str,
    links: [usize; 2],
    pin: &'l Pin,
    axis: Option<f64>,
}

impl ImportedLinkage {
    /// The link that an input drives, its pivot, and its speed [r/min].
    fn driven(&self) -> Option<(usize, &Pin, f64)> {
        self.pins.iter().find_map(|pin| Some((*pin.links.iter().find(|link| **link != 0)?, pin, pin.speed?)))
    }

    /// The joints: of the links at a point all with the first, without the pivot of the driven one. The last hinge has a clearance.
    fn joints(&self) -> Vec<ImportedJoint<'_>> {
        let drive = self.driven().map(|(link, pin, _)| (link, pin.name.as_str()));
        let mut joints = Vec::new();
        for pin in &self.pins {
            let hinged = pin.links.iter().copied().filter(|link| drive != Some((*link, pin.name.as_str())));
            let hinged: Vec<usize> = hinged.collect();
            for (k, other) in hinged.iter().enumerate().skip(1) {
                let name = if k == 1 { pin.name.clone() } else { format!("{}_{k}", pin.name) };
                // The line of a slide is that of the last link.
                let axis = pin.slides.filter(|_| k + 1 == hinged.len());
                let word = match axis {
                    None => "revolute",
                    Some(_) if pin.turns => "slot",
                    Some(_) => "prismatic",
                };
                joints.push(ImportedJoint { name, word, links: [hinged[0], *other], pin, axis });
            }
        }
        if let Some(last) = joints.iter_mut().rev().find(|joint| joint.word == "revolute") {
            last.word = "clearance";
        }
        joints
    }

    /// The scene with this name, read from `file`.
    pub fn scene(&self, name: &str, file: &str) -> String {
        let mut out = format!(
            "# Read from {file}. Assumed: lengths in {UNIT}; links are rods of steel of 1 cm^2, blocks have 50 g;\n\
             # one hinge has a clearance with the values of [joint_defaults], the other joints are ideal.\n\
             # Limit and life are to be set.\n"
        );
        // Writing to a String cannot fail.
        let _ = self.write(&mut out, name, file);
        out
    }

    fn write(&self, out: &mut String, name: &str, file: &str) -> std::fmt::Result {
        for unread in &self.unread {
            writeln!(out, "# Not read: {unread}")?;
        }
        writeln!(out, "\n[scene]\nname = \"{name}\"\ntitle = \"{name}, from {file}\"\n\n{DEFAULTS}")?;
        let driven = self.driven();
        for (link, name) in self.links.iter().enumerate() {
            let pins: Vec<&Pin> = self.pins.iter().filter(|pin| pin.links.contains(&link)).collect();
            // Without points a link is nothing.
            let Some(first) = pins.first() else { continue };
            let drive = driven.filter(|(of, ..)| *of == link);
            let origin = if link == 0 { [0.0; 2] } else { drive.map_or(first.at, |(_, pin, _)| pin.at) };
            writeln!(out, "[[bodies]]\nname = \"{name}\"")?;
            if link == 0 {
                writeln!(out, "motion = \"fixed\"")?;
            } else if let Some((.., speed)) = drive {
                writeln!(out, "motion = \"driven\"\nposition = {}\nspeed = \"{speed} r/min\"", pair(origin))?;
            } else {
                let names: Vec<&str> = pins.iter().map(|pin| pin.name.as_str()).collect();
                // A block has one place, and no extent to take a rod's mass from.
                let mass = if pins.iter().all(|pin| pin.at == first.at) {
                    "mass = \"50 g\"\ninertia = \"10 kg mm^2\"\ncentre_of_mass = [\"0 mm\", \"0 mm\"]"
                        .to_owned()
                } else {
                    format!(
                        "shape = {{ type = \"rod\", points = {names:?}, section = \"1 cm^2\", material = \"steel\" }}"
                    )
                };
                let start = pair(origin);
                writeln!(
                    out,
                    "motion = \"free\"\n{mass}\nstart_position = {start}\nstart_angle = \"0 deg\""
                )?;
            }
            writeln!(out, "[bodies.points]")?;
            for Pin { name, at, .. } in pins {
                writeln!(out, "{name} = {}", pair([at[0] - origin[0], at[1] - origin[1]]))?;
            }
            writeln!(out)?;
        }
        let place = |link: usize, pin: &Pin| {
            format!("{{ body = \"{}\", point = \"{}\" }}", self.links[link], pin.name)
        };
        for ImportedJoint { name, word, links, pin, axis } in self.joints() {
            let [first, second] = if word == "clearance" { ["journal", "bushing"] } else { ["a", "b"] };
            let [a, b] = links.map(|link| place(link, pin));
            writeln!(out, "[[joints]]\nname = \"{name}\"\ntype = \"{word}\"\n{first} = {a}\n{second} = {b}")?;
            writeln!(out, "{}", axis.map_or(String::new(), |axis| format!("axis = \"{axis} deg\"\n")))?;
        }
        for (k, Cylinder { ends, stroke, rate }) in self.cylinders.iter().enumerate() {
            let [a, b] = ends.map(|pin| &self.pins[pin]);
            let (from, half) = ((a.at[0] - b.at[0]).hypot(a.at[1] - b.at[1]), 30.0 / rate.abs());
            let [of_a, of_b] = [a, b].map(|pin| place(pin.links.first().copied().unwrap_or_default(), pin));
            writeln!(
                out,
                "[[joints]]\nname = \"cylinder{}\"\ntype = \"linear-drive\"\na = {of_a}\nb = {of_b}",
                k + 1
            )?;
            let (at, to) = (format!("[0, {half}, {}]", 2.0 * half), from + stroke);
            writeln!(
                out,
                "length = {{ over = \"time\", at = {{ unit = \"s\", values = {at} }}, value = {{ unit = \"{UNIT}\", values = [{from}, {to}, {from}] }} }}\n"
            )?;
        }
        writeln!(out, "{END}")
    }
}

fn pair([x, y]: [f64; 2]) -> String {
    format!("[\"{x} {UNIT}\", \"{y} {UNIT}\"]")
}

/// Values of the hinge with clearance: those of common bearings.
const DEFAULTS: &str = r#"[joint_defaults]
journal_radius = "5 mm"
radial_clearance = "25 um"
width = "10 mm"
journal_material = "steel"
bushing_material = "bronze"
contact_law = "local-hertz"
contact_damping = { hunt_crossley = "1 s/m" }
film_damping = "100 N s/m"
friction = 0.1
friction_speed = "1 mm/s"
wear_coefficient = "1e-13 1/Pa"

[materials.steel]
elastic_modulus = "206 GPa"
poisson_ratio = 0.3
density = "7850 kg/m^3"

[materials.bronze]
elastic_modulus = "105 GPa"
poisson_ratio = 0.33
"#;

/// Output, limit and life.
const END: &str = r#"[[outputs]]
name = "wear"
type = "largest-wear"

[[limit_states]]
name = "worn"
output = "wear"
threshold = "0.1 mm"

[life]
cycles = 100000
checkpoint_every = 10000"#;
