//! Corners of a slider in its guide: where impacts of the slider are counted, and the mass behind them.
//!
//! A slider whose faces are flat touches with a corner before anything else. With the overlap g [m] of a corner and its gradient G `(6,)` to the coordinates of
//! both bodies (`guide.rs`), the corner approaches at dg/dt = G dq/dt [m/s], and the mass that resists an impulse along G is that of
//! `effective_mass.rs` with W = G. On worn faces the overlap is less by both depths; their slopes, small against one, are left out of G.
//!
//! # Source
//! As `guide.rs` and `effective_mass.rs`.

use super::frame::Frame;
use super::guide::{Guide, gradient};
use super::island::Island;
use super::wearing_guide::WearingGuide;
use crate::contact::PADS;
use crate::plane::dot;

/// A corner of a slider at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corner {
    /// Overlap with the face of the guide, negative in free flight [m].
    pub overlap: f64,
    /// Its rate [m/s].
    pub rate: f64,
    /// Gradient of the overlap to the coordinates of the slider's body, then of the guide's `(6,)` [1, m].
    pub gradient: [f64; 6],
}

impl Island {
    /// Corners of the slider of guide number `guide` in the state (`t`, `q`, `v`): the two of the left face, then those of the right `(4,)`.
    pub(crate) fn guide_corners(&self, guide: usize, t: f64, q: &[f64], v: &[f64]) -> [Corner; PADS] {
        let guide = &self.guides[guide];
        let [slider, rail] = guide.flat.ends.map(|end| self.frame_at(end.frame, t, q, v));
        guide.corners([&slider, &rail])
    }

    /// Effective mass of guide number `guide` against an impulse along `gradient` `(6,)` in the state (`t`, `q`, `v`) [kg]; zero if neither
    /// body can move, or if the constraints of the ideal joints are dependent there.
    pub(crate) fn guide_mass(&self, guide: usize, gradient: [f64; 6], t: f64, q: &[f64], v: &[f64]) -> f64 {
        let mut impulse = vec![0.0; self.coordinates()];
        for (end, part) in self.guides[guide].flat.ends.iter().zip(gradient.chunks(3)) {
            if end.frame < self.bodies.len() {
                impulse[3 * end.frame..].iter_mut().zip(part).for_each(|(sum, part)| *sum += part);
            }
        }
        self.mass_against(&impulse, t, q, v)
    }
}

impl WearingGuide {
    /// Corners of the slider with the bodies of slider and guide in `frames`.
    fn corners(&self, frames: [&Frame; 2]) -> [Corner; PADS] {
        let Guide { axis, ends, .. } = &self.flat;
        let t = frames[1].turn(*axis);
        let base = dot(*axis, ends[1].arm);
        std::array::from_fn(|corner| {
            let (face, last) = (corner / 2, corner % 2 == 1);
            let (n, points) = self.flat.face(face, t, frames);
            let at = &points[if last { 2 } else { 0 }];
            let (depth, slope) = self.corner_depth(face, last, dot(t, at.d) - base);
            Corner {
                overlap: at.overlap - depth,
                rate: at.rate - slope * at.sliding,
                gradient: gradient(n, at.a, at.d),
            }
        })
    }
}
