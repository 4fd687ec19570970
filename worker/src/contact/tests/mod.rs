//! Both contact laws on a worn bore: exact derivatives, balances of power and momentum, conservation.

mod arc_cells;
mod foundation;
mod journal;
mod rotated_cells;

use crate::bore::Profile;
use crate::contact::{
    Contact, ForceSlopes, Foundation, JointForce, JointMotion, LawLanes, LocalHertz, PolarEccentricity,
    Surface, Surfaces,
};
use std::f64::consts::TAU;

pub(super) const SURFACE: Surface = Surface {
    journal_radius: 1.5e-3,
    clearance: 23.5e-6,
    stiffness: 3.264e10,
    damping: 7.5,
    restitution: None,
    friction: 0.025,
    per_friction_speed: 1.0 / 2.4e-3,
    film: 7.0,
};

/// Slopes in the axes of the bushing.
impl ForceSlopes {
    /// Derivatives of (force, torque_journal, torque_bushing) to the angle alpha, in the bushing's axes `(4,)`.
    pub(crate) fn turn_in_bushing_axes(&self) -> [f64; 4] {
        let [a, b, journal, bushing] = self.to_turn.unwrap_or_default();
        let (u, t) = (self.u, crate::plane::left(self.u));
        [a * u[0] + b * t[0], a * u[1] + b * t[1], journal, bushing]
    }

    /// Derivatives of (force, torque_journal, torque_bushing) to (e, w, omega_journal, omega_bushing) in the bushing's
    /// axes `(4, 6)`.
    pub(crate) fn in_bushing_axes(&self) -> [[f64; 6]; 4] {
        let (u, t) = (self.u, crate::plane::left(self.u));
        let mut turned = self.rows;
        for row in &mut turned {
            for pair in [0, 2] {
                let (a, b) = (row[pair], row[pair + 1]);
                row[pair] = a * u[0] + b * t[0];
                row[pair + 1] = a * u[1] + b * t[1];
            }
        }
        let mut jacobian = turned;
        for c in 0..6 {
            let (a, b) = (turned[0][c], turned[1][c]);
            jacobian[0][c] = a * u[0] + b * t[0];
            jacobian[1][c] = a * u[1] + b * t[1];
        }
        jacobian
    }
}

/// The law as a joint by itself uses it, made for one motion.
impl Contact {
    /// Force at this motion; with `JACOBIAN` its exact derivative, else no slopes.
    pub(crate) fn force<'a, const JACOBIAN: bool>(
        &self,
        surfaces: impl Into<Surfaces<'a>>,
        motion: &JointMotion,
    ) -> (JointForce, ForceSlopes) {
        let law = LawLanes::new(self, surfaces.into(), 0.0);
        let place = PolarEccentricity::new(motion.e);
        law.force::<JACOBIAN>((&place, &law.walls(&place, motion.turn)), motion)
    }

    /// Follows the speed of approach after an accepted step with this force.
    pub(crate) fn accepted<'a>(
        &mut self,
        surfaces: impl Into<Surfaces<'a>>,
        motion: &JointMotion,
        now: &JointForce,
    ) {
        let mut law = LawLanes::new(self, surfaces.into(), 0.0);
        let place = PolarEccentricity::new(motion.e);
        let walls = law.walls(&place, motion.turn);
        law.follow_approach((&place, &walls), motion, now.penetration);
        self.set_damping(law.surface().damping);
    }
}

pub(super) fn worn() -> Profile {
    let mut profile = Profile::round(SURFACE.journal_radius + SURFACE.clearance, 36);
    let depth: Vec<f64> = (0..36)
        .map(|i| {
            let psi = TAU * f64::from(i) / 36.0;
            8e-6 * (1.0 + (psi - 1.0).cos()) + 2e-6 * (1.0 + (3.0 * psi).sin())
        })
        .collect();
    profile.set_depth(&depth);
    profile
}

pub(super) fn laws(surface: Surface, profile: &Profile) -> [Contact; 2] {
    let mut foundation = Foundation::new(surface, profile.points());
    foundation.profile_changed(profile);
    [Contact::LocalHertz(LocalHertz { surface }), Contact::Foundation(foundation)]
}

/// Motions in contact all round the bore, sliding slowly enough that the friction's regularisation matters.
pub(super) fn motions(profile: &Profile) -> Vec<JointMotion> {
    (0..24)
        .map(|k| {
            let x = f64::from(k);
            let psi = 0.1 + TAU * x / 24.0;
            let penetration = 1e-7 * (1.0 + x % 5.0);
            let reach = profile.radius_at(psi).r - SURFACE.journal_radius + penetration;
            let omega_bushing = 9.0 * (1.7 * x).sin();
            JointMotion {
                e: [reach * psi.cos(), reach * psi.sin()],
                w: [4e-3 * (2.1 * x).sin(), 4e-3 * (0.9 * x).cos()],
                omega_journal: omega_bushing + 2.0 * (0.4 * x).sin(),
                omega_bushing,
                turn: 0.4 * x,
            }
        })
        .collect()
}

/// (force, torque on the journal, torque on the bushing).
fn rows(f: &JointForce) -> [f64; 4] {
    [f.force[0], f.force[1], f.torque_journal, f.torque_bushing]
}

fn moved(m: &JointMotion, column: usize, step: f64) -> JointMotion {
    let mut m = *m;
    match column {
        0 | 1 => m.e[column] += step,
        2 | 3 => m.w[column - 2] += step,
        4 => m.omega_journal += step,
        _ => m.omega_bushing += step,
    }
    m
}

#[test]
fn jacobians_agree_with_central_differences() {
    let profile = worn();
    for law in laws(SURFACE, &profile) {
        let mut worst: f64 = 0.0;
        for motion in motions(&profile) {
            let (at, slopes) = law.force::<true>(&profile, &motion);
            assert!(at.normal > 0.0 && at.sliding.abs() * SURFACE.per_friction_speed < 10.0);
            let plain = law.force::<false>(&profile, &motion).0;
            assert_eq!(rows(&at), rows(&plain), "with and without derivative");
            for (column, step) in [1e-10, 1e-10, 1e-8, 1e-8, 1e-5, 1e-5].into_iter().enumerate() {
                let plus = rows(&law.force::<false>(&profile, &moved(&motion, column, step)).0);
                let minus = rows(&law.force::<false>(&profile, &moved(&motion, column, -step)).0);
                for (r, row) in slopes.in_bushing_axes().iter().enumerate() {
                    let largest = |of: &[f64]| of.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
                    let scale = match column {
                        0 | 1 => largest(&row[..2]),
                        2 | 3 => largest(&row[2..4]),
                        _ => largest(&row[4..]).max(SURFACE.journal_radius * largest(&row[2..4])),
                    };
                    let difference = (plus[r] - minus[r]) / (2.0 * step);
                    worst = worst.max((difference - row[column]).abs() / scale);
                }
            }
        }
        assert!(worst < 2e-6, "{law:?}: {worst}");
    }
}

/// Power of the joint's forces on both bodies.
fn power(f: &JointForce, m: &JointMotion) -> f64 {
    f.force[0] * m.w[0]
        + f.force[1] * m.w[1]
        + f.torque_journal * m.omega_journal
        + f.torque_bushing * m.omega_bushing
}

#[test]
fn friction_opposes_sliding_and_dissipates_what_it_should() {
    let profile = worn();
    let rubbing = laws(SURFACE, &profile);
    let smooth = laws(Surface { friction: 0.0, ..SURFACE }, &profile);
    for (with, without) in rubbing.iter().zip(&smooth) {
        for motion in motions(&profile) {
            let (f, g) =
                (with.force::<false>(&profile, &motion).0, without.force::<false>(&profile, &motion).0);
            assert_eq!(f.normal, g.normal);
            let rubbed = power(&f, &motion) - power(&g, &motion);
            let size = SURFACE.friction * f.normal * (f.sliding * SURFACE.per_friction_speed).tanh();
            let expected = -size * f.sliding;
            assert!(expected < 0.0);
            let scale = power(&g, &motion).abs() + expected.abs();
            assert!((rubbed - expected).abs() < 1e-12 * scale, "{rubbed} against {expected}");
            let t = [-f.direction[1], f.direction[0]];
            let along = (f.force[0] - g.force[0]) * t[0] + (f.force[1] - g.force[1]) * t[1];
            assert!(along * f.sliding < 0.0, "friction {along} along sliding {}", f.sliding);
        }
    }
}

#[test]
fn the_film_dissipates_c_w_squared_and_acts_alone_in_free_flight() {
    let profile = worn();
    let motion = JointMotion {
        e: [9e-6, -4e-6],
        w: [0.02, 0.03],
        omega_journal: 50.0,
        omega_bushing: -7.0,
        turn: 0.0,
    };
    let dry = laws(Surface { film: 0.0, ..SURFACE }, &profile);
    for (wet, dry) in laws(SURFACE, &profile).iter().zip(&dry) {
        let f = wet.force::<true>(&profile, &motion).0;
        assert_eq!(rows(&f), [-SURFACE.film * 0.02, -SURFACE.film * 0.03, 0.0, 0.0]);
        assert!(f.penetration < 0.0);
        assert_eq!((f.normal, f.direction), (0.0, [0.0; 2]));
        assert_eq!(rows(&dry.force::<true>(&profile, &motion).0), [0.0; 4]);
        for motion in motions(&profile) {
            let film = power(&wet.force::<false>(&profile, &motion).0, &motion)
                - power(&dry.force::<false>(&profile, &motion).0, &motion);
            let expected = -SURFACE.film * (motion.w[0].powi(2) + motion.w[1].powi(2));
            assert!((film - expected).abs() < 1e-10 * expected.abs(), "{film} against {expected}");
        }
    }
}

#[test]
fn foundation_loses_only_what_damping_takes_and_balances_momentum() {
    // With the potential V(e) in the bushing's frame, power = -dV/dt - F_el D delta_dot^2: without friction
    // and film the power is -F_el delta_dot (1 + D delta_dot), and F_N = F_el (1 + D delta_dot), so it is
    // -F_N delta_dot.
    let profile = worn();
    let [_, foundation] = laws(Surface { friction: 0.0, film: 0.0, ..SURFACE }, &profile);
    let [_, undamped] = laws(Surface { friction: 0.0, film: 0.0, damping: 0.0, ..SURFACE }, &profile);
    let [_, whole] = laws(Surface { film: 0.0, ..SURFACE }, &profile);
    for motion in motions(&profile) {
        let f = foundation.force::<false>(&profile, &motion).0;
        let elastic = undamped.force::<false>(&profile, &motion).0;
        let stored = -power(&elastic, &motion);
        let rate = stored / elastic.normal;
        let lost = -power(&f, &motion) - stored;
        let expected = elastic.normal * SURFACE.damping * rate * rate;
        assert!((lost - expected).abs() < 1e-10 * expected.max(stored.abs()), "{lost} against {expected}");
        // No moment comes out of nothing: e x F + M_journal + M_bushing = 0.
        let f = whole.force::<false>(&profile, &motion).0;
        let moment =
            motion.e[0] * f.force[1] - motion.e[1] * f.force[0] + f.torque_journal + f.torque_bushing;
        assert!(moment.abs() < 1e-12 * SURFACE.journal_radius * f.normal, "{moment}");
    }
}

/// Work of the elastic force on a closed path of e in the bushing's frame, relative to the work without
/// signs.
fn loop_work(law: &Contact, profile: &Profile, path: impl Fn(f64) -> [f64; 2]) -> f64 {
    const STEPS: usize = 20_000;
    let (mut work, mut absolute) = (0.0, 0.0);
    let force = |e: [f64; 2]| {
        law.force::<false>(
            profile,
            &JointMotion { e, w: [0.0; 2], omega_journal: 0.0, omega_bushing: 0.0, turn: 0.0 },
        )
        .0
        .force
    };
    let mut e = path(0.0);
    let mut f = force(e);
    for k in 1..=STEPS {
        let to = path(TAU * k as f64 / STEPS as f64);
        let g = force(to);
        let done = 0.5 * ((f[0] + g[0]) * (to[0] - e[0]) + (f[1] + g[1]) * (to[1] - e[1]));
        work += done;
        absolute += done.abs();
        (e, f) = (to, g);
    }
    work / absolute
}

#[test]
fn foundation_is_conservative_on_a_worn_bore_and_the_local_law_is_not() {
    let profile = worn();
    let bare = Surface { damping: 0.0, friction: 0.0, film: 0.0, ..SURFACE };
    let [local, foundation] = laws(bare, &profile);
    for psi in [0.3, 1.9, 4.0] {
        // An ellipse of e about the point of first contact: in and out of contact, along the bore and back.
        let reach = profile.radius_at(psi).r - SURFACE.journal_radius + 1e-7;
        let path = |s: f64| {
            let (radial, along) = (reach + 4e-7 * s.cos(), 2e-6 * s.sin());
            [radial * psi.cos() - along * psi.sin(), radial * psi.sin() + along * psi.cos()]
        };
        let conserved = loop_work(&foundation, &profile, path);
        assert!(conserved.abs() < 1e-6, "foundation at {psi}: {conserved}");
        let gained = loop_work(&local, &profile, path);
        assert!(gained.abs() > 0.01, "local law at {psi}: {gained}");
        let round = Profile::round(profile.initial_radius, 36);
        let inside = |s: f64| {
            let (radial, along) = (SURFACE.clearance + 1e-7 + 4e-7 * s.cos(), 2e-6 * s.sin());
            [radial * psi.cos() - along * psi.sin(), radial * psi.sin() + along * psi.cos()]
        };
        let unworn = loop_work(&local, &round, inside);
        assert!(unworn.abs() < 1e-6, "local law, unworn, at {psi}: {unworn}");
    }
}
