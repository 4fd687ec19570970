//! Wear under `local-hertz`: each contact sample wears its contact arc evenly on the present bore, shared out
//! over the control points so that the worn volume is Archard's.
//!
//! Share of control point i: q_i = sum F S w_i / R [N], with the work F S [N m] of a sample and the mean
//! radius R [m] of the worn bore along its arc AB (Simpson's rule over the angle). w_i is the mean over the arc
//! of the hat function phi_i [1], which is 1 at point i and falls to 0 at its neighbours: the w_i of a sample
//! sum to 1 for every arc, wherever it lies between the points. `archard.rs` multiplies by K_H / (L spacing).
//! An arc many spacings long gives F S / |AB| to every point inside, as the published rule does; a narrow one
//! is smeared over the points next to it, whose depth then falls short of that in the middle of the arc
//! (`finer_bore.rs` estimates that error).
//!
//! By the published rule (`points-inside`) every control point inside the arc, its ends included, has q_i = F S / (R |AB|) with the arc's
//! length |AB| in spacings, the others nothing: the sum is F S / R times the number of points inside over |AB|, and zero for an arc between two
//! points.
//!
//! A journal that wears has its shares of the same arc, at its own control points: turned back by the angle of its body from the
//! bushing's, and with its own mean radius along the arc.
//!
//! # Source
//! Cui et al., China Mechanical Engineering 37(6), 2026, 1472-1485, doi 10.3969/j.issn.1004-132X.2026.06.020:
//! the arc AB wears evenly by K_H F S / (|AB| L), at the control points inside it. The shares by hat functions
//! are chosen here: the published rule gives an arc between two points no wear at all.

use super::arc_ends::{ArcEnds, ContactDirection, ContactState, WORD};
use super::interval::ContactSample;
use crate::bore::{Profile, Radius};
use crate::contact::{Contact, Journal};
use crate::lanes::{InLanes, Real, in_widest_lanes};
use common::scene::WearDistribution;
use std::f64::consts::TAU;

/// Contacts of a frozen history on a bore.
///
/// The direction of the eccentricity and the penetration stay as they were, so that a sample's angle is found
/// once for all stages of a wear step.
#[derive(Debug, Clone)]
pub struct LocalArcs {
    ends: ArcEnds,
    pub(crate) distribution: WearDistribution,
    samples: Vec<Sample>,
    /// Shares on three turns, one before and one after the bore's own `(3 points,)`: there
    /// an arc is one piece; then those of the journal, if that wears.
    unrolled: Vec<f64>,
    /// Further patches of the contact at hand, from its direction on `(2,)` each, in spacings of the control points.
    further: Vec<[f64; 2]>,
    /// The journal, if it wears.
    journal: Option<Journal>,
}

/// The parts of a contact sample that the wear law uses.
#[derive(Debug, Clone, Copy)]
struct Sample {
    spot: ContactDirection,
    /// Interval between control points that contains the contact.
    interval: u32,
    /// Penetration delta [m].
    penetration: f64,
    /// Work F S [N m].
    work: f64,
    /// Place of the contact on the journal in table intervals, in [0, n).
    on_journal: f64,
}

impl LocalArcs {
    /// Without samples, for a joint with this contact law and `points` control points of its bore, and as many of its journal if that
    /// `wears`.
    pub(crate) fn new(contact: &Contact, points: usize, wears: bool) -> Self {
        LocalArcs {
            ends: ArcEnds::new(contact.surface().journal_radius, points, wears),
            distribution: WearDistribution::HatShares,
            samples: Vec::new(),
            unrolled: vec![0.0; if wears { 6 * points } else { 3 * points }],
            further: Vec::new(),
            journal: wears.then(|| contact.new_journal(points)),
        }
    }

    /// Replaces the history by the samples of a cycle.
    pub(crate) fn freeze(&mut self, samples: &[ContactSample]) {
        let n = self.ends.intervals();
        let points = self.unrolled.len() / if self.journal.is_some() { 6 } else { 3 };
        let per_point = points as f64 / n as f64;
        let sample = |s: &ContactSample| {
            let spot = ContactDirection::new(s.e, n);
            let interval = spot.interval(points, per_point);
            let on_journal = (spot.place - s.turn * (n as f64 / TAU)).rem_euclid(n as f64);
            // A place just below zero is rounded to a whole turn.
            let on_journal = if on_journal < n as f64 { on_journal } else { 0.0 };
            Sample { spot, interval, penetration: s.penetration, work: s.work, on_journal }
        };
        self.samples = samples.iter().map(sample).collect();
    }

    /// Forgets the history.
    pub(crate) fn release(&mut self) {
        self.samples = Vec::new();
    }

    /// Sum over the samples of work per radius, shared out over the control points: F S w_i / R `(points,)` [N], of the bore and then
    /// of a journal that wears, whose depths are `of_journal` [m].
    pub(crate) fn shares(&mut self, profile: &Profile, of_journal: &[f64], shares: &mut [f64]) {
        self.ends.profile_changed(profile);
        if let Some(journal) = &mut self.journal {
            journal.set_depth(of_journal);
            self.ends.journal_changed(&journal.worn);
        }
        self.unrolled.fill(0.0);
        in_widest_lanes((&mut *self, profile));
        let points = profile.points();
        for (shares, turns) in shares.chunks_mut(points).zip(self.unrolled.chunks(3 * points)) {
            let (first, rest) = turns.split_at(points);
            let (second, third) = rest.split_at(points);
            for (i, sum) in shares.iter_mut().enumerate() {
                *sum = first[i] + second[i] + third[i];
            }
        }
    }
}

/// Samples for which each part of the work is done before the next one: while one waits for a division, another goes on.
const AT_ONCE: usize = 16;

/// Adds the shares of all samples on a bore.
impl InLanes for (&mut LocalArcs, &Profile) {
    #[inline(always)]
    fn run<R: Real>(self, like: R) {
        let (arcs, profile) = self;
        match (arcs.distribution, arcs.journal.is_some()) {
            (WearDistribution::HatShares, false) => arcs.share::<R, false, false>(profile, like),
            (WearDistribution::HatShares, true) => arcs.share::<R, true, false>(profile, like),
            (WearDistribution::PointsInside, false) => arcs.share::<R, false, true>(profile, like),
            (WearDistribution::PointsInside, true) => arcs.share::<R, true, true>(profile, like),
        }
    }
}

impl LocalArcs {
    /// `WORN` if the journal wears, to the points `INSIDE` the arc or by hat functions: compiled for each, since the cases within the loop take a third of the time.
    #[inline(always)]
    fn share<R: Real, const WORN: bool, const INSIDE: bool>(&mut self, profile: &Profile, like: R) {
        let LocalArcs { ends, samples, unrolled, further, journal, .. } = self;
        let journal = if WORN { journal.as_ref() } else { None };
        let (unrolled, of_journal) = unrolled.split_at_mut(3 * profile.points());
        let turn = profile.points() as f64;
        let per_point = profile.points() as f64 / ends.intervals() as f64;
        let radius_of_journal = |journal: &Journal, [start, end]: [f64; 2], middle: f64| {
            let worn = |x: f64| journal.worn.turned(x);
            journal.unworn - (worn(start) + 4.0 * middle + worn(end)) / 6.0
        };
        let mut beyond = [0.0; WORD];
        for samples in samples.chunks(AT_ONCE) {
            let mut contacts = [ContactState::default(); AT_ONCE];
            let mut bores = [0.0; AT_ONCE];
            for ((contact, bore), sample) in contacts.iter_mut().zip(&mut bores).zip(samples) {
                let Sample { spot, interval, penetration, on_journal, .. } = *sample;
                let fraction = spot.place * per_point - f64::from(interval);
                let Radius { r, d1, .. } = profile.within(interval as usize, fraction);
                let depth = journal.map(|journal| {
                    let place = on_journal * per_point;
                    let at = (place as usize).min(profile.points() - 1);
                    journal.worn.within(at, place - at as f64)
                });
                let (radius, slope) = depth.map_or((r, d1), |depth| (r + depth.r, d1 + depth.d1));
                let on_journal = journal.map(|_| on_journal);
                *bore = r;
                *contact = ContactState { spot, penetration, radius, slope, on_journal };
            }
            let mut only_ends = [[None; 2]; AT_ONCE];
            for (only, contact) in only_ends.iter_mut().zip(&contacts[..samples.len()]) {
                *only = ends.only_ends(contact, like, &mut beyond);
            }
            let mut arcs = [([ArcEnd::default(); 2], 0.0); AT_ONCE];
            for (k, sample) in samples.iter().enumerate() {
                let (contact, r, mut work) = (&contacts[k], bores[k], sample.work);
                let (place, middle) = (sample.on_journal * per_point, contact.spot.place * per_point);
                further.clear();
                let patch = |from: f64, to: f64| further.push([from * per_point, to * per_point]);
                let (before, after) = ends.find(contact, &only_ends[k], like, &mut beyond, patch);
                let (before, after) = (before * per_point, after * per_point);
                if !further.is_empty() {
                    // Each patch wears as deeply as the arc: its work is in proportion to its length.
                    let lengths = further.iter().map(|[from, to]| to - from).sum::<f64>() + (before + after);
                    let density = work / lengths;
                    work = density * (before + after);
                    for [from, to] in &*further {
                        let (start, end, between) = (middle + from, middle + to, middle + 0.5 * (from + to));
                        let at = |x: f64| profile.turned(x);
                        let mean = (at(start) + 4.0 * at(between) + at(end)) / 6.0;
                        share_out::<INSIDE>(
                            unrolled,
                            ArcEnd::both(turn + start, turn + end),
                            density * (to - from) / mean,
                        );
                        if let Some(journal) = journal {
                            let ends = [place + from, place + to];
                            let between = journal.worn.turned(place + 0.5 * (from + to));
                            let mean = radius_of_journal(journal, ends, between);
                            let places = ArcEnd::both(turn + ends[0], turn + ends[1]);
                            share_out::<INSIDE>(of_journal, places, density * (to - from) / mean);
                        }
                    }
                }
                if let Some(journal) = journal {
                    let ends = [place - before, place + after];
                    let mean = radius_of_journal(journal, ends, contact.radius - r);
                    share_out::<INSIDE>(
                        of_journal,
                        ArcEnd::both(turn + ends[0], turn + ends[1]),
                        work / mean,
                    );
                }
                arcs[k] = (ArcEnd::both(turn + (middle - before), turn + (middle + after)), work);
            }
            for ((ends, amount), r) in arcs[..samples.len()].iter_mut().zip(&bores) {
                // Mean radius along the arc, by Simpson's rule over its angle; then work per radius in the place of work.
                let at = |place: &ArcEnd| profile.turned_to(place.point, place.fraction);
                *amount /= (at(&ends[0]) + 4.0 * r + at(&ends[1])) / 6.0;
            }
            for (ends, amount) in &arcs[..samples.len()] {
                share_out::<INSIDE>(unrolled, *ends, *amount);
            }
        }
    }
}

/// An end of an arc, on three turns of a surface.
#[derive(Debug, Clone, Copy, Default)]
struct ArcEnd {
    /// Distance from the first point, in points, and the number of the point before.
    x: f64,
    point: usize,
    /// Fraction of the interval behind that point.
    fraction: f64,
}

impl ArcEnd {
    /// The end at the place `x` >= 0.
    #[inline(always)]
    fn new(x: f64) -> Self {
        let point = x as usize;
        ArcEnd { x, point, fraction: x - point as f64 }
    }

    /// The ends of an arc at the places `x` and `y`.
    #[inline(always)]
    fn both(x: f64, y: f64) -> [Self; 2] {
        [ArcEnd::new(x), ArcEnd::new(y)]
    }
}

/// Shares `amount` out over the points next to and inside an arc between two places: to each in proportion to the integral of its hat
/// function over the arc, or to all those `INSIDE` alike.
#[inline(always)]
fn share_out<const INSIDE: bool>(unrolled: &mut [f64], [start, end]: [ArcEnd; 2], amount: f64) {
    if INSIDE {
        let length = end.x - start.x;
        let first = start.point + usize::from(start.fraction > 0.0);
        if length > 0.0 && first <= end.point {
            unrolled[first..=end.point].iter_mut().for_each(|sum| *sum += amount / length);
        }
        return;
    }
    let (i, j, s, t) = (start.point, end.point, start.fraction, end.fraction);
    if i == j {
        // Between two points each has the hat function's value in the middle of the arc.
        let middle = 0.5 * (s + t);
        unrolled[i] += (1.0 - middle) * amount;
        unrolled[i + 1] += middle * amount;
        return;
    }
    let density = amount / (end.x - start.x);
    // Parts of the hat functions of i and i + 1 before the start, and of j and j + 1 behind the end.
    let (before, behind) = (0.5 * s * s, 0.5 * (1.0 - t) * (1.0 - t));
    unrolled[i] += 0.5 * (1.0 - s) * (1.0 - s) * density;
    unrolled[j + 1] += 0.5 * t * t * density;
    if j == i + 1 {
        unrolled[j] += (1.0 - before - behind) * density;
    } else {
        unrolled[i + 1] += (1.0 - before) * density;
        unrolled[i + 2..j].iter_mut().for_each(|sum| *sum += density);
        unrolled[j] += (1.0 - behind) * density;
    }
}
