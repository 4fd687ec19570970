//! What a guide with clearance does at one instant: forces on its faces, overlaps of its pads, energy. `mechanism/guide.rs` has its equations.

use crate::lanes::{Real, in_lane};

/// Pads of a guide: halves of the two faces of its slider.
pub const PADS: usize = 4;

/// What a guide does at one instant.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct GuideReaction<R = f64> {
    /// Normal force on each face of the guide, left and right of its axis `(2,)` [N].
    pub normal: [R; 2],
    /// Friction on the slider along the axis at each face `(2,)` [N].
    pub friction: [R; 2],
    /// Largest overlap of each pad, negative in free flight `(4,)` [m].
    pub penetration: [R; PADS],
    /// Rate of that overlap `(4,)` [m/s].
    pub approach: [R; PADS],
    /// Length by which the slider stands out of the guide, negative inside [m].
    pub beyond: R,
    /// Moment of the normal forces on each face about the slider's middle, from their distances along the slider; zero unless the guide
    /// wears `(2,)` [N m].
    pub moment: [R; 2],
    /// Power of sliding at each face, the sum of P |ds/dt|; zero unless the guide wears `(2,)` [W].
    pub rubbing: [R; 2],
    /// Position of the slider's middle along the guide; zero unless the guide wears [m].
    pub position: R,
    /// Energy of the foundation [J].
    pub stored: R,
    /// Power lost to friction and damping [W].
    pub lost: R,
}

in_lane!(GuideReaction {
    normal,
    friction,
    penetration,
    approach,
    beyond,
    moment,
    rubbing,
    position,
    stored,
    lost
});

impl GuideReaction {
    /// Sum of the sizes of the forces on the two faces [N].
    pub(crate) fn force(&self) -> f64 {
        (0..2).map(|face| libm::hypot(self.normal[face], self.friction[face])).sum()
    }
}

impl<R: Real> GuideReaction<R> {
    /// No force; `like` sets the number of lanes.
    #[inline(always)]
    pub(crate) fn none(like: R) -> Self {
        let zero = like.zero();
        GuideReaction {
            normal: [zero; 2],
            friction: [zero; 2],
            penetration: [zero; PADS],
            approach: [zero; PADS],
            beyond: zero,
            moment: [zero; 2],
            rubbing: [zero; 2],
            position: zero,
            stored: zero,
            lost: zero,
        }
    }

    /// Largest overlap of all pads [m].
    #[inline(always)]
    pub(crate) fn deepest(&self) -> R {
        let [a, b, c, d] = self.penetration;
        a.larger(b).larger(c.larger(d))
    }
}
