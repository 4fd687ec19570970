//! Shares of contacts with a worn journal per angle of the table, of the bore and of the journal.
//!
//! With the journal turned by the fraction f of an interval, an angle of the bore's table lies between two angles of the journal's table: the
//! shares 1 - f and f are added there. Hat functions of control points, which are angles of the table, are linear in between: this is exact.
//!
//! # Source
//! Derived here.

// Compiled for the instructions of the processor, where closures of iterators are not: plain loops.
#![allow(clippy::needless_range_loop)]

use crate::contact::SegmentParts;

/// Sums over samples, per angle of the table.
#[derive(Debug, Clone, Default)]
pub struct IntervalLoads {
    /// Number of intervals of a turn.
    intervals: usize,
    /// Angles of the bore counted over one turn and a segment more, of the journal over two [N m].
    bore: Vec<f64>,
    journal: Vec<f64>,
}

impl IntervalLoads {
    /// Empties the sums, for tables with `intervals` in a turn.
    pub(super) fn clear(&mut self, intervals: usize) {
        self.intervals = intervals;
        let more = SegmentParts::ANGLES + 1;
        for (sums, turns) in [(&mut self.bore, 1), (&mut self.journal, 2)] {
            sums.clear();
            sums.resize(turns * intervals + more, 0.0);
        }
    }

    /// Adds `scale` times these parts, with the journal's interval `base` at the first angle of the bore and the fraction `f` there.
    #[inline(always)]
    pub(super) fn add(&mut self, parts: &[SegmentParts], (base, f): (usize, f64), scale: f64) {
        let (here, next) = (scale * (1.0 - f), scale * f);
        for of in parts {
            let bore = &mut self.bore[of.first..of.first + SegmentParts::ANGLES];
            for i in 0..SegmentParts::ANGLES {
                bore[i] += scale * of.part[i];
            }
            let first = base + of.first;
            let journal = &mut self.journal[first..first + SegmentParts::ANGLES + 1];
            for i in 0..SegmentParts::ANGLES {
                journal[i] += here * of.part[i];
            }
            for i in 0..SegmentParts::ANGLES {
                journal[i + 1] += next * of.part[i];
            }
        }
    }

    /// Adds the sums to the control points of the bore and then those of the journal, whose number divides that of the intervals.
    pub(super) fn share_out(&self, to: &mut [f64]) {
        let (bore, journal) = to.split_at_mut(to.len() / 2);
        for (points, sums) in [(bore, &self.bore), (journal, &self.journal)] {
            let (n, between) = (points.len(), self.intervals / points.len());
            for (k, amount) in sums.iter().enumerate() {
                let (i, s) = ((k / between) % n, (k % between) as f64 / between as f64);
                points[i] += amount * (1.0 - s);
                points[if i + 1 == n { 0 } else { i + 1 }] += amount * s;
            }
        }
    }
}
