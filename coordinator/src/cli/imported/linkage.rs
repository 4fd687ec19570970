//! A linkage that was read: its points and links, and the scene that they give.

use std::fmt::Write;

/// Length of a unit of the files [mm].
const UNIT: &str = "mm";

/// A point of the file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Pin {
    pub(super) name: String,
    pub(super) at: [f64; 2],
    pub(super) is_anchor: bool,
    /// Links that have the point.
    pub(super) links: Vec<usize>,
    /// Direction [deg] along which the other links slide on the last one.
    pub(super) slides: Option<f64>,
    /// The others may turn against the last one.
    pub(super) turns: bool,
    /// Speed of the link about an anchor [r/min].
    pub(super) speed: Option<f64>,
}

/// A linear drive: link whose points it joins, stroke in units of the file, cycles per minute.
#[derive(Debug, Clone, PartialEq)]
pub struct Cylinder {
    pub(super) ends: [usize; 2],
    pub(super) stroke: f64,
    pub(super) rate: f64,
}

/// What a file says.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ImportedLinkage {
    pub(super) pins: Vec<Pin>,
    /// Names of the links; the first one is the frame.
    pub(super) links: Vec<String>,
    pub(super) cylinders: Vec<Cylinder>,
    /// What was not read, with its place.
    pub unread: Vec<String>,
}

/// A joint of the scene: name, word, links with the shared point, direction of a line [deg].
pub struct ImportedJoint<'l> {
    pub(super) name: String,
    pub(super) word: &'static str,
    pub(super) links: [usize; 2],
    pub(super) pin: &'l Pin,
    pub(super) axis: Option<f64>,
}

impl ImportedLinkage {
    /// The link that an input drives, its pivot, and its speed [r/min].
    pub(super) fn driven(&self) -> Option<(usize, &Pin, f64)> {
        self.pins.iter().find_map(|pin| Some((*pin.links.iter().find(|link| **link != 0)?, pin, pin.speed?)))
    }

    /// The joints: of the links at a point all with the first, without the pivot of the driven one. The last hinge has a clearance.
    pub(super) fn joints(&self) -> Vec<ImportedJoint<'_>> {
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
                writeln!(out, "motion = \"free\"\n{mass}")?;
                writeln!(out, "start_position = {start}\nstart_angle = \"0 deg\"")?;
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
            writeln!(out, "[[joints]]\nname = \"cylinder{}\"\ntype = \"linear-drive\"", k + 1)?;
            writeln!(out, "a = {of_a}\nb = {of_b}")?;
            let (at, to) = (format!("[0, {half}, {}]", 2.0 * half), from + stroke);
            writeln!(
                out,
                "length = {{ over = \"time\", at = {{ unit = \"s\", values = {at} }}, value = {{ unit = \"{UNIT}\", values = [{from}, {to}, {from}] }} }}\n"
            )?;
        }
        write!(out, "{END}")
    }
}

fn pair([x, y]: [f64; 2]) -> String {
    format!("[\"{x} {UNIT}\", \"{y} {UNIT}\"]")
}

/// Values of the hinge with clearance: those of common bearings.
const DEFAULTS: &str = include_str!("defaults.toml");

/// Output, limit and life.
const END: &str = include_str!("end.toml");
