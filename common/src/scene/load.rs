//! Loads on bodies: springs, forces, torques, motors and drags.

use super::context::Range;
use super::key_table::{ElementKind, Form, Key, Value, elements};
use super::quantity::*;
use super::values::{Attachment, Curve};

/// Size of a load in a drawing, with keys in braces in the places of their values; of several keys the first one whose value is not zero.
pub type SizeWords = &'static str;

elements! {
    /// A load on one body, or between two; bodies are indices into those of the scene.
    pub enum Load by SizeWords;

    /// Spring and damper between two points, along the line that joins them: with l its length, the pull is
    /// stiffness (l - free_length) + damping dl/dt.
    "spring" ("{stiffness}") => Spring {
        /// Name, unique in its scene.
        name: String = Form::Name,
        /// Place of one end.
        a: Attachment = Form::Place,
        /// Place of the other end, on another body.
        b: Attachment = Form::Place,
        /// Force per length [N/m].
        stiffness: f64 = Form::Number(STIFFNESS, Range::NonNegative),
        /// Force per speed, along the line between the places [N s/m].
        damping: f64 = Form::NumberOr(DAMPING, Range::NonNegative, 0.0),
        /// Length without force [m].
        free_length: f64 = Form::Number(LENGTH, Range::NonNegative),
    }
    "spring of {stiffness}, {damping} between {a} and {b}, slack at {free_length}"

    /// End stop between two points: where their distance l is shorter, with delta = shortest - l, they are pushed apart by
    /// stiffness delta (1 + dissipation d delta/dt), never pulled.
    "end-stop" ("{stiffness}") => EndStop {
        /// Name, unique in its scene.
        name: String = Form::Name,
        /// Place of one end.
        a: Attachment = Form::Place,
        /// Place of the other end, on another body.
        b: Attachment = Form::Place,
        /// Distance at which contact begins [m].
        shortest: f64 = Form::Number(LENGTH, Range::Positive),
        /// Force per length [N/m].
        stiffness: f64 = Form::Number(STIFFNESS, Range::NonNegative),
        /// Dissipation per speed of approach [s/m].
        dissipation: f64 = Form::NumberOr(INVERSE_SPEED, Range::NonNegative, 0.0),
    }
    "end stop of {stiffness}, dissipation {dissipation} between {a} and {b}, from {shortest} down"

    /// Rope or stop between two points: where their distance l is longer, with delta = l - longest, they are pulled together by
    /// stiffness delta (1 + dissipation d delta/dt), never pushed.
    "rope" ("{stiffness}") => Rope {
        /// Name, unique in its scene.
        name: String = Form::Name,
        /// Place of one end.
        a: Attachment = Form::Place,
        /// Place of the other end, on another body.
        b: Attachment = Form::Place,
        /// Distance at which it is taut [m].
        longest: f64 = Form::Number(LENGTH, Range::Positive),
        /// Force per length [N/m].
        stiffness: f64 = Form::Number(STIFFNESS, Range::NonNegative),
        /// Dissipation per speed of lengthening [s/m].
        dissipation: f64 = Form::NumberOr(INVERSE_SPEED, Range::NonNegative, 0.0),
    }
    "rope of {stiffness}, dissipation {dissipation} between {a} and {b}, taut from {longest} on"

    /// End stops of the angle between two bodies, phi = angle_a - angle_b: beyond either, with delta the angle beyond it, the torque
    /// stiffness delta (1 + dissipation d delta/dt) turns them back, never on.
    "angle-stop" ("{stiffness}") => AngleStop {
        /// Name, unique in its scene.
        name: String = Form::Name,
        /// First of the two bodies.
        a: usize = Form::Body,
        /// Second of the two bodies.
        b: usize = Form::Body,
        /// Angle of a minus that of b at the lower stop [rad].
        lower: f64 = Form::Number(ANGLE, Range::Any),
        /// Angle of a minus that of b at the upper stop, above the lower one [rad].
        upper: f64 = Form::Number(ANGLE, Range::Any),
        /// Torque per angle [N m/rad].
        stiffness: f64 = Form::Number(TORSIONAL_STIFFNESS, Range::NonNegative),
        /// Dissipation per angular velocity of approach, in seconds per radian [s].
        dissipation: f64 = Form::NumberOr(TIME, Range::NonNegative, 0.0),
    }
    "angle stops of {stiffness}, dissipation {dissipation} between {a} and {b}, at {lower} and {upper}"

    /// Spring acting along a fixed direction d on a point p of a body against an anchor point a of another:
    /// with y = d . (p - a), the force on p is -stiffness (y - free_length) d, and its opposite acts on a.
    "directional-spring" ("{stiffness}") => DirectionalSpring {
        /// Name, unique in its scene.
        name: String = Form::Name,
        /// Point of application.
        at: Attachment = Form::Place,
        /// Anchor point, from which y is measured.
        anchor: Attachment = Form::Place,
        /// Unit direction d in the global frame `(2,)` [1].
        direction: [f64; 2] = Form::Direction,
        /// Force per length [N/m].
        stiffness: f64 = Form::Number(STIFFNESS, Range::NonNegative),
        /// y at which the force vanishes, y_0 [m].
        free_length: f64 = Form::Number(LENGTH, Range::Any),
    }
    "spring of {stiffness} on {at} along {direction}, slack at {free_length}"

    /// Torsion spring and damper between two bodies: with phi = angle_a - angle_b, the torque on a is
    /// -stiffness (phi - free_angle) - damping dphi/dt, its opposite acts on b.
    "torsion-spring" ("{stiffness}") => TorsionSpring {
        /// Name, unique in its scene.
        name: String = Form::Name,
        /// First of the two bodies.
        a: usize = Form::Body,
        /// Second of the two bodies.
        b: usize = Form::Body,
        /// Torque per angle [N m/rad].
        stiffness: f64 = Form::Number(TORSIONAL_STIFFNESS, Range::NonNegative),
        /// Torque per angular velocity [N m s/rad].
        damping: f64 = Form::NumberOr(TORSIONAL_DAMPING, Range::NonNegative, 0.0),
        /// Angle of a minus that of b without torque [rad].
        free_angle: f64 = Form::NumberOr(ANGLE, Range::Any, 0.0),
    }
    "torsion spring of {stiffness}, {damping} between {a} and {b}, slack at {free_angle}"

    /// Constant force on a point of a body, in the global frame.
    "constant-force" ("{force}") => ConstantForce {
        /// Name, unique in its scene.
        name: String = Form::Name,
        /// Point of application.
        at: Attachment = Form::Place,
        /// Force in the global frame `(2,)` [N].
        force: [f64; 2] = Form::Pair(FORCE),
    }
    "force {force} on {at}"

    /// Force on a point of a body along a fixed direction of the global frame, its size given by a curve.
    "force" ("{size}") => VariableForce {
        /// Name, unique in its scene.
        name: String = Form::Name,
        /// Point of application.
        at: Attachment = Form::Place,
        /// Unit direction in the global frame `(2,)` [1].
        direction: [f64; 2] = Form::Direction,
        /// Size of the force over time or an angle [N].
        size: Curve = Form::Curve(FORCE),
    }
    "force on {at} along {direction}, {size}"

    /// Constant torque on a body.
    "constant-torque" ("{torque}") => ConstantTorque {
        /// Name, unique in its scene.
        name: String = Form::Name,
        /// Body on which the torque acts.
        body: usize = Form::Body,
        /// Torque, counter-clockwise positive [N m].
        torque: f64 = Form::Number(TORQUE, Range::Any),
    }
    "torque {torque} on {body}"

    /// Torque on a body, given by a curve.
    "torque" ("{torque}") => VariableTorque {
        /// Name, unique in its scene.
        name: String = Form::Name,
        /// Body on which the torque acts.
        body: usize = Form::Body,
        /// Torque over time or an angle, counter-clockwise positive [N m].
        torque: Curve = Form::Curve(TORQUE),
    }
    "torque on {body}, {torque}"

    /// A motor with a linear characteristic: torque = stall_torque (1 - omega / no_load_speed) on a body.
    "motor" ("{stall_torque} at rest") => Motor {
        /// Name, unique in its scene.
        name: String = Form::Name,
        /// The body that it turns.
        body: usize = Form::Body,
        /// Torque at rest, with the sign of no_load_speed [N m].
        stall_torque: f64 = Form::Number(TORQUE, Range::Any),
        /// Angular velocity without torque [rad/s].
        no_load_speed: f64 = Form::Number(ANGULAR_VELOCITY, Range::NotZero),
    }
    "motor on {body}, {stall_torque} at rest, none at {no_load_speed}"

    /// Drag on a point of a body along a fixed direction d of the global frame: with u = d . v - flow, v the velocity of the point, the
    /// force -factor (linear + quadratic |u|) u d.
    "drag" ("{quadratic|linear}") => Drag {
        /// Name, unique in its scene.
        name: String = Form::Name,
        /// Point of application.
        at: Attachment = Form::Place,
        /// Unit direction d in the global frame `(2,)` [1].
        direction: [f64; 2] = Form::Direction,
        /// Force per speed [N s/m].
        linear: f64 = Form::NumberOr(DAMPING, Range::NonNegative, 0.0),
        /// Force per square of the speed: half of density, drag coefficient and area [N s^2/m^2].
        quadratic: f64 = Form::NumberOr(DRAG, Range::NonNegative, 0.0),
        /// Speed of the medium along d [m/s].
        flow: f64 = Form::NumberOr(SPEED, Range::Any, 0.0),
        /// Factor over time or an angle; one without it [1].
        factor: Option<Curve> = Form::Factor,
    }
    "drag of {linear} and {quadratic} on {at} along {direction} in a flow of {flow}{factor}"

    /// Drag of a turning body: the torque -factor (linear + quadratic |omega|) omega.
    "rotational-drag" ("{quadratic|linear}") => RotationalDrag {
        /// Name, unique in its scene.
        name: String = Form::Name,
        /// Body on which the torque acts.
        body: usize = Form::Body,
        /// Torque per angular velocity [N m s/rad].
        linear: f64 = Form::NumberOr(TORSIONAL_DAMPING, Range::NonNegative, 0.0),
        /// Torque per square of the angular velocity [N m s^2/rad^2].
        quadratic: f64 = Form::NumberOr(TORSIONAL_DRAG, Range::NonNegative, 0.0),
        /// Factor over time or an angle; one without it [1].
        factor: Option<Curve> = Form::Factor,
    }
    "drag of {linear} and {quadratic} on {body}{factor}"
}

impl Load {
    /// Name, unique in its scene.
    pub fn name(&self) -> String {
        let name = self.values().into_iter().find(|(key, _)| key.form == Form::Name);
        name.expect("every load has a name").1.into()
    }

    /// Its word in a scene.
    pub fn word(&self) -> &'static str {
        self.kind().words[0].0
    }

    /// Indices of the bodies that the load couples: those it acts on, and the one whose angle its size depends on.
    pub fn bodies(&self) -> Vec<usize> {
        self.values().iter().filter_map(|(_, value)| value.body()).collect()
    }

    /// Name of the load, its key of the curve by which it varies, that curve and the kind of its values; `None` for a load without one.
    pub fn curve(&self) -> Option<(String, &'static str, Curve, Kind)> {
        self.values().into_iter().find_map(|(key, value)| {
            let kind = if let Form::Curve(kind) = key.form { kind } else { NUMBER };
            let (_, curve) = value.curves(key.name).pop()?;
            Some((self.name(), key.name, curve.clone(), kind))
        })
    }
}
