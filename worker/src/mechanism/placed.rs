//! State of an island's bodies at one instant, as its ideal joints need it.

use super::constraint::Constraint;
use super::frame::Frame;
use super::piecewise_cubic::Jet;
use crate::lanes::Real;

/// State of an island's bodies, free ones first.
#[derive(Clone, Copy)]
pub struct Placed<'a, R = f64> {
    /// Frames of the free bodies, then of the prescribed ones.
    pub frames: &'a [Frame<R>],
    /// Angle and derivatives of the prescribed bodies.
    pub jets: &'a [Jet<R>],
}

impl<'a, R: Real> Placed<'a, R> {
    /// Angle and derivatives of the prescribed body of frame `index`; `None` for a free body.
    #[inline(always)]
    pub(super) fn jet(&self, index: usize) -> Option<&'a Jet<R>> {
        let free = self.frames.len() - self.jets.len();
        if index < free { None } else { Some(&self.jets[index - free]) }
    }

    /// Frames of the two bodies that a constraint joins.
    #[inline(always)]
    pub(super) fn pair(&self, c: &Constraint<R>) -> [&'a Frame<R>; 2] {
        [&self.frames[c.ends[0].frame], &self.frames[c.ends[1].frame]]
    }
}
