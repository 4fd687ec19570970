//! Contact law `hertz`: Hertz's force where the journal touches the bore, as the gradient of a potential.
//!
//! With the largest closing of the gap delta(e, alpha) [m] at the place theta of `touch.rs`, a function of the eccentricity e and of the angle alpha
//! of the journal's body from the bushing's, the potential is U = (2/5) K_n delta^2.5 [J], with the Hertz stiffness K_n [N/m^1.5]
//! (`stiffness.rs`). The elastic force on the journal is -dU/de = -K_n delta^1.5 u, along the normal u of the contact, and the normal force has
//! the moment R_j' F_N about the centre of a journal that is worn to R_j:
//!
//!   delta_dot = w.u + R' omega_j - R_j' omega_i,  F_N = K_n delta^1.5 max(0, 1 + D delta_dot),
//!   v_t = w.t + R_j omega_i - R omega_j,  F_T = mu F_N tanh(v_t / v_0),
//!   force on the journal -F_N u - F_T t,  torques -R_j F_T + R_j' F_N on the journal, R F_T - R' F_N on the bushing,
//!
//! with the tangent t, the worn bore R(theta), their derivatives R' and R_j' to the angle, the damping factor D [s/m], the friction coefficient mu [1] and
//! its regularisation speed v_0 [m/s]. The power is -F_N delta_dot - F_T v_t: the law stays conservative as the surfaces wear. On a round bore it is `local-hertz`.
//!
//! Where a groove is narrower than the journal, the edge that closes the gap further acts alone, and the force jumps from one edge to
//! the other as the journal passes between them, downhill in U on either side; two springs, one on each edge, would need a potential that has a step where
//! two places of contact join.
//!
//! # Source
//! Hertz's force with a contact normal to the surfaces: Lankarani, Nikravesh (1990), J. Mech. Design 112, 369-376; Johnson (1985), Contact
//! Mechanics, chapter 4. The potential on worn surfaces is derived here.

// Compiled into the loops of the lanes, where closures of iterators are not: plain loops.
#![allow(clippy::needless_range_loop)]

use super::joint_force::{ForceSlopes, JointForce, JointMotion};
use super::journal::Surfaces;
use super::law::{Elastic, Law, Pressure};
use super::local_hertz::PolarEccentricity;
use super::surface::Surface;
use super::touch::{Facing, Touch};
use super::touch_starts::Starts;
use super::touch_sweep::Sweep;
use crate::bore::{Bore, Profile};
use crate::lanes::Real;
use crate::plane::{fused_dot as dot, left};

/// Share of the clearance below which the curvature of the closing of the gap is not taken [1]: two places of contact join there.
const LEAST_CURVATURE: f64 = 1e-6;

/// The law with its constants, and where the search for the contact begins.
#[derive(Debug, Clone, PartialEq)]
pub struct Hertz<R = f64> {
    /// Constants of the joint.
    pub surface: Surface<R>,
    /// Starts on the bore, or on that of each lane.
    pub(super) starts: Starts,
    /// Angles searched if the journal wears.
    pub(super) sweep: Sweep,
}

impl<R: Real> Hertz<R> {
    /// Where the journal touches `bore` at this eccentricity; of a journal that wears the `depth`, turned by `turn` [rad].
    #[inline(always)]
    pub(super) fn touch<B: Bore<R>>(
        &self,
        (bore, depth): (&B, Option<&B>),
        e: &PolarEccentricity<R>,
        turn: R,
    ) -> Touch<R> {
        let Surface { journal_radius: radius, clearance, .. } = self.surface;
        Facing { bore, depth, radius, turn, clearance }.touch(e, &self.starts, &self.sweep)
    }

    /// delta_dot at this contact [m/s].
    #[inline(always)]
    fn rate(touch: &Touch<R>, motion: &JointMotion<R>) -> R {
        let walls = &touch.walls;
        let rate = dot(motion.w, touch.u).plus_product(walls.bore.d1, motion.omega_bushing);
        match walls.journal {
            None => rate,
            Some(journal) => rate.minus_product(journal.d1, motion.omega_journal),
        }
    }

    /// Rate of the penetration, delta_dot, at the eccentricity `e` [m/s]; in the middle of the bore, from where every direction leads to the
    /// wall, the speed.
    #[inline(always)]
    pub(super) fn approach(&self, e: &PolarEccentricity<R>, touch: &Touch<R>, motion: &JointMotion<R>) -> R {
        let speed = dot(motion.w, motion.w).sqrt();
        R::select(speed.zero().below(e.size), Self::rate(touch, motion), speed)
    }

    /// Force on the journal at the eccentricity `e`, where it touches at `touch`; with `JACOBIAN` its exact derivative, else no slopes. In free
    /// flight (delta <= 0), and where the contact lets go early (1 + D delta_dot <= 0), only the film acts.
    #[inline(always)]
    pub(crate) fn force<const JACOBIAN: bool>(
        &self,
        e: &PolarEccentricity<R>,
        touch: &Touch<R>,
        motion: &JointMotion<R>,
    ) -> (JointForce<R>, ForceSlopes<R>) {
        let s = &self.surface;
        let JointMotion { w, omega_journal, omega_bushing, .. } = *motion;
        let Touch { u, walls } = *touch;
        let nothing = u[0].zero();
        let one = nothing.like(1.0);
        let t = left(u);
        let gap = walls.gap(s.journal_radius);
        let reach = e.size * dot(e.u, u);
        let delta = reach - gap.r;
        let rate = Self::rate(touch, motion);
        let factor = one.plus_product(s.damping, rate);
        // NaN compares as no contact; the penetration keeps the NaN.
        let touches = R::both(nothing.below(delta), nothing.below(factor));
        let root = R::select(touches, delta, nothing).sqrt();
        let elastic = s.stiffness * root * root * root;
        let normal = elastic * factor;
        let bore = walls.bore;
        let radius = walls.journal.map_or(s.journal_radius, |journal| journal.r);
        let wt = dot(w, t);
        let sliding = wt.plus_product(omega_journal, radius).minus_product(omega_bushing, bore.r);
        let sliding = R::select(touches, sliding, nothing);
        let (mu, mu_v) = s.friction(sliding);
        let friction = mu * normal;
        let torque_journal = -(radius * friction);
        let mut out = JointForce {
            force: [
                -(normal * u[0]).plus_product(friction, t[0]),
                -(normal * u[1]).plus_product(friction, t[1]),
            ],
            torque_journal: walls
                .journal
                .map_or(torque_journal, |journal| torque_journal.plus_product(journal.d1, normal)),
            torque_bushing: (bore.r * friction).minus_product(bore.d1, normal),
            normal,
            direction: [R::select(touches, u[0], nothing), R::select(touches, u[1], nothing)],
            penetration: delta,
            sliding,
        };
        s.add_film(motion, &mut out);
        if !JACOBIAN {
            return (out, ForceSlopes::none(nothing));
        }
        // Derivatives to the penetration, its rate and the sliding speed, each of which is a row over the columns e along u, e along t, w along
        // u, w along t, omega_i, omega_j, alpha.
        let slope = s.stiffness * root * factor * 1.5;
        let (damped, grip) = (elastic * s.damping, mu_v * normal);
        let kappa = (reach + gap.d2).larger(s.clearance * LEAST_CURVATURE);
        let to_place = one / kappa;
        let bend = bore.d2;
        let (slope_j, bend_j) = walls.journal.map_or((nothing, nothing), |journal| (journal.d1, journal.d2));
        // The place in the bushing's frame moves with e along t and with alpha, that on the journal also falls behind.
        let place = [nothing, to_place, nothing, nothing, nothing, nothing, -(bend_j * to_place)];
        let on_journal = [nothing, to_place, nothing, nothing, nothing, nothing, place[6] - one];
        let turning = wt.plus_product(bend, omega_bushing).minus_product(bend_j, omega_journal);
        let d_delta = [one, nothing, nothing, nothing, nothing, nothing, -slope_j];
        let d_rate = [
            nothing,
            turning * place[1],
            one,
            nothing,
            -slope_j,
            bore.d1,
            (turning * place[6]).plus_product(bend_j, omega_journal),
        ];
        let d_sliding = [
            nothing,
            -(rate * place[1]),
            nothing,
            one,
            radius,
            -bore.r,
            -(rate * place[6]).plus_product(slope_j, omega_journal),
        ];
        let mut columns = [[nothing; 4]; 7];
        for c in 0..7 {
            let d_normal = (slope * d_delta[c]).plus_product(damped, d_rate[c]);
            let d_friction = (mu * d_normal).plus_product(grip, d_sliding[c]);
            let (moved, behind) = (place[c], on_journal[c]);
            columns[c] = [
                (friction * moved) - d_normal,
                -d_friction.plus_product(normal, moved),
                (slope_j * d_normal)
                    .minus_product(radius, d_friction)
                    .plus_product((bend_j * normal).minus_product(slope_j, friction), behind),
                (bore.r * d_friction)
                    .minus_product(bore.d1, d_normal)
                    .plus_product((bore.d1 * friction).minus_product(bend, normal), moved),
            ];
        }
        let mut rows = [[nothing; 6]; 4];
        for c in 0..6 {
            for r in 0..4 {
                rows[r][c] = columns[c][r];
            }
        }
        let to_turn = walls.journal.map(|_| columns[6]);
        let mut slopes = ForceSlopes { u, rows, to_turn };
        s.add_film_slopes(&mut slopes);
        (out, slopes)
    }
}

impl Hertz {
    /// Place and contact at this motion.
    #[inline(always)]
    fn found(
        &self,
        Surfaces { bore, journal }: Surfaces,
        motion: &JointMotion,
    ) -> (PolarEccentricity<f64>, Touch<f64>) {
        let e = PolarEccentricity::new(motion.e);
        let touch = self.touch((bore, journal.map(|journal| journal.worn())), &e, motion.turn);
        (e, touch)
    }
}

impl Law for Hertz {
    fn new(surface: Surface, control_points: usize) -> Self {
        Hertz { surface, starts: Starts::round(), sweep: Sweep::new(control_points) }
    }

    fn surface(&self) -> &Surface {
        &self.surface
    }

    fn surface_mut(&mut self) -> &mut Surface {
        &mut self.surface
    }

    fn profile_changed(&mut self, profile: &Profile) {
        self.starts.profile_changed(profile, self.surface.journal_radius);
    }

    fn pressure(&self) -> Pressure {
        Pressure::UniformAboutNormal
    }

    #[inline(always)]
    fn force<const JACOBIAN: bool>(
        &self,
        surfaces: Surfaces,
        motion: &JointMotion,
    ) -> (JointForce, ForceSlopes) {
        let (e, touch) = self.found(surfaces, motion);
        Hertz::force::<JACOBIAN>(self, &e, &touch, motion)
    }

    fn elastic(&self, surfaces: Surfaces, motion: &JointMotion) -> Elastic {
        let (e, touch) = self.found(surfaces, motion);
        let delta = e.size * dot(e.u, touch.u) - touch.walls.gap(self.surface.journal_radius).r;
        if delta <= 0.0 {
            return Elastic::default();
        }
        let force = self.surface.stiffness * delta * delta.sqrt();
        Elastic { stored: 0.4 * force * delta, force, rate: Self::rate(&touch, motion) }
    }

    fn approach(&self, surfaces: Surfaces, motion: &JointMotion) -> f64 {
        let (e, touch) = self.found(surfaces, motion);
        Hertz::approach(self, &e, &touch, motion)
    }
}
