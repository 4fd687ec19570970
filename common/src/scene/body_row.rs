//! A body while its scene is read, and the references to it: names of bodies, places on them.

use super::model::{Body, Motion, Point};
use super::section::Section;
use super::values::{Attachment, Drive};

/// The words of `motion`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum MotionWord {
    /// `fixed`: part of the frame.
    Fixed,
    /// `driven`: rotates as prescribed.
    Driven,
    /// `free`: moves under joints and loads.
    Free,
}

/// A body while its scene is read. A faulty one keeps its place and points, so that references to them are found.
pub(super) struct BodyRow {
    pub(super) name: String,
    /// Kind of motion; none if it is missing or unknown.
    pub(super) word: Option<MotionWord>,
    /// Motion; none if it is faulty.
    pub(super) motion: Option<Motion>,
    pub(super) points: Vec<Point>,
}

impl BodyRow {
    /// How the body is driven; none if it is not, or if that is faulty.
    pub(super) fn drive(&self) -> Option<&Drive> {
        match &self.motion {
            Some(Motion::Driven { drive, .. }) => Some(drive),
            _ => None,
        }
    }

    /// The body; none if it is faulty.
    pub(super) fn checked(self) -> Option<Body> {
        Some(Body { name: self.name, motion: self.motion?, points: self.points })
    }
}

/// Reads the name of a body and returns its index.
pub(super) fn body(row: &mut Section, key: &'static str, bodies: &[BodyRow]) -> Option<usize> {
    let name = row.text(key, "the name of a body")?;
    row.reference(key, "body", name, bodies.iter().map(|body| body.name.as_str()))
}

/// Reads a place `{ body = "...", point = "..." }`.
pub(super) fn place(row: &mut Section, key: &'static str, bodies: &[BodyRow]) -> Option<Attachment> {
    let mut place = row.section(key, "a place { body, point }")?;
    let body = body(&mut place, "body", bodies);
    let point = place.text("point", "the name of a point of that body");
    place.finish();
    let body = body?;
    let points = &bodies[body].points;
    let point = place.reference("point", "point", point?, points.iter().map(|point| point.name.as_str()))?;
    Some(Attachment { body, position: points[point].position })
}
