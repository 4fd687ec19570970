//! Contact law `local-hertz`: Hertz's force with the penetration measured along the eccentricity.
//!
//! delta = |e| + R1 - R(psi), F_el = K_n delta^1.5, F_N = F_el max(0, 1 + D delta_dot) along e, friction F_T
//! = mu F_N tanh(v_t / v_0) along the tangent, with the eccentricity e and its direction psi [m, rad], the
//! journal radius R1 and the worn bore R(psi) [m], the Hertz stiffness K_n [N/m^1.5] (see `surface.rs`),
//! the damping factor D [s/m], the friction coefficient mu [1] and its regularisation speed v_0 [m/s].
//!
//! A worn journal (`journal_table.rs`) of radius R_j(chi), chi = psi - alpha, takes the place of R1 throughout; its
//! surface passes the contact at the rate chi_dot = w.t / |e| - omega_i [rad/s], and delta_dot gains R_j'
//! chi_dot.
//!
//! Exact for the model on a round bore. On a worn profile, whose normal is not along e, the law is not
//! conservative: it can feed energy into a vibration (`energy.rs` measures how much).
//!
//! # Source
//! Contact law of the seed paper: Cui et al., China Mechanical Engineering 37(6), 2026, 1472-1485, doi
//! 10.3969/j.issn.1004-132X.2026.06.020. Force and damping after Lankarani, Nikravesh (1990), J. Mech. Design
//! 112, 369-376.

use super::{ForceSlopes, JointForce, JointMotion, Surface, Surfaces};
use crate::bore::Radius;
use crate::lanes::{Real, direction_angle};
use crate::plane::{fused_dot as dot, left};

/// The law with its constants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LocalHertz<R = f64> {
    /// Constants of the joint.
    pub surface: Surface<R>,
}

/// An eccentricity in polar coordinates.
#[derive(Debug, Clone, Copy)]
pub struct PolarEccentricity<R> {
    /// Size |e| of the eccentricity [m], and its inverse [1/m].
    size: R,
    inverse: R,
    /// Unit vector u of the eccentricity `(2,)` [1].
    u: [R; 2],
    /// Angle of u [rad].
    pub psi: R,
}

impl<R: Real> PolarEccentricity<R> {
    /// The eccentricity `e` `(2,)` [m]; at the centre of the bore, without contact, any direction serves.
    #[inline(always)]
    pub fn new(e: [R; 2]) -> Self {
        let nothing = e[0].zero();
        let one = nothing.like(1.0);
        let size = dot(e, e).sqrt();
        let inverse = one / R::select(nothing.below(size), size, one);
        let u = [e[0] * inverse, e[1] * inverse];
        PolarEccentricity { size, inverse, u, psi: direction_angle(u) }
    }
}

/// The two surfaces in the direction of the eccentricity.
#[derive(Debug, Clone, Copy)]
pub struct Walls<R> {
    /// The bore, worn so far.
    pub bore: Radius<R>,
    /// The journal, if it wears; its derivatives are to the angle in its own body.
    pub journal: Option<Radius<R>>,
}

impl<R: Real> LocalHertz<R> {
    /// Force on the journal at the eccentricity `e`, in whose direction the surfaces are `walls`; with `JACOBIAN` its exact derivative, else no slopes.
    ///
    /// With u the unit vector of e, t its left normal, r = |e|: delta_dot = w.u - R' (w.t / r - omega_j) + R_j' (w.t / r - omega_i), v_t
    /// = w.t + omega_i R_j - omega_j R, force = -F_N u - F_T t - c_f w, torques -R_j F_T on the journal, +R F_T
    /// on the bushing. In free flight (delta <= 0), and where the contact lets go early (1 + D delta_dot <=
    /// 0), only the film acts. Without `JOURNAL` the journal does not wear, which is known when this is compiled.
    #[inline(always)]
    pub(crate) fn force<const JACOBIAN: bool, const JOURNAL: bool>(
        &self,
        e: &PolarEccentricity<R>,
        walls: &Walls<R>,
        motion: &JointMotion<R>,
    ) -> (JointForce<R>, ForceSlopes<R>) {
        let s = &self.surface;
        let JointMotion { w, omega_journal, omega_bushing, .. } = *motion;
        let PolarEccentricity { size, inverse, u, .. } = *e;
        let bore = walls.bore;
        let journal = if JOURNAL { walls.journal } else { None };
        let radius = journal.map_or(s.journal_radius, |journal| journal.r);
        let nothing = size.zero();
        let one = nothing.like(1.0);
        let delta = size + radius - bore.r;
        let t = left(u);
        let (wu, wt) = (dot(w, u), dot(w, t));
        let turn = (-omega_bushing).plus_product(wt, inverse);
        let mut rate = wu.minus_product(bore.d1, turn);
        let mut spin = nothing;
        if let Some(journal) = journal {
            spin = (-omega_journal).plus_product(wt, inverse);
            rate = rate.plus_product(journal.d1, spin);
        }
        let factor = one.plus_product(s.damping, rate);
        // NaN compares as no contact; the penetration keeps the NaN.
        let touches = R::both(nothing.below(delta), nothing.below(factor));
        let root = R::select(touches, delta, nothing).sqrt();
        let elastic = s.stiffness * root * root * root;
        let normal = elastic * factor;
        let sliding = wt.plus_product(omega_journal, radius).minus_product(omega_bushing, bore.r);
        let sliding = R::select(touches, sliding, nothing);
        let (mu, mu_v) = s.friction(sliding);
        let friction = mu * normal;
        let mut out = JointForce {
            force: [
                -(normal * u[0]).plus_product(friction, t[0]),
                -(normal * u[1]).plus_product(friction, t[1]),
            ],
            torque_journal: -radius * friction,
            torque_bushing: bore.r * friction,
            normal,
            direction: [R::select(touches, u[0], nothing), R::select(touches, u[1], nothing)],
            penetration: delta,
            sliding,
        };
        s.add_film(motion, &mut out);
        if !JACOBIAN {
            return (out, ForceSlopes::none(nothing));
        }
        // Derivative of (force, torques) without the film to (e, w, omega_i, omega_j), in the axes (u, t), and to alpha if the journal wears.
        let slope = s.stiffness * root * factor * 1.5;
        let ed = elastic * s.damping;
        let bend = match journal {
            None => bore.d1 * inverse,
            Some(journal) => (bore.d1 - journal.d1) * inverse,
        };
        // Normal force. delta grows by 1 along u and by -bend along t; its rate by (bend wt / r, (wt - R'' turn + bend
        // wu) / r) with e, by (1, -bend) with w and by R' with omega_j.
        let mut rate_t = wt.minus_product(bore.d2, turn).plus_product(bend, wu) * inverse;
        if let Some(journal) = journal {
            rate_t = rate_t.plus_product(journal.d2 * spin, inverse);
        }
        // Arrays are written whole, and once: what is filled entry by entry goes through memory.
        let to_omega = match journal {
            None => nothing,
            Some(journal) => -(ed * journal.d1),
        };
        let dn = [
            slope.plus_product(ed, bend * wt * inverse),
            (ed * rate_t).minus_product(slope, bend),
            ed,
            -(ed * bend),
            to_omega,
            ed * bore.d1,
        ];
        // Friction. The sliding speed grows by -(wu + omega_j R' - omega_i R_j') / r with e along t, by 1 with w along t, by R_j with
        // omega_i and by -R with omega_j.
        let grip = mu_v * normal;
        let mut across = (mu * dn[1]).minus_product(grip, wu.plus_product(omega_bushing, bore.d1) * inverse);
        let mut to_omega = grip * radius;
        if let Some(journal) = journal {
            across = across.plus_product(grip * omega_journal, journal.d1 * inverse);
            to_omega = to_omega.plus_product(mu, dn[4]);
        }
        let to_bushing = (mu * dn[5]).minus_product(grip, bore.r);
        let df = [mu * dn[0], across, mu * dn[2], mu * dn[3] + grip, to_omega, to_bushing];
        // The unit vectors turn with the direction of e, du = t dpsi, dt = -u dpsi; the radii change.
        let (mut on_journal, mut on_bushing) = (-(radius * df[1]), bore.r * df[1]);
        match journal {
            None => on_bushing = on_bushing.plus_product(bend, friction),
            Some(journal) => {
                on_journal = on_journal.minus_product(journal.d1 * inverse, friction);
                on_bushing = on_bushing.plus_product(bore.d1 * inverse, friction);
            }
        }
        let along = (-dn[1]).plus_product(friction, inverse);
        let across = (-df[1]).minus_product(normal, inverse);
        let rows = [
            [-dn[0], along, -dn[2], -dn[3], -dn[4], -dn[5]],
            [-df[0], across, -df[2], -df[3], -df[4], -df[5]],
            [
                -(radius * df[0]),
                on_journal,
                -(radius * df[2]),
                -(radius * df[3]),
                -(radius * df[4]),
                -(radius * df[5]),
            ],
            [bore.r * df[0], on_bushing, bore.r * df[2], bore.r * df[3], bore.r * df[4], bore.r * df[5]],
        ];
        // The place on the journal falls behind as alpha grows.
        let mut to_turn = None;
        if let Some(journal) = journal {
            let dn = -(slope * journal.d1).plus_product(ed * journal.d2, spin);
            let df = (mu * dn).minus_product(grip * omega_journal, journal.d1);
            to_turn = Some([-dn, -df, (journal.d1 * friction).minus_product(radius, df), bore.r * df]);
        }
        let mut slopes = ForceSlopes { u, rows, to_turn };
        s.add_film_slopes(&mut slopes);
        (out, slopes)
    }

    /// Rate of the penetration, delta_dot, at the eccentricity `e`, in whose direction the surfaces are `walls` [m/s]; in the middle of the
    /// bore, from where every direction leads to the wall, the speed.
    #[inline(always)]
    pub(super) fn approach(&self, e: &PolarEccentricity<R>, walls: &Walls<R>, motion: &JointMotion<R>) -> R {
        let JointMotion { w, omega_journal, omega_bushing, .. } = *motion;
        let along = dot(w, left(e.u));
        let turn = (-omega_bushing).plus_product(along, e.inverse);
        let mut rate = dot(w, e.u).minus_product(walls.bore.d1, turn);
        if let Some(journal) = walls.journal {
            let spin = (-omega_journal).plus_product(along, e.inverse);
            rate = rate.plus_product(journal.d1, spin);
        }
        R::select(e.size.zero().below(e.size), rate, dot(w, w).sqrt())
    }
}

impl LocalHertz {
    /// The elastic part of the contact between these surfaces: stored energy [J], force F_el [N] and delta_dot [m/s], by which the force
    /// multiplies to the rate of the energy; all zero in free flight.
    pub(super) fn elastic(&self, Surfaces { bore, journal }: Surfaces, motion: &JointMotion) -> [f64; 3] {
        let e = motion.e;
        let psi = libm::atan2(e[1], e[0]);
        let radius = journal.map_or(self.surface.journal_radius, |j| j.radius_at(psi - motion.turn).r);
        let delta = libm::hypot(e[0], e[1]) + radius - bore.radius_at(psi).r;
        if delta <= 0.0 {
            return [0.0; 3];
        }
        let force = self.surface.stiffness * delta * delta.sqrt();
        let place = PolarEccentricity::new(e);
        let journal = journal.map(|journal| journal.radius_at(place.psi - motion.turn));
        let walls = Walls { bore: bore.radius_at(place.psi), journal };
        [0.4 * force * delta, force, self.approach(&place, &walls, motion)]
    }
}
