//! Mechanisms in other places, directions, orientations and sizes, which move alike.

use common::scene::{
    Attachment, Clearance, ContactDamping, Drive, GuideClearance, JointKind, Load, Material, Motion,
    OutputKind, OutputUnit, Scene,
};

/// A change of the whole mechanism: a mirror image about the x axis or not, then a turn, then another length.
#[derive(Debug, Clone, Copy)]
pub struct Transform {
    pub mirrored: bool,
    /// Angle of the turn [rad].
    pub turn: f64,
    /// Factor of all lengths; times and masses stay [1].
    pub scale: f64,
}

impl Transform {
    pub const NONE: Transform = Transform { mirrored: false, turn: 0.0, scale: 1.0 };

    fn sense(&self) -> f64 {
        if self.mirrored { -1.0 } else { 1.0 }
    }

    /// A vector of a moving body.
    fn inner(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.scale * x, self.scale * self.sense() * y]
    }

    /// A direction of the global frame.
    fn direction(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let (y, (s, c)) = (self.sense() * y, self.turn.sin_cos());
        if self.turn == 0.0 { [x, y] } else { [c * x - s * y, s * x + c * y] }
    }

    /// A vector of the global frame.
    fn vector(&self, x: [f64; 2]) -> [f64; 2] {
        self.direction(x).map(|x| self.scale * x)
    }

    /// An angle from the axes of the global frame.
    fn angle(&self, angle: f64) -> f64 {
        self.sense() * angle + self.turn
    }

    /// Value of an output after the change over that before, in SI.
    pub fn of_output(&self, kind: &OutputKind) -> f64 {
        let power = match kind.unit() {
            OutputUnit::Length | OutputUnit::Force | OutputUnit::Acceleration => 1,
            OutputUnit::Torque | OutputUnit::Energy => 2,
            OutputUnit::Volume => 3,
            _ => 0,
        };
        self.scale.powi(power)
    }

    /// The scene after the change.
    pub fn of(&self, mut scene: Scene) -> Scene {
        let (sense, l) = (self.sense(), self.scale);
        let fixed: Vec<bool> = scene.bodies.iter().map(|b| b.motion == Motion::Fixed).collect();
        let place = |a: &mut Attachment| {
            a.position = if fixed[a.body] { self.vector(a.position) } else { self.inner(a.position) };
        };
        for body in &mut scene.bodies {
            match &mut body.motion {
                Motion::Fixed => {}
                Motion::Driven { position, drive, inertia } => {
                    *position = self.vector(*position);
                    match drive {
                        Drive::ConstantSpeed { start_angle, speed } => {
                            (*start_angle, *speed) = (self.angle(*start_angle), sense * *speed);
                        }
                        Drive::Angle(table) => table.value.iter_mut().for_each(|a| *a = self.angle(*a)),
                        Drive::Speed { start_angle, table } => {
                            *start_angle = self.angle(*start_angle);
                            table.value.iter_mut().for_each(|speed| *speed *= sense);
                        }
                    }
                    if let Some(of) = inertia {
                        (of.inertia, of.centre_of_mass) = (l * l * of.inertia, self.inner(of.centre_of_mass));
                    }
                }
                Motion::Free {
                    inertia,
                    centre_of_mass,
                    start_position,
                    start_angle,
                    start_velocity,
                    start_speed,
                    ..
                } => {
                    *inertia *= l * l;
                    *centre_of_mass = self.inner(*centre_of_mass);
                    (*start_position, *start_angle) =
                        (self.vector(*start_position), self.angle(*start_angle));
                    start_velocity.iter_mut().for_each(|u| *u = self.vector(*u));
                    start_speed.iter_mut().for_each(|w| *w *= sense);
                }
            }
        }
        for joint in &mut scene.joints {
            place(&mut joint.journal);
            place(&mut joint.bushing);
            // Fixed bodies keep the angle zero.
            let turn = |body: usize| if fixed[body] { self.turn } else { 0.0 };
            let (first, second) = (turn(joint.journal.body), turn(joint.bushing.body));
            let relative = |angle: f64| sense * angle + second - first;
            if let Some(friction) = &mut joint.friction {
                (friction.speed, friction.size) = (l * friction.speed, l * friction.size);
            }
            match &mut joint.kind {
                JointKind::Revolute => {}
                JointKind::Prismatic { axis, angle } => {
                    (*axis, *angle) = (sense * *axis + second, relative(*angle));
                }
                JointKind::Fixed { angle } => *angle = relative(*angle),
                JointKind::Clearance(clearance) => self.hinge(clearance),
                JointKind::Guide(guide) => {
                    (guide.axis, guide.angle) = (sense * guide.axis + second, relative(guide.angle));
                    self.guide(guide);
                }
                other => unreachable!("{other:?} is in no scene of these tests"),
            }
        }
        for load in &mut scene.loads {
            match load {
                Load::DirectionalSpring { at, anchor, direction, free_length, .. } => {
                    place(at);
                    place(anchor);
                    (*direction, *free_length) = (self.direction(*direction), l * *free_length);
                }
                Load::Spring { a, b, free_length, .. } => {
                    place(a);
                    place(b);
                    *free_length *= l;
                }
                Load::ConstantForce { at, force, .. } => {
                    place(at);
                    *force = self.vector(*force);
                }
                Load::ConstantTorque { torque, .. } => *torque *= sense * l * l,
                Load::TorsionSpring { a, b, stiffness, damping, free_angle, .. } => {
                    let turn = |body: usize| if fixed[body] { self.turn } else { 0.0 };
                    *free_angle = sense * *free_angle + turn(*b) - turn(*a);
                    (*stiffness, *damping) = (l * l * *stiffness, l * l * *damping);
                }
                Load::Motor { stall_torque, no_load_speed, .. } => {
                    (*stall_torque, *no_load_speed) = (sense * l * l * *stall_torque, sense * *no_load_speed);
                }
                Load::Drag { at, direction, quadratic, flow, .. } => {
                    place(at);
                    *direction = self.direction(*direction);
                    (*quadratic, *flow) = (*quadratic / l, l * *flow);
                }
                other => unreachable!("{other:?} is in no scene of these tests"),
            }
        }
        for output in &mut scene.outputs {
            match &mut output.kind {
                OutputKind::PositionError { at, .. } | OutputKind::Acceleration { at, .. } => place(at),
                OutputKind::PositionBacklash { at, direction, .. } => {
                    place(at);
                    *direction = self.angle(*direction);
                }
                _ => {}
            }
        }
        scene.gravity = self.vector(scene.gravity);
        scene
    }

    fn material(&self, material: &mut Material) {
        material.elastic_modulus /= self.scale;
    }

    fn damping(&self, damping: &mut ContactDamping) {
        match damping {
            ContactDamping::None => {}
            ContactDamping::HuntCrossley { factor } => *factor /= self.scale,
            ContactDamping::Restitution { least_speed, .. } => *least_speed *= self.scale,
        }
    }

    fn hinge(&self, hinge: &mut Clearance) {
        let l = self.scale;
        let lengths = [
            &mut hinge.journal_radius,
            &mut hinge.bushing_radius,
            &mut hinge.width,
            &mut hinge.friction_speed,
        ];
        lengths.into_iter().chain(hinge.wall.as_mut()).for_each(|x| *x *= l);
        self.material(&mut hinge.journal_material);
        self.material(&mut hinge.bushing_material);
        self.damping(&mut hinge.contact_damping);
        hinge.wear_coefficient *= l;
        hinge.journal_wear_coefficient.iter_mut().for_each(|k| *k *= l);
    }

    fn guide(&self, guide: &mut GuideClearance) {
        let l = self.scale;
        let lengths = [
            &mut guide.length,
            &mut guide.height,
            &mut guide.width,
            &mut guide.clearance,
            &mut guide.friction_speed,
        ];
        lengths.into_iter().chain(&mut guide.reach).for_each(|x| *x *= l);
        self.material(&mut guide.slider_material);
        self.material(&mut guide.guide_material);
        self.damping(&mut guide.contact_damping);
        if let Some(wear) = &mut guide.wear {
            wear.coefficient *= l;
            wear.slider_coefficient.iter_mut().for_each(|k| *k *= l);
        }
    }
}
