//! The recorded motion of one cycle, as the outputs read it.

use super::moment_track::MomentTrack;
use super::{BodyTrack, PointTrack, Recorder};
use crate::mechanism::{Island, Prescribed};
use common::scene::{Attachment, Scene};
use std::borrow::Cow;

/// Intervals per cycle at which prescribed motions are sampled and displayed histories given.
const SAMPLES: usize = 1000;

/// Times of a cycle, in equal intervals, at which prescribed motions are sampled and displayed histories given `(1001,)` [s].
pub(crate) fn sample_times(scene: &Scene) -> Vec<f64> {
    (0..=SAMPLES).map(|k| scene.life.period * k as f64 / SAMPLES as f64).collect()
}

/// The recordings of all islands over one cycle.
pub struct RecordedCycle<'a> {
    /// The scene that was simulated.
    pub scene: &'a Scene,
    /// Each island with its recorder.
    pub islands: Vec<(&'a Island, &'a Recorder)>,
    /// Paths of the requested points on the mechanism with ideal joints.
    pub ideal_paths: &'a [(Attachment, PointTrack)],
}

impl<'a> RecordedCycle<'a> {
    /// Motion of a body of the scene: as recorded, or as prescribed; empty for a fixed body.
    pub(crate) fn body(&self, body: usize) -> Cow<'a, BodyTrack> {
        if let Some(recorded) = self.islands.iter().find_map(|(island, recorder)| recorder.body(island, body))
        {
            return Cow::Borrowed(recorded);
        }
        let mut track = BodyTrack::default();
        if let Some(motion) = Prescribed::from_body(&self.scene.bodies[body]) {
            for t in sample_times(self.scene) {
                let [angle, omega, alpha, _] = motion.jet(t);
                track.push(t, angle, omega, alpha);
            }
        }
        Cow::Owned(track)
    }

    /// Path of a requested point, and its path on the mechanism with ideal joints.
    pub(crate) fn paths(&self, point: &Attachment) -> Option<(&'a PointTrack, &'a PointTrack)> {
        let recorded = self.islands.iter().find_map(|(_, recorder)| recorder.point(point));
        let ideal = self.ideal_paths.iter().find(|(place, _)| place == point).map(|(_, path)| path);
        recorded.zip(ideal)
    }

    /// Moments of the islands on a driven body of the scene.
    pub(super) fn moments(&self, body: usize) -> Vec<&'a MomentTrack> {
        self.islands.iter().filter_map(|(island, recorder)| recorder.moment(island, body)).collect()
    }

    /// Largest force of a joint of the scene over the cycle [N], if it was recorded.
    pub(crate) fn peak_force(&self, joint: usize) -> Option<f64> {
        self.islands.iter().find_map(|(island, recorder)| recorder.peak_force(island, joint))
    }
}
