//! Loads between prescribed bodies alone: they act on no free body, but the drives carry them.

use super::frame::Frame;
use super::island_frames::IslandFrames;
use super::load::IslandLoad;
use super::prescribed::Prescribed;
use common::scene::{Motion, Scene};

/// Loads on one prescribed body that act on no free body.
pub struct ExternalLoads {
    loads: Vec<IslandLoad>,
    prescribed: Vec<Prescribed>,
    /// Frame of the body.
    frame: usize,
}

impl ExternalLoads {
    /// The loads of a scene on `body`.
    pub(crate) fn new(scene: &Scene, body: usize) -> Self {
        let mut frames = IslandFrames::new(scene, vec![]);
        let frame = frames.frame(body);
        let is_prescribed = |b: &usize| !matches!(scene.bodies[*b].motion, Motion::Free { .. });
        let loads: Vec<IslandLoad> = scene
            .loads
            .iter()
            .filter(|load| {
                let bodies = load.bodies();
                bodies.contains(&body) && bodies.iter().all(is_prescribed)
            })
            .map(|load| IslandLoad::new(load, &mut frames))
            .collect();
        ExternalLoads { loads, prescribed: frames.prescribed(), frame }
    }

    /// Moment of the loads about the body's axis at time `t` [s] [N m].
    pub(crate) fn moment(&self, t: f64) -> f64 {
        if self.loads.is_empty() {
            return 0.0;
        }
        let frames: Vec<Frame> = self.prescribed.iter().map(|p| p.frame(t)).collect();
        let on_body = |load: &IslandLoad| -> f64 {
            let force = load.force(t, &frames);
            let sides = force.frames.iter().enumerate().filter(|&(_, &frame)| frame == self.frame);
            sides.map(|(side, _)| force.f[3 * side + 2]).sum()
        };
        self.loads.iter().map(on_body).sum()
    }
}
