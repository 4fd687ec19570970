//! Loads of an island: generalised forces on two of its frames, with exact derivatives to coordinates, rates
//! and time.
//!
//! Each kind of load has its equation at its type; `island_loads!` below lists the kinds. Generalised forces
//! `(6,)` are (F_x, F_y, M) [N, N, N m] on the first frame, then on the second.

mod force;
mod one_frame;
mod springs;
mod stops;

pub use force::{LoadForce, NO_FRAME};

use super::frame::Frame;
use super::island_frames::IslandFrames;
use crate::lanes::{Lanewise, Real};
use common::scene::{Curve, Load, Motion, Scene};
use force::Size;
use one_frame::{BodyTorque, Drag, Motor, PointForce, RotationalDrag};
use springs::{DirectionalSpring, Spring, TorsionSpring};
use stops::{AngleStop, LineStop};

/// Declares [`IslandLoad`] with one variant per kind of load.
macro_rules! island_loads {
    ($($kind:ident),+) => {
        /// A load with its frames resolved.
        #[derive(Debug, Clone)]
        pub enum IslandLoad<R = f64> {
            $(#[doc = concat!("See [`", stringify!($kind), "`].")] $kind($kind<R>)),+
        }

        impl<R: Real> IslandLoad<R> {
            /// The force at time `t` [s].
            #[inline(always)]
            pub(crate) fn force(&self, t: R, frames: &[Frame<R>]) -> LoadForce<R> {
                match self {
                    $(IslandLoad::$kind(load) => load.force(t, frames)),+
                }
            }
        }

        impl Lanewise for IslandLoad {
            type Lanes<R: Real> = IslandLoad<R>;
            fn in_lanes<R: Real>(&self, like: R) -> IslandLoad<R> {
                match self {
                    $(IslandLoad::$kind(load) => IslandLoad::$kind(load.in_lanes(like))),+
                }
            }
            fn write_lane<R: Real>(&self, lane: usize, to: &mut IslandLoad<R>) {
                match (self, to) {
                    $((IslandLoad::$kind(load), IslandLoad::$kind(to)) => load.write_lane::<R>(lane, to),)+
                    _ => {}
                }
            }
            fn has_same_topology(&self, other: &Self) -> bool {
                match (self, other) {
                    $((IslandLoad::$kind(a), IslandLoad::$kind(b)) => a.has_same_topology(b),)+
                    _ => false,
                }
            }
        }
    };
}

island_loads!(
    DirectionalSpring,
    Spring,
    TorsionSpring,
    LineStop,
    AngleStop,
    PointForce,
    BodyTorque,
    Motor,
    Drag,
    RotationalDrag
);

impl IslandLoad {
    /// The frames that the load couples.
    pub(crate) fn frames(&self) -> Vec<usize> {
        match self {
            Self::DirectionalSpring(DirectionalSpring { ends, .. })
            | Self::Spring(Spring { ends, .. })
            | Self::LineStop(LineStop { ends, .. }) => ends.map(|end| end.frame).to_vec(),
            Self::TorsionSpring(TorsionSpring { frames, .. }) | Self::AngleStop(AngleStop { frames, .. }) => {
                frames.to_vec()
            }
            Self::PointForce(PointForce { end, size, .. }) | Self::Drag(Drag { end, factor: size, .. }) => {
                size.frames(end.frame)
            }
            Self::BodyTorque(BodyTorque { frame, size })
            | Self::RotationalDrag(RotationalDrag { frame, factor: size, .. }) => size.frames(*frame),
            Self::Motor(motor) => vec![motor.frame],
        }
    }

    /// Whether the load's work counts as input, as far as it is not dissipated: it has no potential.
    pub(crate) fn drives(&self) -> bool {
        let springs = matches!(self, Self::DirectionalSpring(_) | Self::Spring(_) | Self::TorsionSpring(_));
        !springs && !matches!(self, Self::LineStop(_) | Self::AngleStop(_))
    }

    /// The load of a scene, with its frames from `frames`.
    pub(crate) fn new(load: &Load, frames: &mut IslandFrames) -> Self {
        match *load {
            Load::DirectionalSpring { ref at, ref anchor, direction, stiffness, free_length, .. } => {
                let ends = [frames.end(at), frames.end(anchor)];
                Self::DirectionalSpring(DirectionalSpring { ends, direction, stiffness, free_length })
            }
            Load::Spring { ref a, ref b, stiffness, damping, free_length, .. } => {
                let ends = [frames.end(a), frames.end(b)];
                Self::Spring(Spring { ends, stiffness, damping, free_length })
            }
            Load::EndStop { ref a, ref b, shortest: length, stiffness, dissipation, .. }
            | Load::Rope { ref a, ref b, longest: length, stiffness, dissipation, .. } => {
                let ends = [frames.end(a), frames.end(b)];
                let side = if matches!(load, Load::Rope { .. }) { 1.0 } else { -1.0 };
                Self::LineStop(LineStop { ends, side, length, stiffness, dissipation })
            }
            Load::AngleStop { a, b, lower, upper, stiffness, dissipation, .. } => {
                let frames = [frames.frame(a), frames.frame(b)];
                Self::AngleStop(AngleStop { frames, bounds: [lower, upper], stiffness, dissipation })
            }
            Load::TorsionSpring { a, b, stiffness, damping, free_angle, .. } => {
                let frames = [frames.frame(a), frames.frame(b)];
                Self::TorsionSpring(TorsionSpring { frames, stiffness, damping, free_angle })
            }
            Load::ConstantForce { ref at, force, .. } => {
                let size = libm::hypot(force[0], force[1]);
                let direction = if size > 0.0 { force.map(|x| x / size) } else { [0.0; 2] };
                Self::PointForce(PointForce { end: frames.end(at), direction, size: Size::Constant(size) })
            }
            Load::ConstantTorque { body, torque, .. } => {
                Self::BodyTorque(BodyTorque { frame: frames.frame(body), size: Size::Constant(torque) })
            }
            Load::VariableForce { ref at, direction, ref size, .. } => {
                let end = frames.end(at);
                Self::PointForce(PointForce { end, direction, size: Size::new(size, frames) })
            }
            Load::VariableTorque { body, ref torque, .. } => {
                let frame = frames.frame(body);
                Self::BodyTorque(BodyTorque { frame, size: Size::new(torque, frames) })
            }
            Load::Motor { body, stall_torque, no_load_speed, .. } => {
                Self::Motor(Motor { frame: frames.frame(body), stall_torque, no_load_speed })
            }
            Load::Drag { ref at, direction, linear, quadratic, flow, ref factor, .. } => {
                let (end, factor) = (frames.end(at), size_or_one(factor.as_ref(), frames));
                Self::Drag(Drag { end, direction, linear, quadratic, flow, factor })
            }
            Load::RotationalDrag { body, linear, quadratic, ref factor, .. } => {
                let (frame, factor) = (frames.frame(body), size_or_one(factor.as_ref(), frames));
                Self::RotationalDrag(RotationalDrag { frame, linear, quadratic, factor })
            }
        }
    }
}

/// The factor of a drag, one without a curve.
fn size_or_one(factor: Option<&Curve>, frames: &mut IslandFrames) -> Size {
    factor.map_or(Size::Constant(1.0), |factor| Size::new(factor, frames))
}

/// Moment of the loads on the prescribed `body` of a scene that act on no free body, about its axis at a time [s] [N m].
pub(crate) fn external_moment(scene: &Scene, body: usize) -> impl Fn(f64) -> f64 {
    let mut frames = IslandFrames::new(scene, vec![]);
    let own = frames.frame(body);
    let is_prescribed = |b: &usize| !matches!(scene.bodies[*b].motion, Motion::Free { .. });
    let acts = |load: &&Load| load.bodies().contains(&body) && load.bodies().iter().all(is_prescribed);
    let loads: Vec<IslandLoad> =
        scene.loads.iter().filter(acts).map(|load| IslandLoad::new(load, &mut frames)).collect();
    let prescribed = frames.prescribed();
    move |t| {
        if loads.is_empty() {
            return 0.0;
        }
        let frames: Vec<Frame> = prescribed.iter().map(|p| p.frame(t)).collect();
        let on_body = |load: &IslandLoad| -> f64 {
            let force = load.force(t, &frames);
            let sides = force.frames.iter().enumerate().filter(|&(_, &frame)| frame == own);
            sides.map(|(side, _)| force.f[3 * side + 2]).sum()
        };
        loads.iter().map(on_body).sum()
    }
}
