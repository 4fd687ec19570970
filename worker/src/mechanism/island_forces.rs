//! Forces of an island that is integrated by itself, and their derivatives.

use super::elimination::Existence;
use super::island::Island;
use super::placed::Placed;
use crate::integrate::{Dynamics, Linearised};
use crate::lanes::{Vectorised, fused};

impl Dynamics for Island {
    fn mass(&self) -> &[f64] {
        &self.mass
    }

    fn force(&mut self, t: f64, q: &[f64], v: &[f64], f: &mut [f64]) {
        fused(AtState { island: self, t, q, v, into: Evaluated::Force(f) });
    }

    fn linearise(&mut self, t: f64, q: &[f64], v: &[f64], at: &mut Linearised) {
        fused(AtState { island: self, t, q, v, into: Evaluated::Linearisation(at) });
        self.begin_step(t, q, v);
    }
}

/// Forces of an island in the state `q`, `v` `(n,)` at time `t` [s], compiled for the instructions of this processor once for all that
/// integrate islands by themselves.
struct AtState<'a> {
    island: &'a mut Island,
    t: f64,
    q: &'a [f64],
    v: &'a [f64],
    into: Evaluated<'a>,
}

enum Evaluated<'a> {
    /// Generalised forces with the reactions of ideal joints `(n,)` [N, N m].
    Force(&'a mut [f64]),
    /// These forces with their derivatives to positions, velocities and time.
    Linearisation(&'a mut Linearised),
}

impl Vectorised for AtState<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let AtState { island, t, q, v, into } = self;
        island.set_state(t, q, v);
        match into {
            Evaluated::Force(f) => island.add_forces(t, f),
            Evaluated::Linearisation(at) => island.add_derivatives(t, at),
        }
    }
}

impl Island {
    /// Forces in the state last set.
    #[inline(always)]
    fn add_forces(&mut self, t: f64, f: &mut [f64]) {
        let mut space = std::mem::take(&mut self.space);
        self.acting().applied::<false>(t, &mut space, f, &mut Linearised::default());
        self.space = space;
        let at = Placed { frames: &self.frames, jets: &self.jets };
        match self.passage.as_mut().filter(|passage| passage.is_projected()) {
            Some(passage) => {
                passage.joints.add_reactions(at, f);
            }
            None if self.ideal.rows() > 0 => {
                self.ideal.add_reactions(at, f);
            }
            None => {}
        }
    }

    /// Forces in the state last set, and their derivatives.
    #[inline(always)]
    fn add_derivatives(&mut self, t: f64, at: &mut Linearised) {
        let (mut f, mut space) = (std::mem::take(&mut at.f), std::mem::take(&mut self.space));
        self.acting().applied::<true>(t, &mut space, &mut f, at);
        (at.f, self.space) = (f, space);
        if self.is_large() {
            self.add_many_reactions(at);
        } else if self.ideal.rows() > 0 {
            let placed = Placed { frames: &self.frames, jets: &self.jets };
            let Existence { independent, balanced } = self.ideal.add_reactions(placed, &mut at.f);
            (at.independent, at.balanced) = (Some(independent), Some(balanced));
            self.ideal.reduce_derivatives(placed, at);
        }
    }
}
