//! Generalised force of a load, and what each kind of load defines.

// In lanes, closures of iterators are not compiled for the instruction set of the loop around them.
#![allow(clippy::needless_range_loop)]

use crate::lanes::Real;
use crate::mechanism::joint::{Block, Blocks};

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
