//! Surface of a journal with its wear, which turns with the journal's body.
//!
//! R_j(chi) = R1 - h(chi) [m]: R1 the unworn radius, h the periodic cubic spline (`bore.rs`) through the wear
//! depths of control points at equal angles chi [rad] in the frame of the journal's body. With the angle
//! alpha = phi_journal - phi_bushing [rad] between the bodies, the place chi of the journal lies at the angle
//! psi = chi + alpha in the bushing's frame, and what a contact law of e and psi takes for the bore is there
//!
//!   R(psi) + h(psi - alpha),
//!
//! with the worn bore R [m]: the unworn journal in it leaves the gap of the two worn surfaces.
//!
//! # Source
//! The turning profile is derived here. Wear of revolute joints in multibody systems: Mukras, Kim, Mauntler,
//! Schmitz, Sawyer (2010), Wear 268, 643-652. Splines: de Boor (1978), A Practical Guide to Splines.

use super::journal_table::JournalTable;
use crate::bore::{Profile, Radius};
use crate::lanes::Real;
use std::f64::consts::TAU;

/// Surface of a journal that wears.
#[derive(Debug, Clone, PartialEq)]
pub struct Journal {
    /// Unworn radius R1 [m].
    pub(crate) unworn: f64,
    /// Depth h, as the radius of a profile whose unworn radius is zero.
    pub(crate) worn: Profile,
    /// Depth at the angles of the elastic foundation, for a law that has one.
    pub(super) table: Option<JournalTable>,
}

/// The two surfaces of a joint.
#[derive(Debug, Clone, Copy)]
pub struct Surfaces<'a> {
    /// The bore, worn so far.
    pub bore: &'a Profile,
    /// The journal, worn so far; `None` if it stays round.
    pub journal: Option<&'a Journal>,
}

impl<'a> From<&'a Profile> for Surfaces<'a> {
    fn from(bore: &'a Profile) -> Self {
        Surfaces { bore, journal: None }
    }
}

impl Journal {
    /// An unworn journal of radius `radius` [m] with `points` control points, tabulated at `intervals` equal intervals for an elastic
    /// foundation of as many.
    pub(super) fn new(radius: f64, points: usize, intervals: Option<usize>) -> Self {
        let table = intervals.map(|intervals| JournalTable::new(points, intervals));
        Journal { unworn: radius, worn: Profile::round(0.0, points), table }
    }

    /// Replaces the wear depths at the control points by `depth` `(points,)` [m].
    pub fn set_depth(&mut self, depth: &[f64]) {
        self.worn.set_depth(depth);
        if let Some(table) = &mut self.table {
            table.tabulate(&self.worn);
        }
    }

    /// Radius R_j and its derivatives at the angle `chi` [rad] in the frame of the journal's body.
    #[inline(always)]
    pub fn radius_at(&self, chi: f64) -> Radius {
        worn_radius(self.unworn, self.worn.radius_at(within_a_turn(chi)))
    }
}

/// Radius R1 - h of a journal with the unworn radius R1 `radius` [m], from the depth h.
#[inline(always)]
pub(super) fn worn_radius<R: Real>(radius: R, depth: Radius<R>) -> Radius<R> {
    Radius { r: radius - depth.r, d1: -depth.d1, d2: -depth.d2 }
}

/// An angle without its whole turns, within half a turn of zero [rad].
#[inline(always)]
pub(super) fn within_a_turn<R: Real>(angle: R) -> R {
    angle.minus_product((angle * (1.0 / TAU)).round(), angle.like(TAU))
}
