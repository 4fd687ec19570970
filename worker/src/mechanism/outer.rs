//! Loads that act between prescribed bodies alone: they move nothing, but whoever drives the bodies feels
//! them.

use super::frame::Frame;
use super::load::{IslandLoad, coupled_bodies};
use super::prescribed::Prescribed;
use super::topology::Place;
use common::scene::{Motion, Scene};

/// Such loads on one body.
pub struct OuterLoads {
    loads: Vec<IslandLoad>,
    prescribed: Vec<Prescribed>,
    /// Frame of the body.
    frame: usize,
}

impl OuterLoads {
    /// Those of a scene that act on `body`.
    pub fn on(scene: &Scene, body: usize) -> Self {
        let mut place = Place::new(scene, vec![]);
        let frame = place.frame(body);
        let given = |b: &usize| !matches!(scene.bodies[*b].motion, Motion::Free { .. });
        let loads: Vec<IslandLoad> = scene
            .loads
            .iter()
            .filter(|load| {
                let bodies = coupled_bodies(load);
                bodies.contains(&body) && bodies.iter().all(given)
            })
            .map(|load| place.load(load))
            .collect();
        let prescribed = place.touched().iter().filter_map(|&b| Prescribed::of(&scene.bodies[b])).collect();
        OuterLoads { loads, prescribed, frame }
    }

    /// Their moment about the body's axis at time `t` [N m].
    pub fn moment(&self, t: f64) -> f64 {
        if self.loads.is_empty() {
            return 0.0;
        }
        let frames: Vec<Frame> = self.prescribed.iter().map(|p| p.at(t)).collect();
        let on = |load: &IslandLoad| -> f64 {
            let force = load.force(t, &frames);
            let sides = force.frames.iter().enumerate().filter(|&(_, &frame)| frame == self.frame);
            sides.map(|(side, _)| force.f[3 * side + 2]).sum()
        };
        self.loads.iter().map(on).sum()
    }
}
