//! Reads bodies: their motion, the drives of those that are driven, their points, and mass, centre of mass and moment of inertia from a shape.
//!
//! A rod of the section A [m^2] and the density rho [kg/m^3] along the straight lines between points: m = rho A L, and for each line of length l
//! about its middle m l^2 / 12. A plate of the thickness h [m]: the polygon with the given corners, or the convex hull of the points of the body,
//! by the integrals of a polygon. Holes, heads and fillets are left out.
//!
//! # Source
//! Shoelace formulas of area, centroid and second moments: Bourke (1988), Calculating the area and centroid of a polygon; Steger (1996), On the
//! calculation of arbitrary moments of polygons.

use super::body_row::{BodyRow, MotionWord};
use super::clearance::MaterialRow;
use super::context::Range;
use super::model::{MassProperties, Motion, Point};
use super::quantity::*;
use super::section::{Section, record};
use super::tables::over_time;
use super::values::Drive;

/// Reads `[[bodies]]`; a faulty body keeps its row.
pub(super) fn bodies(file: &mut Section, materials: &[MaterialRow]) -> Vec<BodyRow> {
    let words = [("fixed", MotionWord::Fixed), ("driven", MotionWord::Driven), ("free", MotionWord::Free)];
    let bodies = file.each_row("bodies", |name, row| {
        let word = row.word("motion", &words);
        let points = points(row);
        let motion = word.and_then(|word| match word {
            MotionWord::Fixed => Some(Motion::Fixed),
            MotionWord::Driven => driven(row, &points, materials),
            MotionWord::Free => free(row, &points, materials),
        });
        BodyRow { name: name.to_owned(), word, motion, points }
    });
    if bodies.is_empty() {
        file.missing("bodies", "at least one body, [[bodies]]");
    }
    bodies
}

fn driven(row: &mut Section, points: &[Point], materials: &[MaterialRow]) -> Option<Motion> {
    record!(Motion::Driven {
        position: row.pair("position", LENGTH),
        drive: drive(row),
        inertia: driven_inertia(row, points, materials),
    })
}

/// A body is driven at a speed, constant or by a table, or at an angle by a table.
fn drive(row: &mut Section) -> Option<Drive> {
    let expected = || format!("{}, or a table of it, or angle, a table", ANGULAR_VELOCITY.in_words());
    let key = row.either(["speed", "angle"], expected);
    let start = row.get("start_angle");
    if key? == "angle" {
        let table = over_time(row, "angle", ANGLE);
        if start.is_some() {
            let message = "belongs to speed; the start is the first value of the table of angles";
            row.inconsistent("start_angle", message);
        }
        return table.map(Drive::Angle);
    }
    let start_angle = row.quantity_or("start_angle", ANGLE, Range::Any, 0.0);
    if row.get("speed").is_some_and(toml::Value::is_table) {
        let table = over_time(row, "speed", ANGULAR_VELOCITY);
        return Some(Drive::Speed { start_angle: start_angle?, table: table? });
    }
    let speed = row.quantity("speed", ANGULAR_VELOCITY, Range::NotZero);
    Some(Drive::ConstantSpeed { start_angle: start_angle?, speed: speed? })
}

/// Mass and moment of inertia of a driven body, or its shape: both or neither.
fn driven_inertia(
    row: &mut Section,
    points: &[Point],
    materials: &[MaterialRow],
) -> Option<Option<MassProperties>> {
    let given = ["mass", "inertia", "centre_of_mass", "shape"].map(|key| row.get(key).is_some());
    if given == [false; 4] {
        return Some(None);
    }
    let shape = row.if_any("shape", |row, _| shape(row, points, materials))?;
    let centre = shape.map_or([0.0; 2], |shape| shape.centre_of_mass);
    let [of_mass, of_inertia] = mass_and_inertia(row, shape);
    let inertia = record!(MassProperties {
        mass: of_mass,
        inertia: of_inertia,
        centre_of_mass: row.pair_or("centre_of_mass", LENGTH, centre),
    });
    inertia.map(Some)
}

/// Mass and moment of inertia, those of the shape where they are not given: of a given mass in that shape.
fn mass_and_inertia(row: &mut Section, shape: Option<MassProperties>) -> [Option<f64>; 2] {
    let mass = row.quantity_unless("mass", MASS, Range::Positive, shape.map(|shape| shape.mass));
    let of_mass = |shape: MassProperties| shape.inertia * mass.map_or(1.0, |mass| mass / shape.mass);
    let inertia = row.quantity_unless("inertia", INERTIA, Range::Positive, shape.map(of_mass));
    [mass, inertia]
}

fn free(row: &mut Section, points: &[Point], materials: &[MaterialRow]) -> Option<Motion> {
    // A faulty shape leaves its quantities open: they are then no faults as well.
    let shape = match row.if_any("shape", |row, _| shape(row, points, materials)) {
        None => Some(MassProperties { mass: 1.0, inertia: 1.0, centre_of_mass: [0.0; 2] }),
        Some(shape) => shape,
    };
    let [of_mass, of_inertia] = mass_and_inertia(row, shape);
    record!(Motion::Free {
        mass: of_mass,
        inertia: of_inertia,
        centre_of_mass: match shape {
            Some(shape) => row.pair_or("centre_of_mass", LENGTH, shape.centre_of_mass),
            None => row.pair("centre_of_mass", LENGTH),
        },
        start_position: row.pair("start_position", LENGTH),
        start_angle: row.quantity("start_angle", ANGLE, Range::Any),
        start_velocity: row.if_any("start_velocity", |row, key| row.pair(key, SPEED)),
        start_speed: row.quantity_if_any("start_speed", ANGULAR_VELOCITY, Range::Any),
    })
}

fn points(row: &mut Section) -> Vec<Point> {
    let Some(section) = row.section_if_any("points") else { return Vec::new() };
    // A faulty point keeps its name, so that references to it are not faults as well.
    let position = |name: &str, value| section.as_pair(name, value, LENGTH).unwrap_or_default();
    let point = |(name, value): (&String, _)| Point { name: name.clone(), position: position(name, value) };
    section.entries().map(point).collect()
}

/// Key and kind of the size of a shape across its points, its mass properties by them, and the points that it needs.
type ShapeForm = (&'static str, Kind, fn(&[[f64; 2]], f64) -> Option<MassProperties>, &'static str);

/// The types of shapes by their words.
const FORMS: [(&str, ShapeForm); 2] = [
    ("rod", ("section", AREA, rod, "two points apart")),
    ("plate", ("thickness", LENGTH, plate, "three points that span an area")),
];

/// Reads `shape = { type, points, section or thickness, material or density }`; none if it is faulty.
fn shape(row: &mut Section, points: &[Point], materials: &[MaterialRow]) -> Option<MassProperties> {
    let mut shape = row.section_if_any("shape")?;
    let form = shape.word("type", &FORMS);
    let corners = corners(&mut shape, points);
    let (key, kind, properties, needed) = form?;
    let size = shape.quantity(key, kind, Range::Positive);
    let density = density(&mut shape, materials);
    shape.finish();
    let (corners, size, density) = (corners?, size?, density?);
    let message = format!("have no extent: {needed} are needed");
    properties(&corners, density * size).or_else(|| shape.inconsistent("points", message).and(None))
}

/// The points named, in their order; without names the corners of the convex hull of all points.
fn corners(shape: &mut Section, points: &[Point]) -> Option<Vec<[f64; 2]>> {
    if shape.get("points").is_none() {
        return Some(hull(points.iter().map(|point| point.position).collect()));
    }
    let names = shape.texts("points", "a list of names of points of the body")?;
    let known = points.iter().map(|point| point.name.as_str());
    let found: Vec<_> =
        names.iter().map(|name| shape.reference("points", "point", name, known.clone())).collect();
    found.into_iter().map(|index| Some(points[index?].position)).collect()
}

/// Density, or that of a material [kg/m^3].
fn density(shape: &mut Section, materials: &[MaterialRow]) -> Option<f64> {
    let own = shape.get("density").is_some();
    if shape.get("material").is_none() {
        return shape.quantity("density", DENSITY, Range::Positive);
    }
    if own {
        return shape.inconsistent_table("give either material or density, not both").and(None);
    }
    let name = shape.text("material", "the name of a material")?;
    let known = materials.iter().map(|material| material.name.as_str());
    let material = &materials[shape.reference("material", "material", name, known)?];
    let message = format!("{name} has no density: add density to [materials.{name}]");
    material.density.or_else(|| shape.inconsistent("material", message).and(None))
}

/// Mass properties of lines of the mass `line` per length [kg/m]; none without a length.
fn rod(points: &[[f64; 2]], line: f64) -> Option<MassProperties> {
    let parts: Vec<([f64; 2], f64)> = points
        .windows(2)
        .map(|pair| {
            let [[ax, ay], [bx, by]] = [pair[0], pair[1]];
            ([0.5 * (ax + bx), 0.5 * (ay + by)], (bx - ax).hypot(by - ay))
        })
        .collect();
    let length: f64 = parts.iter().map(|part| part.1).sum();
    let centre = [0, 1].map(|k: usize| parts.iter().map(|(middle, l)| middle[k] * l).sum::<f64>() / length);
    let about = |(middle, l): &([f64; 2], f64)| {
        l * (l * l / 12.0 + (middle[0] - centre[0]).powi(2) + (middle[1] - centre[1]).powi(2))
    };
    let inertia = line * parts.iter().map(about).sum::<f64>();
    (length > 0.0).then_some(MassProperties { mass: line * length, inertia, centre_of_mass: centre })
}

/// Mass properties of a polygon of the mass `sheet` per area [kg/m^2]; none without an area.
fn plate(corners: &[[f64; 2]], sheet: f64) -> Option<MassProperties> {
    let origin = *corners.first()?;
    let local: Vec<[f64; 2]> = corners.iter().map(|[x, y]| [x - origin[0], y - origin[1]]).collect();
    let (mut area, mut first, mut second) = (0.0, [0.0; 2], 0.0);
    for (k, [ax, ay]) in local.iter().enumerate() {
        let [bx, by] = local[(k + 1) % local.len()];
        let cross = ax * by - bx * ay;
        area += 0.5 * cross;
        first[0] += cross * (ax + bx) / 6.0;
        first[1] += cross * (ay + by) / 6.0;
        second += cross * (ax * ax + ax * bx + bx * bx + ay * ay + ay * by + by * by) / 12.0;
    }
    let [x, y] = first.map(|moment| moment / area);
    let inertia = sheet * (second.abs() - area.abs() * (x * x + y * y));
    let (mass, centre) = (sheet * area.abs(), [origin[0] + x, origin[1] + y]);
    (inertia > 0.0 && mass > 0.0).then_some(MassProperties { mass, inertia, centre_of_mass: centre })
}

/// Corners of the convex hull, counter-clockwise (Andrew's monotone chain).
fn hull(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let chain = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let mut chain: Vec<[f64; 2]> = Vec::new();
        for p in points {
            while let [.., a, b] = chain[..]
                && (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) <= 0.0
            {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let lower = chain(&mut points.iter().copied());
    let upper = chain(&mut points.iter().rev().copied());
    if lower.len() + upper.len() < 3 { points } else { [lower, upper].concat() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(found: Option<MassProperties>, mass: f64, inertia: f64, centre: [f64; 2]) {
        let found = found.expect("a body");
        for (found, exact) in [
            (found.mass, mass),
            (found.inertia, inertia),
            (found.centre_of_mass[0], centre[0]),
            (found.centre_of_mass[1], centre[1]),
        ] {
            assert!((found - exact).abs() < 1e-12, "{found} against {exact}");
        }
    }

    #[test]
    fn rods_and_plates_have_the_moments_of_textbooks() {
        close(rod(&[[0.1, 0.2], [0.4, 0.6]], 2.0), 1.0, 0.25 / 12.0, [0.25, 0.4]);
        // A right angle of two rods of length 1 each: centres at 1/4 of the diagonal from the corner.
        close(
            rod(&[[1.0, 0.0], [0.0, 0.0], [0.0, 1.0]], 3.0),
            6.0,
            3.0 * (2.0 / 12.0 + 2.0 * 0.125),
            [0.25; 2],
        );
        let rectangle = [[1.0, 1.0], [1.4, 1.0], [1.4, 1.3], [1.0, 1.3]];
        close(plate(&rectangle, 10.0), 1.2, 1.2 * 0.25 / 12.0, [1.2, 1.15]);
        let triangle = [[0.0, 0.0], [0.0, 0.6], [0.3, 0.0]];
        // b h (b^2 + h^2) / 36 of a right triangle.
        close(plate(&triangle, 1.0), 0.09, 0.18 * 0.45 / 36.0, [0.1, 0.2]);
        assert!(plate(&[[0.0, 0.0], [1.0, 1.0]], 1.0).is_none() && rod(&[[0.0, 0.0]], 1.0).is_none());
    }

    #[test]
    fn the_hull_leaves_out_what_is_inside() {
        let points = vec![[0.0, 0.0], [1.0, 0.0], [0.5, 0.4], [1.0, 1.0], [0.5, 0.0], [0.0, 1.0]];
        assert_eq!(hull(points), [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
    }
}
