//! The intervals of an arc in contact one after the other, those in contact from end to end in runs.
//!
//! # Source
//! Derived here, for the Winkler foundation of `foundation.rs` (Winkler 1867; Johnson 1985).

use super::arc::Arc;
use super::integrals::weights;
use super::segment::{GROUP, SEGMENT};
use crate::plane::dot;

/// What looks at the intervals of an arc in contact.
pub trait ArcVisitor {
    /// The intervals from `from` to before `to`, in contact from end to end; none if the two are equal.
    fn whole(&mut self, from: usize, to: usize);
    /// Interval `k`, of which only a part is in contact: the integral of g over it that belongs to each end `(2,)` [m], for an interval of
    /// length one, and the unit vectors there [1].
    fn end(&mut self, k: usize, parts: [f64; 2], directions: [[f64; 2]; 2]);
}

impl Arc {
    /// Shows `visitor` the intervals that are in contact at the eccentricity `e` [m], in their order.
    #[inline(always)]
    pub(crate) fn visit(&self, e: [f64; 2], visitor: &mut impl ArcVisitor) {
        let segments = &self.segments;
        // Intervals wholly in contact under way, across segments.
        let (mut from, mut to) = (0, 0);
        for g in 0..segments.groups.len() {
            let [mut rest, whole_segments] = segments.groups[g].touched(e, segments.widening, 0.0);
            while rest != 0 {
                let i = rest.trailing_zeros();
                rest &= rest - 1;
                let s = g * GROUP + i as usize;
                let segment = &segments.each[s];
                let positive = if (whole_segments >> i) & 1 == 1 { !0 } else { segment.positive(e, 0.0) };
                let mut reached = (positive | (positive >> 1)) & segment.all();
                while reached != 0 {
                    let k = reached.trailing_zeros();
                    let whole = (positive & (positive >> 1) & segment.all()) >> k;
                    let at = s * SEGMENT + k as usize;
                    if whole & 1 == 1 {
                        let length = whole.trailing_ones();
                        reached &= !(((1 << length) - 1) << k);
                        if to != at {
                            visitor.whole(from, to);
                            from = at;
                        }
                        to = at + length as usize;
                    } else {
                        reached &= reached - 1;
                        let ((u, a), (v, b)) = (segment.angle(k as usize), segment.angle(k as usize + 1));
                        let (first, _) = weights(dot(e, u) - a, dot(e, v) - b);
                        visitor.end(at, first, [u, v]);
                    }
                }
            }
        }
        visitor.whole(from, to);
    }
}
