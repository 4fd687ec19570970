//! Scenes from files of linkage programs, for `coordinator init --from`: `.linkage2` (Linkage by D. Rector), the text of PMKS, and links of PMKS+.
//!
//! All formats state points and the links that join them. Every link becomes a body: the links with two points of the ground the frame, the one
//! with the input a driven body, the others free bodies with the mass of rods of steel. Joints are ideal, but for the hinges of the last link,
//! which get a clearance, so that there is something to study. Everything that was assumed, and everything that could not be read, is stated.
//!
//! # Source
//! Elements and attributes of `.linkage2` as its program writes them; lines of PMKS: links, type, x, y, angle of a slide in degrees.

mod linkage;
mod pmks_plus;
#[cfg(test)]
mod tests;

use linkage::{Cylinder, ImportedLinkage, Pin};
use std::collections::BTreeMap;

/// Speed of an input without one [r/min].
const SPEED: f64 = 30.0;

/// Reads a file by its content: XML is `.linkage2`, an address is a link of PMKS+, else lines of PMKS.
///
/// # Errors
/// What is wrong, with the line.
pub fn read(text: &str) -> Result<ImportedLinkage, String> {
    let linkage = match text.trim_start() {
        xml if xml.starts_with('<') => linkage2(text)?,
        json if json.starts_with('{') => {
            return Err("is JSON: PMKS+ keeps a mechanism in its link, https://...".to_owned());
        }
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
