//! Generalised force of a load, and what each kind of load defines.
//!
//! # Size
//! Size of a load: constant, or by a table over time or over the angle of a frame.

use crate::lanes::{Lanewise, Real};
use crate::mechanism::frame::Frame;
use crate::mechanism::island_frames::IslandFrames;
use crate::mechanism::joint::{Block, Blocks};
use crate::mechanism::piecewise_cubic::PiecewiseCubic;
use common::scene::{Curve, Over};

/// Index in place of the second frame of a load that acts on one frame only.
pub const NO_FRAME: usize = usize::MAX;

/// Generalised force of a load at one instant on two frames, each (x, y, angle).
#[derive(Debug, Clone, Copy)]
pub struct LoadForce<R = f64> {
    /// The frames; the second is [`NO_FRAME`] if there is only one.
    pub frames: [usize; 2],
    /// Generalised force `(6,)` [N, N m].
    pub f: [R; 6],
    /// Derivative to the coordinates `(6, 6)`.
    pub k: [[R; 6]; 6],
    /// Derivative to their rates `(6, 6)`.
    pub d: [[R; 6]; 6],
    /// Derivative to time `(6,)`.
    pub ft: [R; 6],
    /// Index of another frame whose angle the load depends on, and the derivative to that angle `(6,)`.
    pub third: Option<(usize, [R; 6])>,
    /// Stored energy [J].
    pub stored: R,
    /// Dissipated power [W].
    pub lost: R,
}

impl<R: Real> LoadForce<R> {
    /// No force on these frames; `like` sets the number of lanes.
    #[inline(always)]
    pub(crate) fn none(frames: [usize; 2], like: R) -> Self {
        let zero = like.zero();
        LoadForce {
            frames,
            f: [zero; 6],
            k: [[zero; 6]; 6],
            d: [[zero; 6]; 6],
            ft: [zero; 6],
            third: None,
            stored: zero,
            lost: zero,
        }
    }
}

impl<R: Real> Blocks<R> for LoadForce<R> {
    #[inline(always)]
    fn block<const ON: usize, const TO: usize>(&self) -> Block<R> {
        let mut block = [[[self.stored.zero(); 3]; 3]; 2];
        for (block, rows) in block.iter_mut().zip([&self.k, &self.d]) {
            for r in 0..3 {
                for c in 0..3 {
                    block[r][c] = rows[3 * ON + r][3 * TO + c];
                }
            }
        }
        block
    }
}

/// Each number of `x` times `factor`.
#[inline(always)]
pub(crate) fn times<R: Real>(x: &[R; 6], factor: R) -> [R; 6] {
    let mut out = *x;
    for y in &mut out {
        *y = *y * factor;
    }
    out
}

/// Size of a load.
#[derive(Debug, Clone)]
pub enum Size<R = f64> {
    /// A size that does not vary.
    Constant(R),
    /// A table over time, one per lane.
    OverTime(Vec<PiecewiseCubic>),
    /// A table over the angle of a frame, one per lane, and the index of that frame.
    OverAngle(Vec<PiecewiseCubic>, usize),
}

impl Size {
    /// Size by a table of a scene, monotone between its points.
    pub(crate) fn new(curve: &Curve, frames: &mut IslandFrames) -> Self {
        let table = PiecewiseCubic::monotone(&curve.table);
        match curve.over {
            Over::Time => Size::OverTime(vec![table]),
            Over::Angle(body) => Size::OverAngle(vec![table], frames.frame(body)),
        }
    }
}

impl<R: Real> Size<R> {
    /// Value of the size, its derivative to time, and the index of a frame with the derivative to its angle.
    #[inline(always)]
    pub(crate) fn evaluate(&self, t: R, frames: &[Frame<R>]) -> (R, R, Option<(usize, R)>) {
        match self {
            Size::Constant(size) => (*size, t.zero(), None),
            Size::OverTime(tables) => {
                let (size, rate) = read(tables, t);
                (size, rate, None)
            }
            Size::OverAngle(tables, frame) => {
                let (size, slope) = read(tables, frames[*frame].angle);
                (size, t.zero(), Some((*frame, slope)))
            }
        }
    }

    /// The frames that a load of this size on `frame` couples.
    pub(crate) fn frames(&self, frame: usize) -> Vec<usize> {
        match self {
            Size::OverAngle(_, other) => vec![frame, *other],
            _ => vec![frame],
        }
    }
}

/// Value and slope at `x`, from a table per lane.
#[inline(always)]
fn read<R: Real>(tables: &[PiecewiseCubic], x: R) -> (R, R) {
    let (mut value, mut slope) = (x, x);
    for (lane, table) in tables.iter().enumerate() {
        let [y, d, ..] = table.jet(x.lane(lane));
        value.set_lane(lane, y);
        slope.set_lane(lane, d);
    }
    (value, slope)
}

impl Lanewise for Size {
    type Lanes<R: Real> = Size<R>;
    fn in_lanes<R: Real>(&self, like: R) -> Size<R> {
        let in_every_lane = |tables: &[PiecewiseCubic]| vec![tables[0].clone(); R::LANES];
        match self {
            Size::Constant(size) => Size::Constant(size.in_lanes(like)),
            Size::OverTime(tables) => Size::OverTime(in_every_lane(tables)),
            Size::OverAngle(tables, frame) => Size::OverAngle(in_every_lane(tables), *frame),
        }
    }
    fn write_lane<R: Real>(&self, lane: usize, to: &mut Size<R>) {
        match (self, to) {
            (Size::Constant(from), Size::Constant(to)) => from.write_lane::<R>(lane, to),
            (Size::OverTime(from), Size::OverTime(to)) => to[lane].clone_from(&from[0]),
            (Size::OverAngle(from, _), Size::OverAngle(to, _)) => to[lane].clone_from(&from[0]),
            _ => {}
        }
    }
    fn has_same_topology(&self, other: &Self) -> bool {
        match (self, other) {
            (Size::OverAngle(_, a), Size::OverAngle(_, b)) => a == b,
            _ => std::mem::discriminant(self) == std::mem::discriminant(other),
        }
    }
}
