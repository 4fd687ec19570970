//! Worn faces of a straight guide and of the slider in it, and the play between them.

mod faces;

pub(crate) use faces::{MOST_NODES, RailFaces, RailLayout, play};
