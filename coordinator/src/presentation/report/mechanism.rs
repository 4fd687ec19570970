//! The motion of the nominal mechanism over a cycle: poses of its bodies, and orbits of its journals in their bores.

use common::outputs::{BodyMotion, CycleHistory};
use common::scene::monotone::monotone_value;
use common::scene::{Attachment, Joint, JointKind, Mesh, MeshForm, Motion, Scene};

/// Position `(2,)` [m] and angle [rad] of a body.
pub type Pose = ([f64; 2], f64);

/// Poses of all bodies at every instant of a cycle `(n, bodies)`; `None` if the cycle does not include the motion of
/// every body.
pub fn poses(scene: &Scene, cycle: &CycleHistory) -> Option<Vec<Vec<Pose>>> {
    if cycle.motion.is_empty() {
        return None;
    }
    let motions = scene.bodies.iter().map(|body| match body.motion {
        Motion::Fixed => Some(None),
        _ => cycle.motion.iter().find(|motion| motion.body == body.name).map(Some),
    });
    let motions: Vec<Option<&BodyMotion>> = motions.collect::<Option<_>>()?;
    let pose = |motion: &Option<&BodyMotion>, k: usize| match motion {
        None => Some(([0.0; 2], 0.0)),
        Some(motion) => Some((*motion.position.get(k)?, *motion.angle.get(k)?)),
    };
    (0..cycle.time.len()).map(|k| motions.iter().map(|motion| pose(motion, k)).collect()).collect()
}

/// Place [m] of a point of a body in a pose, given in the frame of the body.
pub fn of_body(([x, y], angle): &Pose, [a, b]: [f64; 2]) -> [f64; 2] {
    let (sin, cos) = angle.sin_cos();
    [x + cos * a - sin * b, y + sin * a + cos * b]
}

/// Place [m] of a point in these poses of all bodies.
pub fn place(poses: &[Pose], point: &Attachment) -> [f64; 2] {
    of_body(&poses[point.body], point.position)
}

/// Lower left and upper right corner of the rectangle around points; not finite if a coordinate is no number.
pub fn extent(points: impl Iterator<Item = [f64; 2]>) -> [[f64; 2]; 2] {
    let wider = |ends: [[f64; 2]; 2], point: [f64; 2]| {
        // A value that is not a number must not be lost in a minimum.
        let keep = |a: f64, b: f64, less: bool| if b.is_nan() || (b < a) == less { b } else { a };
        [0, 1].map(|end: usize| [0, 1].map(|k: usize| keep(ends[end][k], point[k], end == 0)))
    };
    points.fold([[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]], wider)
}

/// Vector from the centre of the bushing to that of the journal in these poses, in the frame of the bushing's body [m].
pub fn eccentricity(poses: &[Pose], joint: &Joint) -> [f64; 2] {
    let (journal, bushing) = (place(poses, &joint.journal), place(poses, &joint.bushing));
    let (sin, cos) = poses[joint.bushing.body].1.sin_cos();
    let [x, y] = [journal[0] - bushing[0], journal[1] - bushing[1]];
    [cos * x + sin * y, cos * y - sin * x]
}

/// Outline of a body in its own frame, without repeated points `(p, 2)` [m]: its joints; for a moving body also its
/// named points; for a driven one also its pivot; for a free one that would be a single point also its centre of mass.
pub fn outline(scene: &Scene, body: usize) -> Vec<[f64; 2]> {
    let shown = &scene.bodies[body];
    let pivot = matches!(shown.motion, Motion::Driven { .. }).then_some([0.0; 2]);
    let points = shown.points.iter().filter(|_| shown.motion != Motion::Fixed).map(|point| point.position);
    let ends = scene.joints.iter().flat_map(|joint| [joint.journal, joint.bushing]);
    let mut outline: Vec<[f64; 2]> = Vec::new();
    let mut add = |point: [f64; 2]| {
        if !outline.iter().any(|p| (p[0] - point[0]).hypot(p[1] - point[1]) < 1e-9) {
            outline.push(point);
        }
        outline.len()
    };
    let ends = ends.filter(|end| end.body == body).map(|end| end.position);
    let corners = pivot.into_iter().chain(ends).chain(points).map(&mut add).last().unwrap_or(0);
    if let (Motion::Free { centre_of_mass, .. }, 0 | 1) = (&shown.motion, corners) {
        add(*centre_of_mass);
    }
    outline
}

/// Points of a body that the ground holds, in its own frame `(s, 2)` [m]: the pivot of a driven body; the joints of a fixed
/// one, but for those on a rail.
pub fn supports(scene: &Scene, body: usize) -> Vec<[f64; 2]> {
    match scene.bodies[body].motion {
        Motion::Free { .. } => vec![],
        Motion::Driven { .. } => vec![[0.0; 2]],
        Motion::Fixed => {
            use JointKind::{Cam, Guide, Mesh, Prismatic, Slot};
            let slides = |kind: &JointKind| {
                matches!(kind, Prismatic { .. } | Guide(_) | Slot { .. } | Mesh(_) | Cam { .. })
            };
            let held = scene.joints.iter().filter(|joint| !slides(&joint.kind));
            let ends = held.flat_map(|joint| [joint.journal, joint.bushing]);
            ends.filter(|end| end.body == body).map(|end| end.position).collect()
        }
    }
}

/// Ends of the rail of a prismatic joint or a guide in the frame of its second body `(2, 2)` [m]: the way of the first body's point
/// over the poses of a cycle `(n, bodies)`; `None` for another joint.
pub fn rail(joint: &Joint, cycle: &[Vec<Pose>]) -> Option<[[f64; 2]; 2]> {
    let axis = match &joint.kind {
        JointKind::Prismatic { axis, .. } => *axis,
        JointKind::Guide(guide) => guide.axis,
        JointKind::Slot { axis } => *axis,
        _ => return None,
    };
    let (sin, cos) = axis.sin_cos();
    let [a, b] = joint.bushing.position;
    let along = cycle.iter().map(|poses| {
        let [x, y] = eccentricity(poses, joint);
        x * cos + y * sin
    });
    let (low, high) =
        along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), way: f64| (low.min(way), high.max(way)));
    (low <= high).then(|| [low, high].map(|way| [a + way * cos, b + way * sin]))
}

/// Corners of a circle, the last one that of the first.
const CORNERS: usize = 48;

/// Circle of a drawing in true size: centre `(2,)` and radius [m].
pub type Circle = ([f64; 2], f64);

/// Journal and bore of a hinge with clearance, and the pitch circles of wheels, in these poses.
pub fn circles(poses: &[Pose], joint: &Joint) -> Vec<Circle> {
    let (a, b) = (place(poses, &joint.journal), place(poses, &joint.bushing));
    match &joint.kind {
        JointKind::Clearance(bearing) => vec![(a, bearing.journal_radius), (b, bearing.bushing_radius)],
        JointKind::Mesh(Mesh { form: MeshForm::Rack, radii: [_, radius], .. }) => vec![(b, *radius)],
        JointKind::Mesh(Mesh { radii, .. }) => vec![(a, radii[0]), (b, radii[1])],
        _ => vec![],
    }
}

/// Corners `(n, 2)` [m] of an outline around a centre, the last one that of the first; `radius` by angle [rad].
pub fn around(radius: impl Fn(f64) -> f64, [x, y]: [f64; 2]) -> Vec<[f64; 2]> {
    let corner = |k: usize| {
        let angle = std::f64::consts::TAU * k as f64 / CORNERS as f64;
        [x + radius(angle) * angle.cos(), y + radius(angle) * angle.sin()]
    };
    (0..=CORNERS).map(corner).collect()
}

/// Lines that show strands, racks, cams and linear drives in these poses, each `(n, 2)` [m].
pub fn shapes(poses: &[Pose], joint: &Joint) -> Vec<Vec<[f64; 2]>> {
    let (a, b) = (place(poses, &joint.journal), place(poses, &joint.bushing));
    let beside = |[x, y]: [f64; 2], [dx, dy]: [f64; 2], far: f64| [x + far * dx, y + far * dy];
    match &joint.kind {
        JointKind::LinearDrive(_) => {
            let length = (a[0] - b[0]).hypot(a[1] - b[1]).max(f64::MIN_POSITIVE);
            let along = [(a[0] - b[0]) / length, (a[1] - b[1]) / length];
            let across = [-along[1], along[0]];
            // The cylinder over half of the length, and its rod.
            let (end, half) = (beside(b, along, 0.5 * length), 0.06 * length);
            let barrel = [(b, half), (end, half), (end, -half), (b, -half), (b, half)];
            vec![barrel.map(|(at, far)| beside(at, across, far)).into(), vec![end, a]]
        }
        JointKind::Mesh(Mesh {
            form: MeshForm::Rack, radii: [_, radius], direction, pressure_angle, ..
        }) => {
            let angle = direction[1].atan2(direction[0]) - pressure_angle;
            let along = [angle.cos(), angle.sin()];
            vec![vec![beside(a, along, -2.0 * radius), beside(a, along, 2.0 * radius)]]
        }
        JointKind::Mesh(Mesh { form: MeshForm::Belt, radii, direction: [x, y], .. }) => {
            let taut = [beside(a, [-y, *x], radii[0]), beside(b, [-y, *x], radii[1])];
            let length = (b[0] - a[0]).hypot(b[1] - a[1]).max(f64::MIN_POSITIVE);
            let line = [(b[0] - a[0]) / length, (b[1] - a[1]) / length];
            let mirrored = |p: [f64; 2]| {
                let across = (p[1] - a[1]) * line[0] - (p[0] - a[0]) * line[1];
                beside(p, [-line[1], line[0]], -2.0 * across)
            };
            vec![taut.to_vec(), taut.map(mirrored).to_vec()]
        }
        JointKind::Cam { direction: [x, y], lift } => {
            let (of_cam, axis) = (poses[joint.bushing.body].1, y.atan2(*x));
            // A point of the outline meets the axis when the cam has turned by the angle between them.
            vec![around(|angle| monotone_value(lift, of_cam + axis - angle), b)]
        }
        _ => vec![],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::test_study;

    #[test]
    fn the_orbit_is_in_the_frame_of_the_bushing() {
        let scene = &test_study::scene();
        let cycle = test_study::first_cycle();
        let poses = poses(scene, &cycle).unwrap();
        for joint in &scene.joints {
            for (poses, time) in poses.iter().zip(&cycle.time) {
                let ([x, y], [ex, ey]) = (eccentricity(poses, joint), test_study::eccentricity(*time));
                assert!((x - ex).hypot(y - ey) < 1e-12, "joint {}, {time} s: {x} {y}", joint.name);
            }
        }
        let mut unknown = cycle.clone();
        unknown.motion.pop();
        assert_eq!(super::poses(scene, &unknown), None);
    }

    #[test]
    fn a_driven_body_reaches_from_its_pivot() {
        let scene = &test_study::scene();
        assert_eq!(outline(scene, 1)[0], [0.0; 2]);
        assert_eq!(outline(scene, 1).len(), 7);
        assert_eq!(outline(scene, 2).len(), 6);
    }
}
