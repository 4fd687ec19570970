//! A scene as its author wrote it: found by name or file, checked as a whole, and resolved for any sample of its random
//! variables.

use super::builtin;
use super::conditioned::conditions;
use super::context::{NONE, Overrides};
use super::edit::rewritten;
use super::extends::{SCENE_FILE, flatten, read, unknown_scene};
use super::faults::{Fault, FaultKind, Faults, in_unit};
use super::input::InputFile;
use super::layers::{Layer, located, location};
use super::location::Location;
use super::model::Scene;
use super::quantity::Quantity;
use super::resolve::{Resolved, resolve};
use super::section::Section;
use super::simulator::settle_folder;
use super::variables::MeasuredVariable;
use super::warnings::{Warning, magnitudes, warnings};
use crate::random::RandomVariable;
use std::collections::BTreeMap;
use std::path::Path;
use toml::Table;

/// A valid scene with everything needed to resolve it for other values of its random variables.
#[derive(Debug, Clone)]
pub struct SceneSource {
    origin: String,
    text: String,
    /// The tables of this scene as written, merged with those of the scenes that it extends.
    pub document: Table,
    nominal: Scene,
    /// The quantities that the scene writes, by the path of their key.
    pub quantities: BTreeMap<String, Quantity>,
    /// Parameters that nothing in the scene depends on, sorted: usually a typing error. A parameter that a random
    /// variable changes is unused if nothing else reads it.
    pub unused_parameters: Vec<String>,
    /// The random variables that have measured samples, with these.
    pub measured: Vec<MeasuredVariable>,
    layers: Vec<Layer>,
}

/// Keys of joints that belong to a program which gives cycles.
const KEYS_OF_PROGRAM: &str = "axis angle friction friction_speed film_damping contact_damping.hunt_crossley contact_damping.restitution";

impl SceneSource {
    /// Names of the built-in scenes.
    pub fn builtin_names() -> Vec<&'static str> {
        builtin::SCENES.iter().map(|(name, _)| *name).collect()
    }

    /// A built-in scene.
    ///
    /// # Errors
    /// The name is unknown; the fault suggests the nearest one.
    pub fn builtin(name: &str) -> Result<Self, Faults> {
        let text = builtin::text(name).ok_or_else(|| Faults::one(name, "", unknown_scene(name)))?;
        Self::parse(text, name)
    }

    /// Loads a built-in scene by name, or the scene in a file.
    ///
    /// # Errors
    /// Every fault of the scene, or one that says that it cannot be found or read.
    pub fn load(name_or_path: &str) -> Result<Self, Faults> {
        if let Some(text) = builtin::text(name_or_path) {
            return Self::parse(text, name_or_path);
        }
        let path = Path::new(name_or_path);
        let looks_like_path =
            path.extension().is_some_and(|extension| extension == "toml") || path.components().count() > 1;
        if !path.exists() && !looks_like_path {
            return Err(Faults::one(name_or_path, "", unknown_scene(name_or_path)));
        }
        Self::from_text(read(path, SCENE_FILE)?, name_or_path, path.parent())
    }

    /// A scene from its text; `origin` names it in faults. It may extend built-in scenes, not files.
    ///
    /// # Errors
    /// Every fault of the scene.
    pub fn parse(text: &str, origin: &str) -> Result<Self, Faults> {
        Self::from_text(text.to_owned(), origin, None)
    }

    fn from_text(text: String, origin: &str, folder: Option<&Path>) -> Result<Self, Faults> {
        let (document, layers) = flatten(text, origin, folder)?;
        Self::checked(document, layers.clone(), origin, folder).map_err(|faults| located(&layers, faults))
    }

    fn checked(
        mut document: Table,
        layers: Vec<Layer>,
        origin: &str,
        folder: Option<&Path>,
    ) -> Result<Self, Faults> {
        let settled = settle_folder(&mut document, folder);
        // The text must stand alone where it is sent to and stored.
        let text = match layers.as_slice() {
            [own] if !settled && own.imported.is_empty() => own.text.clone(),
            all => rewritten(&all.iter().map(|layer| &*layer.text).collect::<Vec<_>>(), &document),
        };

        // Values as written, then the variables, then the nominal scene with every variable at its mean.
        let Resolved { scene, measured, seen, used, .. } = resolve(origin, &document, &NONE, true)?;
        let parameters = document.get("parameters").and_then(toml::Value::as_table);
        // A program receives the variables, also those whose parameters nothing else reads.
        let of_program = scene.variables.iter().filter(|_| scene.simulator.is_some());
        let given: Vec<&str> =
            of_program.flat_map(|variable| &variable.changes).map(String::as_str).collect();
        let is_unused =
            |name: &&String| !used.contains(*name) && !given.contains(&&*format!("parameters.{name}"));
        let unused = parameters.into_iter().flat_map(Table::keys).filter(is_unused);
        let mut unused_parameters: Vec<String> = unused.cloned().collect();
        unused_parameters.sort();
        let mut source = SceneSource {
            origin: origin.to_owned(),
            text,
            document,
            nominal: scene,
            quantities: seen,
            unused_parameters,
            measured,
            layers,
        };
        source.nominal = source.resolve_sample(&source.means())?;
        source.check_bounds()?;
        Ok(source)
    }

    /// The scene with changes in its tables; `origin` names it in faults. Its text keeps the comments, order and notation of
    /// everything else, and is the same if nothing changes.
    ///
    /// # Errors
    /// The faults of the changed scene, without places: no person wrote its text.
    pub fn edited(&self, origin: &str, edit: impl FnOnce(&mut Table)) -> Result<Self, Faults> {
        let mut document = self.document.clone();
        edit(&mut document);
        Self::parse(&rewritten(&[&self.text], &document), origin).map_err(Faults::without_places)
    }

    /// The file, or the name of a built-in scene.
    pub fn origin(&self) -> &str {
        &self.origin
    }

    /// TOML text of this scene that needs no other file: for a scene that extends another one, both merged.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// FNV-1a hash of the text, 128 bit, equal on every machine and in every version.
    pub fn digest(&self) -> u128 {
        digest(&self.text)
    }

    /// The random variables, in the order of a sample.
    pub fn variables(&self) -> &[RandomVariable] {
        &self.nominal.variables
    }

    /// Index of the random variable of this name.
    pub fn variable(&self, name: &str) -> Option<usize> {
        self.variables().iter().position(|variable| variable.name == name)
    }

    /// The means of the random variables `(d,)`, SI.
    pub fn means(&self) -> Vec<f64> {
        self.variables().iter().map(|variable| variable.distribution.parent_mean()).collect()
    }

    /// What is valid but most likely not meant, with the path of the key.
    pub fn warnings(&self) -> Vec<Warning> {
        let scene = &self.nominal;
        let everywhere = |(_, conditions): &(usize, Vec<&str>)| conditions.len() == scene.conditions.len();
        let message = "has no effect: every condition sets what it changes; let the variable change a parameter that the conditions \
                       multiply, as in \"1.5 * torque\"";
        let overridden = self.overridden_variables().into_iter().filter(everywhere);
        let key = |k: usize| format!("variables.{}", scene.variables[k].name);
        let without_effect = overridden.map(|(k, _)| Warning::new(key(k), message)).collect();
        [warnings(scene), magnitudes(scene), without_effect, self.keys_of_program()].concat()
    }

    /// Keys of joints in whose place a program that gives cycles has its own.
    fn keys_of_program(&self) -> Vec<Warning> {
        let joints = self.nominal.joints.iter().filter(|_| self.nominal.simulator.is_some());
        let keys = joints
            .flat_map(|joint| KEYS_OF_PROGRAM.split(' ').map(|key| format!("joints.{}.{key}", joint.name)));
        let message =
            "has no effect: the program has its own; let a random variable without `changes` reach it";
        keys.filter(|key| self.quantities.contains_key(key)).map(|key| Warning::new(key, message)).collect()
    }

    /// Random variables, by their number, without effect under the operating conditions of these names, which set what they change.
    pub fn overridden_variables(&self) -> Vec<(usize, Vec<&str>)> {
        let (scene, means) = (&self.nominal, self.means());
        let mut found = Vec::new();
        let varying = scene.variables.iter().enumerate().filter(|(_, v)| !v.distribution.is_constant());
        for (k, variable) in varying {
            let mut sample = means.clone();
            sample[k] = variable.distribution.from_standard_normal(1.0);
            let Ok(moved) = self.resolve_sample(&sample) else { continue };
            let pairs = scene.conditions.iter().zip(&moved.conditions);
            let same = pairs.filter(|(condition, moved)| condition.scene == moved.scene);
            let names: Vec<&str> = same.map(|(condition, _)| &*condition.name).collect();
            // One that changes shares, or a condition itself, changes nothing else.
            let without_conditions = |scene: &Scene| Scene { conditions: vec![], ..scene.clone() };
            if !names.is_empty() && without_conditions(&moved) != without_conditions(scene) {
                found.push((k, names));
            }
        }
        found
    }

    /// Value of the quantity at this key as the scene writes it [SI], whatever random variable changes it; `None` if there is no
    /// such quantity.
    pub fn quantity(&self, key: &str) -> Option<f64> {
        self.quantities.get(key).map(|quantity| quantity.value)
    }

    /// Place of a key in the texts of this scene and those it extends, or of the longest part of its path that they contain.
    pub fn location(&self, key: &str) -> Option<Location> {
        location(&self.layers, key)
    }

    /// The nominal scene: every random variable at its mean.
    pub fn nominal(&self) -> &Scene {
        &self.nominal
    }

    /// The scene for one sample `(d,)` of the random variables, SI.
    ///
    /// # Errors
    /// The sample has another length, or gives an invalid scene (e.g. a bushing smaller than its journal).
    pub fn resolve_sample(&self, sample: &[f64]) -> Result<Scene, Faults> {
        let expected = self.variables().len();
        if sample.len() != expected {
            let found = sample.len();
            let message =
                format!("a sample of {found} values was given, the scene has {expected} random variables");
            return Err(Faults::one(&self.origin, "", message));
        }
        let pairs = self.variables().iter().zip(sample);
        let overrides =
            pairs.flat_map(|(variable, &value)| variable.changes.iter().map(move |key| (key.clone(), value)));
        self.resolve_overridden(&overrides.collect())
    }

    /// The nominal scene with some values changed: `(name, SI value)`, where the name is a random variable or the
    /// path of a key, e.g. `parameters.rod_length`. It is the nominal scene that its author would have written with these
    /// values: means of random variables follow the keys. A key takes precedence over a variable that changes it too.
    ///
    /// # Errors
    /// An unknown name, or values that give an invalid scene.
    pub fn resolve_with(&self, settings: &[(String, f64)]) -> Result<Scene, Faults> {
        let (of_variables, keys): (Vec<_>, Vec<_>) =
            settings.iter().cloned().partition(|(name, _)| self.variable(name).is_some());
        let variables = self.variables_with(&keys)?;
        let mut overrides = Overrides::new();
        for variable in &variables {
            let set = of_variables.iter().rev().find(|(name, _)| *name == variable.name);
            let value = set.map_or_else(|| variable.distribution.parent_mean(), |(_, value)| *value);
            overrides.extend(variable.changes.iter().map(|key| (key.clone(), value)));
        }
        overrides.extend(keys);
        Ok(Scene { variables, ..self.resolve_overridden(&overrides)? })
    }

    /// The random variables with the quantities at some keys set to other values `(key, SI value)`: a variable that states no
    /// mean has the value of the keys that it changes, which may follow from a parameter.
    ///
    /// # Errors
    /// An unknown key, or values that give an invalid scene.
    pub fn variables_with(&self, keys: &[(String, f64)]) -> Result<Vec<RandomVariable>, Faults> {
        if let Some((key, _)) = keys.iter().find(|(key, _)| !self.quantities.contains_key(key)) {
            return Err(Faults::one(&self.origin, "", self.unknown_setting(key)));
        }
        if keys.is_empty() {
            return Ok(self.variables().to_vec());
        }
        let overrides = keys.iter().cloned().collect();
        Ok(resolve(&self.origin, &self.document, &overrides, true)?.scene.variables)
    }

    /// The means `(d,)` with some variables set to other values, SI: the inputs of an external simulator.
    ///
    /// # Errors
    /// A name that is no random variable.
    pub fn sample_with(&self, settings: &[(String, f64)]) -> Result<Vec<f64>, Faults> {
        let mut sample = self.means();
        for (name, value) in settings {
            let names = self.variables().iter().map(|variable| variable.name.as_str());
            let unknown = || FaultKind::unknown_reference("variable", name, names);
            let place = self.variable(name).ok_or_else(|| Faults::one(&self.origin, "", unknown()))?;
            sample[place] = *value;
        }
        Ok(sample)
    }

    fn resolve_overridden(&self, overrides: &Overrides) -> Result<Scene, Faults> {
        let resolved = resolve(&self.origin, &self.document, overrides, false)?;
        let (variables, correlations) = (self.nominal.variables.clone(), self.nominal.correlations.clone());
        let conditions =
            conditions(&self.origin, &self.document, overrides, &resolved.scene, &resolved.conditions)?;
        Ok(Scene { variables, correlations, conditions, ..resolved.scene })
    }

    /// Checks that the scene is valid with every variable at each of its bounds, or its 1e-6 and 1 - 1e-6 quantiles, and
    /// the others at their means.
    fn check_bounds(&self) -> Result<(), Faults> {
        let means = self.means();
        let mut faults = Vec::new();
        for (i, variable) in self.variables().iter().enumerate() {
            let ((least, most), support) = (variable.distribution.limits(), variable.distribution.support());
            for (bound, hard) in [(least, least == support.0), (most, most == support.1)] {
                let mut sample = means.clone();
                sample[i] = bound;
                if let Err(Faults(found)) = self.resolve_sample(&sample) {
                    let fault = found.first().map(|fault| format!("{}: {}", fault.key, fault.kind));
                    let (value, fault) = (in_unit(bound, &variable.unit), fault.unwrap_or_default());
                    let (end, remedy) = match hard {
                        true => ("a bound", "use a smaller std or truncation, or lower and upper"),
                        false => ("a 1e-6 tail quantile", "use a smaller std, or a distribution with bounds"),
                    };
                    let message = format!(
                        "at {value}, {end} of this variable, the scene is invalid: {fault}; {remedy}"
                    );
                    faults.push(Fault::new(&self.origin, format!("variables.{}", variable.name), message));
                }
            }
        }
        if faults.is_empty() { Ok(()) } else { Err(Faults(faults)) }
    }
}

/// FNV-1a hash of a text, 128 bit: it distinguishes texts but does not resist forgery.
pub fn digest(text: &str) -> u128 {
    const BASIS: u128 = 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d;
    const PRIME: u128 = 0x0000_0000_0100_0000_0000_0000_0000_013b;
    text.bytes().fold(BASIS, |hash, byte| (hash ^ u128::from(byte)).wrapping_mul(PRIME))
}

/// The published results of a built-in scene by name, in SI units and cycles; empty if none are known.
///
/// They stand with their source in `common/scenes/NAME.reference.toml`.
///
/// # Errors
/// Faults of that file.
pub fn published_results(scene: &str) -> Result<BTreeMap<String, f64>, Faults> {
    let Some(text) = builtin::reference(scene) else { return Ok(BTreeMap::new()) };
    InputFile::parse(text, scene)?.read(|file| {
        let published = file.section("published", "a table of results");
        let results = published.iter().flat_map(Section::entries).filter_map(|(name, value)| {
            let found = file.cx.value(&format!("published.{name}"), value, None)?;
            Some((name.clone(), found.value))
        });
        results.collect()
    })
}
