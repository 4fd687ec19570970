//! The drawing of a mechanism as a DXF file (ASCII, AutoCAD release 12) in true dimensions: links, journals and bores, rails,
//! wheels, supports, drives, loads and names in the drawn position, with a layer for each kind.

use super::geometry::{CLEARANCE, DrawnJoint, DrawnMechanism, FIXED, LoadSymbol};
use super::sheet::{FONT, FORCE, SheetScale, TURNS, places, sheet};
use super::symbols::{BLOCK, SUPPORT, around, coil, direction, head, spiral};
use crate::presentation::report::format::unit_scale;

/// Angles between which the arc of a curved arrow lies [deg].
const ARC: [f64; 2] = [-30.0, 210.0];

/// Entities, whose places are given in drawing units.
struct Entities {
    text: String,
    scale: SheetScale,
    /// Unit of length [m].
    unit: f64,
}

impl Entities {
    fn begin(&mut self, kind: &str, layer: &str) {
        self.text += &format!("  0\n{kind}\n  8\n{}\n", layer.to_uppercase());
    }

    fn number(&mut self, code: u8, value: f64) {
        self.text += &format!("{code:3}\n{value:.9}\n");
    }

    /// Coordinates of the first (0) or second (1) place of an entity.
    fn place(&mut self, which: u8, at: [f64; 2]) {
        let [x, y] = self.scale.point(at);
        self.number(10 + which, x / self.unit);
        self.number(20 + which, y / self.unit);
    }

    fn line(&mut self, layer: &str, corners: &[[f64; 2]], is_closed: bool) {
        match corners {
            [] | [_] => {}
            [from, to] => {
                self.begin("LINE", layer);
                self.place(0, *from);
                self.place(1, *to);
            }
            _ => {
                self.begin("POLYLINE", layer);
                self.text += &format!(" 66\n1\n 70\n{}\n", u8::from(is_closed));
                for corner in corners {
                    self.begin("VERTEX", layer);
                    self.place(0, *corner);
                }
                self.begin("SEQEND", layer);
            }
        }
    }

    /// A circle, or an arc between two angles [deg].
    fn circle(&mut self, layer: &str, centre: [f64; 2], radius: f64, arc: Option<[f64; 2]>) {
        self.begin(if arc.is_some() { "ARC" } else { "CIRCLE" }, layer);
        self.place(0, centre);
        self.number(40, radius / self.scale.units / self.unit);
        for (code, angle) in [50, 51].into_iter().zip(arc.into_iter().flatten()) {
            self.number(code, angle);
        }
    }

    fn curved_arrow(&mut self, layer: &str, [x, y]: [f64; 2], radius: f64, counter_clockwise: bool) {
        self.circle(layer, [x, y], radius, Some(ARC));
        let (end, sign) = if counter_clockwise { (ARC[1], 1.0) } else { (ARC[0], -1.0) };
        let (sin, cos) = end.to_radians().sin_cos();
        self.line(layer, &head([x + radius * cos, y - radius * sin], [-sign * sin, -sign * cos]), true);
    }

    fn words(&mut self, at: [f64; 2], words: &str) {
        self.begin("TEXT", "name");
        self.place(0, at);
        self.number(40, 0.7 * FONT / self.scale.units / self.unit);
        let letter = |letter: char| match letter {
            '\u{b0}' => "%%d".to_owned(),
            '\u{a0}' => " ".to_owned(),
            other if other.is_ascii() => other.to_string(),
            other => format!("\\U+{:04X}", u32::from(other)),
        };
        self.text += &format!("  1\n{}\n", words.chars().map(letter).collect::<String>());
    }

    /// Journal and bore, wheels, a slider on its way, or the symbol of an ideal hinge.
    fn joint(&mut self, joint: &DrawnJoint) {
        let at = self.scale.place(joint.at_m);
        for (centre, radius) in &joint.circles_m {
            self.circle(joint.kind, self.scale.place(*centre), radius * self.scale.units, None);
        }
        for line in &joint.shapes_m {
            self.line(joint.kind, &places(line, &self.scale), false);
        }
        if let Some(rail) = joint.rail_m.map(|ends| ends.map(|end| self.scale.place(end))) {
            let ([x, y], _) = direction(rail[0], rail[1]);
            let corner = |[along, across]: [f64; 2]| {
                let (along, across) = (0.5 * along * BLOCK[0], 0.5 * across * BLOCK[1]);
                [at[0] + along * x - across * y, at[1] + along * y + across * x]
            };
            self.line(joint.kind, &rail, false);
            self.line(joint.kind, &[[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]].map(corner), true);
        } else if joint.kind != CLEARANCE {
            self.circle(joint.kind, at, 5.0, None);
        }
    }
}

/// The mechanism as a DXF file, lengths in the unit of the scene.
pub fn dxf(drawn: &DrawnMechanism) -> String {
    let sheet = sheet(drawn);
    let mut file = Entities { text: String::new(), scale: sheet.scale, unit: unit_scale(&drawn.length_unit) };
    for body in &drawn.bodies {
        if body.motion != FIXED {
            file.line("body", &around(&places(&body.outline_m, &file.scale)), true);
        }
        for [x, y] in places(&body.supports_m, &file.scale) {
            file.line("frame", &[[x, y], [x - 9.0, y + SUPPORT], [x + 9.0, y + SUPPORT]], true);
        }
    }
    drawn.joints.iter().for_each(|joint| file.joint(joint));
    for drive in &drawn.drives {
        file.curved_arrow("drive", file.scale.place(drive.pivot_m), TURNS[0], drive.counter_clockwise);
    }
    for load in &drawn.loads {
        match load.symbol {
            LoadSymbol::Arrow(at, [x, y]) => {
                let [from, tip] = [at, [at[0] + x, at[1] + y]].map(|point| file.scale.place(point));
                let (way, _) = direction(from, tip);
                let to = [from[0] + FORCE * way[0], from[1] + FORCE * way[1]];
                file.line("load", &[from, to], false);
                file.line("load", &head(to, way), true);
            }
            LoadSymbol::Turn(at, counter_clockwise) => {
                file.curved_arrow("load", file.scale.place(at), TURNS[1], counter_clockwise);
            }
            LoadSymbol::Coil(from, to) => {
                file.line("load", &coil(file.scale.place(from), file.scale.place(to)), false);
            }
            LoadSymbol::Spiral(at) => file.line("load", &spiral(file.scale.place(at)), false),
        }
    }
    for label in &sheet.labels {
        file.words([label.area.from[0], label.area.to[1] - 5.0], &label.label.text);
    }
    let unit = format!("lengths in {}", drawn.length_unit);
    file.words([sheet.area.from[0], sheet.area.to[1] - 13.0], &unit);
    format!(
        "999\n{unit}\n  0\nSECTION\n  2\nHEADER\n  9\n$ACADVER\n  1\nAC1009\n  0\nENDSEC\n  0\nSECTION\n  2\nENTITIES\n{}  0\nENDSEC\n  0\nEOF\n",
        file.text
    )
}
