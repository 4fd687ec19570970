//! The recorded motion of one cycle, as the outputs read it.

use super::peaks::{ImpactCount, Peaks};
use super::{BodyTrack, MomentTrack, PointTrack, Recorder};
use crate::mechanism::{Influence, Island, Prescribed};
use common::scene::{Attachment, OutputKind, Scene};
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
    /// Requested motion of the mechanism with ideal joints.
    pub ideal: &'a IdealTracks,
}

/// Motion of the mechanism with ideal joints over one cycle, as far as outputs need it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct IdealTracks {
    /// Requested points with their paths.
    pub paths: Vec<(Attachment, PointTrack)>,
    /// Requested bodies of the scene with their angles; accelerations are zero.
    pub angles: Vec<(usize, BodyTrack)>,
    /// Requested backlashes with the influence of the joints in the positions of each.
    pub influences: Vec<(OutputKind, Vec<Influence>)>,
}

impl IdealTracks {
    /// Influence of the joints on a requested backlash, in every position that counts.
    pub(super) fn influences(&self, sought: &OutputKind) -> &[Influence] {
        self.influences.iter().find(|(of, _)| of == sought).map_or(&[], |(_, found)| found)
    }
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
                track.push(t, [angle, omega, alpha]);
            }
        }
        Cow::Owned(track)
    }

    /// Path of a requested point.
    pub(crate) fn path(&self, point: &Attachment) -> Option<&'a PointTrack> {
        self.islands.iter().find_map(|(_, recorder)| recorder.point(point))
    }

    /// Path of a requested point on the mechanism with ideal joints.
    pub(crate) fn ideal_path(&self, point: &Attachment) -> Option<&'a PointTrack> {
        self.ideal.paths.iter().find(|(place, _)| place == point).map(|(_, path)| path)
    }

    /// Angle of a requested body on the mechanism with ideal joints.
    pub(crate) fn ideal_angle(&self, body: usize) -> Option<&'a BodyTrack> {
        self.ideal.angles.iter().find(|(of, _)| *of == body).map(|(_, track)| track)
    }

    /// What the largest values of an island that has it hold, zero if none was recorded [SI].
    pub(crate) fn peak(&self, of: impl Fn(&Peaks) -> Option<f64>) -> f64 {
        self.islands.iter().find_map(|(_, recorder)| of(&recorder.peaks)).unwrap_or(0.0)
    }

    /// Impacts of each of these joints of the scene over the cycle, as far as they were recorded.
    pub(crate) fn impacts(&self, joints: &[usize]) -> impl Iterator<Item = ImpactCount> {
        let of_joint = |joint: &usize| {
            self.islands.iter().find_map(|(island, recorder)| recorder.peaks.impacts(island, *joint))
        };
        joints.iter().filter_map(of_joint)
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
