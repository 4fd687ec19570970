//! Identity of a simulator: what a coordinator and a worker that has the program itself agree by.

use super::reply::Expected;
use crate::scene::source::digest;
use crate::scene::{Condition, CycleProgram, ExternalSimulator, Scene};
use serde::{Deserialize, Serialize};
use std::fmt;

/// Name of a scene that names its own simulator, and digest of what its program reads and returns.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct SimulatorId {
    /// Name of the scene.
    pub scene: String,
    /// Digest of inputs, outputs, checkpoints and version, FNV-1a, 128 bit.
    pub digest: u128,
}

impl SimulatorId {
    /// Identity of `simulator` in `scene`: the scene's name; names and units of the inputs, names, units and numbers of
    /// values of the outputs, and the checkpoints, each in order; and the version that the scene states. Command, folder,
    /// address, time limit and distributions are not part of it. Of a program that gives cycles also joints, wear, life, accuracy, operating
    /// conditions, and what the variables change: the worker wears the joints by its own scene.
    pub fn new(simulator: &ExternalSimulator, scene: &Scene) -> Self {
        let Expected { inputs, outputs, cycles } = Expected::from_scene(scene);
        let input_units: Vec<&str> = scene.variables.iter().map(|variable| variable.unit.as_str()).collect();
        let output_units: Vec<String> =
            scene.outputs.iter().map(|output| output.kind.unit().symbol().to_owned()).collect();
        let parts = (&simulator.version, (inputs, input_units), (outputs, output_units), cycles);
        let mut text = json(&parts);
        if let Some(CycleProgram { tier, .. }) = &simulator.cycles {
            let changes: Vec<&[String]> = scene.variables.iter().map(|variable| &*variable.changes).collect();
            let wear = (tier, &scene.joints, &scene.wear, &scene.life, &scene.accuracy, changes);
            text += &json(&wear);
            for Condition { name, share, scene, parameters } in &scene.conditions {
                text += &json(&(name, share, parameters, &scene.joints, &scene.life));
            }
        }
        text += &simulator.levels.join("\n");
        Self { scene: scene.name.clone(), digest: digest(&text) }
    }

    /// The scene and the simulator of it, if it names one.
    pub fn of_scene(scene: &Scene) -> Option<Self> {
        scene.simulator.as_ref().map(|simulator| Self::new(simulator, scene))
    }
}

fn json(parts: &impl Serialize) -> String {
    serde_json::to_string(parts).expect("lists of texts and numbers are JSON")
}

impl fmt::Display for SimulatorId {
    /// The name and the first eight digits of the digest, as `coordinator check` prints them.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({:08x})", self.scene, self.digest >> 96)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::SceneSource;

    const BEAM: &str = "scene = { name = \"beam\" }\nsimulator = { program = [\"beam\"], version = \"1\", timeout = \"1 s\" }\n\
        life = { cycles = 20, checkpoint_every = 10 }\noutputs = [{ name = \"sag\", unit = \"mm\" }]\n\
        limit_states = [{ name = \"bent\", output = \"sag\", threshold = 1 }]\n\
        variables = [{ name = \"load\", mean = \"500 N\", std = \"10 %\" }, { name = \"x\", mean = 2, std = 1 }]";

    fn id(from: &str, to: &str) -> SimulatorId {
        assert!(BEAM.contains(from), "{from}");
        let source = SceneSource::parse(&BEAM.replace(from, to), "beam").unwrap();
        SimulatorId::of_scene(source.nominal()).unwrap()
    }

    #[test]
    fn what_a_program_reads_and_returns_makes_its_identity() {
        let beam = id("1 s", "1 s");
        for (from, to) in [
            ("program = [\"beam\"]", "program = [\"/opt/beam/run\", \"--fast\"]"),
            ("program = [\"beam\"]", "umbridge = \"http://127.0.0.1:1\""),
            ("1 s", "1 h"),
            ("500 N", "600 N"),
            ("threshold = 1", "threshold = 2"),
        ] {
            assert_eq!(id(from, to), beam, "{to}");
        }
        for (from, to) in [
            ("version = \"1\"", "version = \"2\""),
            ("\"load\"", "\"force\""),
            ("\"500 N\"", "500"),
            ("version = \"1\"", "version = \"1\", levels = [\"a\", \"b\"]"),
            ("unit = \"mm\"", "unit = \"m\""),
            ("unit = \"mm\"", "unit = \"mm\", values = 1"),
            ("checkpoint_every = 10", "checkpoint_every = 20"),
            ("name = \"beam\"", "name = \"bar\""),
        ] {
            assert_ne!(id(from, to), beam, "{to}");
        }
        // The same on every machine and in every version: workers of another build are to agree.
        assert_eq!(beam.to_string().len(), "beam (00000000)".len());
    }
}
