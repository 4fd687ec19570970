//! Parts of a step that are separate functions in lanes, see [`Real::apart`]: what a round does more than once, so that it is
//! compiled once, and what would make the round one function whose compilation takes minutes.

use super::closing::close;
use super::elimination::Elimination;
use super::frame::Placed;
use super::lanes::IslandLanes;
use crate::integrate::Linearised;
use crate::lanes::{Real, Vectorised};

/// Implements [`Vectorised`] for the arguments of a method that is to be called `apart`.
macro_rules! separate {
    ($(($($name:ident: $argument:ty),+) -> $output:ty { $result:expr })+) => { $(
        impl<R: Real> Vectorised for ($($argument),+) {
            type Output = $output;

            #[inline(always)]
            fn run(self) -> $output {
                let ($($name),+) = self;
                $result
            }
        }
    )+ };
}

separate! {
    (lanes: &mut IslandLanes<R>, t: R, state: [&[R]; 2], f: &mut [R]) -> () { lanes.add_forces(t, state, f) }
    (lanes: &mut IslandLanes<R>, t: R, state: [&[R]; 2], at: &mut Linearised<R>) -> () { lanes.add_derivatives(t, state, at) }
    (lanes: &mut IslandLanes<R>, t: R, wanted: R, state: [&mut [R]; 2]) -> [R; 2] {
        { let [q, v] = state; close(lanes, t, wanted, q, v) }
    }
    (ideal: &mut Elimination<R>, at: Placed<'_, R>) -> R { ideal.factor_rows(at) }
    (ideal: &mut Elimination<R>, at: Placed<'_, R>, f: &mut [R]) -> [R; 2] { ideal.balance(at, f) }
    (ideal: &mut Elimination<R>, at: Placed<'_, R>, f: &[R], rates: bool) -> () { ideal.derive_constraints(at, f, rates) }
    (ideal: &mut Elimination<R>, at: Placed<'_, R>, x: &mut [R], columns: usize) -> () {
        ideal.reduce::<false>(at, x, columns)
    }
}
