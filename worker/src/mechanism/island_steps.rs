//! What the integration of an island by itself needs: its forces with their derivatives, closed joints, scales of errors, and the passage through positions in
//! which the ideal joints are dependent.

use super::closing::{close, least_gap};
use super::effective_mass::begun;
use super::extent::farthest;
use super::frame::{End, Placed};
use super::island::Island;
use super::passage::{Comparison, Passage, on_path};
use crate::extremum::{largest, smallest};
use crate::integrate::{Dynamics, Linearised, Passing, State, Stepped};
use crate::lanes::{Vectorised, fused};

/// Largest gap of a joint, over the size of the mechanism, in a position that a crossing motion reaches [1].
const CLOSED: f64 = 1e-8;
/// Most Newton steps before a joint counts as impossible to close.
const MOST_ITERATIONS: usize = 8;

impl Island {
    /// In an island of many ideal joints: adds their reactions to the applied forces in `at`.
    pub(super) fn add_many_reactions(&mut self, at: &mut Linearised) {
        let placed = Placed { frames: &self.frames, jets: &self.jets };
        let Some(passage) = &mut self.passage else { return };
        let independent = passage.joints.add_reactions(placed, &mut at.f);
        (at.independent, at.balanced) = (Some(if independent { 1.0 } else { 0.0 }), Some(1.0));
        passage.joints.store_reactions(placed, at);
    }

    /// Begins a step in the state just linearised, which is (t, q, v): observes ideal joints that are nearly dependent, and looks for a
    /// position of dependence ahead.
    pub(super) fn begin_step(&mut self, t: f64, q: &[f64], v: &[f64]) {
        let Some(mut passage) = self.passage.take() else { return };
        // With the masses as weights a dependence is seen too, but light bodies give small shares anywhere.
        if !passage.is_large && self.ideal.factors.apart == 1.0 {
            passage.begin_apart();
        } else {
            passage.begin(self.placed(), self.size);
            let fastest = self.fastest();
            if passage.is_projected()
                && let Some(short) = passage.short_time(fastest)
            {
                let moved: Vec<f64> = q.iter().zip(v).map(|(q, v)| q + short * v).collect();
                self.set_state(t + short, &moved, v);
                passage.look_ahead((self.placed(), self.size), short, (farthest(q, self.size), fastest));
                self.set_state(t, q, v);
            }
        }
        self.passage = Some(passage);
    }

    /// Frames of the bodies at the state last set.
    fn placed(&self) -> Placed<'_> {
        Placed { frames: &self.frames, jets: &self.jets }
    }

    /// Angular velocity of the fastest body at the state last set [rad/s].
    fn fastest(&self) -> f64 {
        largest(self.frames.iter().map(|frame| frame.omega.abs()))
    }

    /// Closes the ideal joints at a stage of an explicit step: down to rounding, since near dependence a gap displaces the bodies by its
    /// size over the share of the most dependent row, and turns the directions along which velocities are projected by this displacement
    /// over the share once more.
    fn close_to_rounding(&mut self, t: f64, q: &mut [f64], v: &mut [f64]) -> Option<f64> {
        let enough = least_gap(q, self.size);
        let mut drift = None;
        for _ in 0..MOST_ITERATIONS {
            self.set_state(t, q, v);
            let at = Placed { frames: &self.frames, jets: &self.jets };
            let joints = &mut self.passage.as_mut()?.joints;
            let gap = joints.close_positions(at, self.size, q)?;
            drift.get_or_insert(gap);
            if gap <= enough {
                joints.close_velocities(at, v);
                return drift;
            }
        }
        None
    }

    /// How a step passes positions of dependence; see [`Stepped::passing`].
    fn compare_ends(&mut self, passage: &mut Passage, h: f64, from: State, to: State) -> Passing {
        self.set_state(to.time, to.q, to.v);
        let (fractions, is_crossing) = match passage.compare(self.placed(), self.size) {
            Comparison::Unclear => return Passing::Unclear,
            Comparison::Clear { near: false } => return Passing::Clear,
            Comparison::Clear { near: true } => (vec![0.25, 0.5, 0.75], false),
            Comparison::Crossing { fractions, slowest } => {
                if !Passage::is_transversal(slowest / h, self.fastest()) {
                    return Passing::Branching;
                }
                (fractions, true)
            }
        };
        let (Some(f0), Some(f1)) = (from.f, to.f) else { return Passing::Unclear };
        let smaller = passage.smaller_shares();
        let mut path = to.q.to_vec();
        for fraction in fractions {
            for (k, q) in path.iter_mut().enumerate() {
                let start = [from.q[k], from.v[k], f0[k] / self.mass[k]];
                let end = [to.q[k], to.v[k], f1[k] / self.mass[k]];
                *q = on_path(fraction, h, start, end);
            }
            self.set_state(from.time + fraction * h, &path, to.v);
            let at = self.placed();
            let is_regular = if is_crossing {
                passage.joints.largest_gap(at, self.size) <= CLOSED * self.size
            } else {
                !passage.finds_minimum_between(at, self.size, &smaller)
            };
            if !is_regular {
                return Passing::Unclear;
            }
        }
        if is_crossing { Passing::Through } else { Passing::Clear }
    }
}

impl Stepped for Island {
    fn is_constrained(&self) -> bool {
        self.ideal.rows > 0
    }

    fn begins_contacts(&self) -> bool {
        !self.guides.is_empty()
    }

    #[inline(always)]
    fn begun(&mut self, before: &Linearised, h: f64, t: f64, q: &[f64], v: &[f64]) -> f64 {
        self.set_state(t, q, v);
        begun(&self.guides, &self.frames, &before.guides, h, &self.mass, |k| 1.0 / self.scale_v[k])
    }

    fn close(&mut self, t: f64, q: &mut [f64], v: &mut [f64]) -> Option<f64> {
        if self.is_projected() {
            return self.close_to_rounding(t, q, v);
        }
        let [drift, closed] = fused((self, t, ByItself::Closing(q, v)));
        (closed == 1.0).then_some(drift)
    }

    fn is_projected(&self) -> bool {
        self.passage.as_ref().is_some_and(|passage| passage.is_projected())
    }

    fn step_length(&self, h: f64, is_first: bool) -> f64 {
        self.passage.as_ref().map_or(h, |passage| passage.step_length(h, is_first))
    }

    fn rounding(&self, h: f64) -> f64 {
        let slowest = smallest(self.scale_v.iter().step_by(3).copied());
        self.passage.as_ref().map_or(0.0, |passage| passage.rounding(h) / slowest)
    }

    fn passing(&mut self, h: f64, from: State, to: State) -> Passing {
        let Some(mut passage) = self.passage.take() else { return Passing::Clear };
        let passing =
            if passage.is_observing { self.compare_ends(&mut passage, h, from, to) } else { Passing::Clear };
        self.passage = Some(passage);
        passing
    }

    fn dependent_joint(&self) -> Option<usize> {
        self.passage.as_ref().and_then(|passage| passage.nearly_dependent())
    }

    fn scales(&self) -> (&[f64], &[f64]) {
        (&self.scale_q, &self.scale_v)
    }

    fn on_accepted(&mut self, _q: &[f64], _v: &[f64], at: &Linearised) {
        let places = self.space.pairs.iter().zip(&self.space.walls);
        for ((joint, (pair, wall)), now) in self.joints.iter_mut().zip(places).zip(&at.joints) {
            joint.follow_approach((&pair.place, wall), &pair.motion, now.penetration);
        }
        self.guides.iter_mut().zip(&at.guides).for_each(|(guide, now)| guide.flat.follow_approach(now));
    }

    fn locked_joint(&self) -> Option<usize> {
        self.ideal.friction.locked_constraint()
    }

    fn responsible_joint(&self, coordinate: usize, at: &Linearised) -> Option<usize> {
        let on = |end: End| end.frame == coordinate / 3;
        let normal = |k: usize| match k.checked_sub(self.joints.len()) {
            None => at.joints[k].normal,
            Some(guide) => at.guides[guide].normal[0] + at.guides[guide].normal[1],
        };
        let ends = self.joints.iter().map(|j| j.ends).chain(self.guides.iter().map(|g| g.flat.ends));
        ends.enumerate()
            .filter(|(_, ends)| ends.iter().any(|end| on(*end)))
            .map(|(k, _)| k)
            .max_by(|&a, &b| normal(a).total_cmp(&normal(b)))
    }

    fn in_range(&self, at: &Linearised) -> Result<(), (usize, f64)> {
        for (k, (penetration, deepest)) in at.penetrations().zip(self.deepest()).enumerate() {
            if penetration > deepest {
                return Err((k, penetration));
            }
        }
        Ok(())
    }
}

impl Dynamics for Island {
    fn mass(&self) -> &[f64] {
        &self.mass
    }

    fn force(&mut self, t: f64, q: &[f64], v: &[f64], f: &mut [f64]) {
        fused((self, t, ByItself::Force([q, v], f)));
    }

    fn linearise(&mut self, t: f64, q: &[f64], v: &[f64], at: &mut Linearised) {
        fused((&mut *self, t, ByItself::Linearisation([q, v], at)));
        self.begin_step(t, q, v);
    }
}

/// What is done with an island in the state `q`, `v` `(n,)` at a time [s], compiled for the instructions of this processor once for all that
/// integrate islands by themselves.
enum ByItself<'a> {
    /// Closes the ideal joints; the result is that of [`close`].
    Closing(&'a mut [f64], &'a mut [f64]),
    /// Generalised forces with the reactions of ideal joints `(n,)` [N, N m].
    Force([&'a [f64]; 2], &'a mut [f64]),
    /// These forces with their derivatives to positions, velocities and time.
    Linearisation([&'a [f64]; 2], &'a mut Linearised),
}

impl Vectorised for (&mut Island, f64, ByItself<'_>) {
    type Output = [f64; 2];

    #[inline(always)]
    fn run(self) -> [f64; 2] {
        let (island, t, work) = self;
        match work {
            ByItself::Closing(q, v) => return close(island, t, 1.0, q, v),
            ByItself::Force([q, v], f) => {
                island.set_state(t, q, v);
                island.add_forces(t, f);
            }
            ByItself::Linearisation([q, v], at) => {
                island.set_state(t, q, v);
                island.add_derivatives(t, at);
            }
        }
        [0.0; 2]
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
            None if self.ideal.rows > 0 => {
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
        } else if self.ideal.rows > 0 {
            let placed = Placed { frames: &self.frames, jets: &self.jets };
            let [independent, balanced] = self.ideal.add_reactions(placed, &mut at.f);
            (at.independent, at.balanced) = (Some(independent), Some(balanced));
            self.ideal.reduce_derivatives(placed, at);
        }
    }
}
