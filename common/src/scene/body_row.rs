//! A body while its scene is read, and the references to it: names of bodies, places on them.

use super::attachment::Attachment;
use super::model::{Body, Motion, Point};
use super::read::Context;
use super::section::Section;

/// How a body moves, in one word.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum MotionWord {
    /// Part of the frame.
    Fixed,
    /// Turns as prescribed.
    Driven,
    /// Moves as it must.
    Free,
}

/// A body as far as it could be read. A faulty one keeps its place and points, so that references find them.
pub(super) struct BodyRow {
    pub(super) name: String,
    /// How it moves, unless that is not said.
    pub(super) word: Option<MotionWord>,
    /// Its motion, unless faulty.
    pub(super) motion: Option<Motion>,
    pub(super) points: Vec<Point>,
}

impl BodyRow {
    /// The body, unless faulty.
    pub(super) fn checked(self) -> Option<Body> {
        Some(Body { name: self.name, motion: self.motion?, points: self.points })
    }
}

/// Reads the name of a body; its index.
pub(super) fn body(
    cx: &mut Context,
    row: &mut Section,
    key: &'static str,
    bodies: &[BodyRow],
) -> Option<usize> {
    let name = row.text(cx, key, "the name of a body")?;
    cx.reference(&row.key(key), "body", name, bodies.iter().map(|body| body.name.as_str()))
}

/// Reads a place `{ body = "...", point = "..." }`.
pub(super) fn place(
    cx: &mut Context,
    row: &mut Section,
    key: &'static str,
    bodies: &[BodyRow],
) -> Option<Attachment> {
    let mut place = row.section(cx, key, "a place { body, point }")?;
    let body = body(cx, &mut place, "body", bodies);
    let point = place.text(cx, "point", "the name of a point of that body");
    let point_key = place.key("point");
    place.finish(cx);
    let body = body?;
    let points = &bodies[body].points;
    let point = cx.reference(&point_key, "point", point?, points.iter().map(|point| point.name.as_str()))?;
    Some(Attachment { body, position: points[point].position })
}
