//! Indices of the frames of one island: its free bodies, then the prescribed bodies that its joints and loads
//! touch.

use super::frame::End;
use super::prescribed::Prescribed;
use common::scene::{Attachment, Scene};

/// The frames of an island under construction.
pub struct IslandFrames<'a> {
    scene: &'a Scene,
    /// Number of free bodies.
    free: usize,
    /// Bodies of the scene by frame.
    frames: Vec<usize>,
}

impl<'a> IslandFrames<'a> {
    /// The frames of the free bodies `bodies` of a scene.
    pub(crate) fn new(scene: &'a Scene, bodies: Vec<usize>) -> Self {
        IslandFrames { scene, free: bodies.len(), frames: bodies }
    }

    /// Free bodies, all of which have a frame.
    pub(super) fn bodies(&self) -> &[usize] {
        &self.frames[..self.free]
    }

    /// Prescribed bodies that have a frame.
    pub(crate) fn touched(&self) -> &[usize] {
        &self.frames[self.free..]
    }

    /// Motions of the prescribed bodies that have a frame.
    pub(crate) fn prescribed(&self) -> Vec<Prescribed> {
        self.touched().iter().filter_map(|&b| Prescribed::from_body(&self.scene.bodies[b])).collect()
    }

    /// Index of the frame of a body of the scene.
    pub(super) fn frame(&mut self, body: usize) -> usize {
        self.frames.iter().position(|&b| b == body).unwrap_or_else(|| {
            self.frames.push(body);
            self.frames.len() - 1
        })
    }

    /// End of a joint or load at a point of a body of the scene.
    pub(super) fn end(&mut self, at: &Attachment) -> End {
        End { frame: self.frame(at.body), arm: self.scene.arm(at) }
    }
}
