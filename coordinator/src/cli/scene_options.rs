//! The scene of a command as typed: its name or file with the values set in it, and the names that completions offer.

use clap::builder::{PossibleValue, StringValueParser, TypedValueParser};
use clap::{Arg, Args, Command, Error};
use common::accuracy::{Accuracy, NamedAccuracy};
use common::scene::{Faults, SceneSource};
use coordinator::analyses::scene_settings::scene_with;
use std::ffi::OsStr;

/// The scene of a command that names none.
pub const DEFAULT_SCENE: &str = "flapping-wing";

/// The scene that a command reads.
#[derive(Debug, Clone, Args)]
pub struct SceneName {
    /// Scene file, or name of a built-in scene
    #[arg(default_value = DEFAULT_SCENE, value_parser = scene_name(), hide_possible_values = true)]
    scene: String,
    /// Scene, as earlier versions named it
    #[arg(long = "scene", hide = true, value_name = "SCENE", conflicts_with = "scene")]
    named: Option<String>,
}

impl SceneName {
    /// Name or file of the scene.
    pub fn get(&self) -> &str {
        self.named.as_ref().unwrap_or(&self.scene)
    }
}

/// Values set in a scene.
#[derive(Debug, Clone, Default, Args, PartialEq)]
#[command(next_help_heading = "Scene")]
pub struct SetArguments {
    /// Set a quantity of the scene by its key, the mean of a random variable by its name, or a distribution or threshold as in
    /// `what-if`; repeatable
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
}

/// A scene with values set in it.
#[derive(Debug, Clone, Args)]
pub struct SceneArguments {
    #[command(flatten)]
    pub name: SceneName,
    #[command(flatten)]
    pub values: SetArguments,
}

impl SceneArguments {
    /// The scene.
    ///
    /// # Errors
    /// [`Faults`] of the scene and of the values.
    pub fn load(&self) -> Result<SceneSource, Faults> {
        load_with(self.name.get(), &self.values.set)
    }
}

/// The scene of this name or file with these settings.
///
/// # Errors
/// [`Faults`] of the scene and of the settings.
pub fn load_with(name: &str, set: &[String]) -> Result<SceneSource, Faults> {
    let source = SceneSource::load(name)?;
    if set.is_empty() { Ok(source) } else { scene_with(&source, set) }
}

/// Parser of a scene; completions offer the built-in ones, and any path is permitted.
pub fn scene_name() -> impl TypedValueParser<Value = String> {
    Suggested(SceneSource::builtin_names())
}

/// Parser of an accuracy; completions offer the presets.
pub fn accuracy_name() -> impl TypedValueParser<Value = NamedAccuracy> {
    Suggested(Accuracy::NAMES.to_vec()).try_map(|name| name.parse())
}

/// Parser of any text, of which completions offer these names.
#[derive(Debug, Clone)]
struct Suggested(Vec<&'static str>);

impl TypedValueParser for Suggested {
    type Value = String;

    fn parse_ref(&self, of: &Command, argument: Option<&Arg>, text: &OsStr) -> Result<String, Error> {
        StringValueParser::new().parse_ref(of, argument, text)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new(self.0.iter().map(PossibleValue::new)))
    }
}
