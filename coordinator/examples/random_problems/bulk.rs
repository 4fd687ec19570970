//! The family `bulk`: bumps, valleys, ridges and waves within two standard deviations of the mean on a plane, in two to six
//! variables, that a surrogate must find where most of the population lies.

use super::course::Course;
use super::draw::{direction, directions, log_uniform, mixture, phase, rng_range, scaled};
use super::family::Shape;
use super::problem::Class;
use super::response::{Response, Term};
use rand::{Rng, RngExt};

/// Classes in turn.
pub const TURN: [Class; 6] =
    [Class::Bumps, Class::Ridge, Class::Bumps, Class::Periodic, Class::Bumps, Class::Ridge];
/// Share of the bumps after the first that are valleys [1].
const VALLEYS: f64 = 0.3;

/// A problem of a class of this family.
pub fn shape(rng: &mut impl Rng, class: Class) -> Shape {
    let d = rng.random_range(2..=6);
    let slope = rng.random_range(0.0..1.0);
    let mut terms = vec![Term::Plane(scaled(&direction(rng, d), slope))];
    match class {
        Class::Ridge => {
            let axes = directions(rng, d, 2);
            let step = Term::Step {
                height: 1.0,
                direction: axes[0].clone(),
                edge: rng.random_range(-1.0..1.0),
                width: rng.random_range(0.2..0.6),
            };
            terms.push(Term::Ridge(Box::new(step), Box::new(wave(rng, &axes[1]))));
            let count = rng.random_range(0..=2);
            terms.extend(bumps(rng, d, count));
        }
        Class::Periodic => {
            let count = rng.random_range(1..=2);
            for axis in directions(rng, d, count) {
                terms.push(wave(rng, &axis));
            }
            terms.extend(bumps(rng, d, 1));
        }
        _ => {
            let count = rng.random_range(1..=4);
            terms.extend(bumps(rng, d, count));
        }
    }
    Shape {
        variables: mixture(rng, d),
        modes: vec![Response::Sum(terms)],
        course: Course::Once,
        wanted: log_uniform(rng, 1e-3, 0.1),
        centres: vec![],
    }
}

/// A wave of 2 to 5 standard deviations' length along a unit vector.
fn wave(rng: &mut impl Rng, axis: &[f64]) -> Term {
    let frequency = scaled(axis, rng_range(rng, 1.2, 3.0));
    Term::Wave { amplitude: rng.random_range(0.5..1.5), frequency, phase: phase(rng) }
}

/// Bumps of which the first rises.
fn bumps(rng: &mut impl Rng, d: usize, count: usize) -> Vec<Term> {
    // With more variables as large a part of the population as in two.
    let widened = if d <= 3 { 1.0 } else { (d as f64 / 2.0).sqrt() };
    let mut one = |k: usize| {
        let sign = if k > 0 && rng.random_bool(VALLEYS) { -1.0 } else { 1.0 };
        let (height, distance) = (sign * rng_range(rng, 0.5, 2.0), rng_range(rng, 0.0, 2.0));
        let centre = scaled(&direction(rng, d), distance);
        Term::Bump { height, centre, width: widened * rng.random_range(0.3..1.0) }
    };
    (0..count).map(&mut one).collect()
}
