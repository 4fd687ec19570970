//! `coordinator init`: a commented scene to start from.

use super::imported;
use super::output::{file_of, unusable};
use super::{CommandError, Done, print, to_json};
use clap::Args;
use common::scene::{Faults, SceneSource, read_text};
use serde_json::json;
use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

/// Arguments of `coordinator init`.
#[derive(Debug, Clone, Args)]
pub struct InitArguments {
    /// Name of the scene: letters, digits, hyphens and underscores
    pub name: String,
    /// Read the mechanism from a file of a linkage program: .linkage2 (Linkage), text of PMKS, or a link of PMKS+
    #[arg(long, value_name = "FILE")]
    pub from: Option<PathBuf>,
    /// Folder for NAME.toml, created if missing [default: the working folder]; a path with an ending is the file
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// Text of the new scene; [`NAME`] in it is replaced by the name.
const TEMPLATE: &str = include_str!("init.toml");

/// Placeholder of the name in [`TEMPLATE`].
const NAME: &str = "@name@";

/// Writes the scene to a new file and prints the next commands.
///
/// # Errors
/// [`CommandError::BadInput`].
pub fn init(arguments: &InitArguments, as_json: bool) -> Done {
    let name = &arguments.name;
    let tame = !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || "-_".contains(c));
    if !tame || SceneSource::builtin_names().contains(&name.as_str()) {
        return Err(CommandError::refused(
            format_args!("name {name}"),
            "allowed are letters, digits, hyphens and underscores, at least one, and no built-in scene's name",
        ));
    }
    let file = file_of(arguments.out.as_deref().unwrap_or(Path::new(".")), &format!("{name}.toml"))?;
    let file = file.strip_prefix(".").map(Path::to_owned).unwrap_or(file);
    let (text, unread) = match &arguments.from {
        None => (TEMPLATE.replace(NAME, name), vec![]),
        Some(from) => {
            let shown = from.display().to_string();
            let linkage =
                imported::read(&read_text(from)?).map_err(|fault| CommandError::refused(&shown, fault))?;
            let text = linkage.scene(name, &from.file_name().unwrap_or_default().display().to_string());
            SceneSource::parse(&text, &shown).map_err(Faults::without_places)?;
            (text, linkage.unread)
        }
    };
    let refused = |error: std::io::Error| {
        if error.kind() == ErrorKind::AlreadyExists {
            let fault = "file exists; choose another name with --out, or move the file";
            CommandError::refused(file.display(), fault)
        } else {
            unusable(&file, error.to_string())
        }
    };
    // Creates a new file only: an existing one is never overwritten.
    let mut made = File::create_new(&file).map_err(refused)?;
    made.write_all(text.as_bytes()).map_err(refused)?;
    if as_json {
        return print(&to_json(&json!({ "scene": file, "unread": unread }))?);
    }
    let shown = file.display();
    let unread: String = unread.iter().map(|what| format!("not read: {what}\n")).collect();
    print(&format!(
        "{shown}\n{unread}\
         Next:\n  coordinator check {shown}\n  coordinator draw {shown}\n  coordinator explain {shown}\n  \
         coordinator simulate {shown} --out one.json\n  coordinator run {shown} --out {name}-study\n"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::nominal::nominal_evaluation;
    use coordinator::presentation::nominal_life::nominal_lives;

    #[test]
    fn the_template_is_a_valid_scene_that_reads_all_its_parameters() {
        let source = SceneSource::parse(&TEMPLATE.replace(NAME, "press"), "press.toml").unwrap();
        assert_eq!(source.nominal().name, "press");
        assert!(source.unused_parameters.is_empty());
        assert!(!source.nominal().variables.is_empty() && source.nominal().limit_states.len() == 2);
        assert!(TEMPLATE.lines().filter(|line| line.starts_with('#')).count() > 30);
    }

    #[test]
    fn issue_the_template_lay_on_its_own_limit() {
        let source = SceneSource::parse(&TEMPLATE.replace(NAME, "press"), "press.toml").unwrap();
        let evaluation = nominal_evaluation(source.nominal(), None, &|_| {}).unwrap().unwrap();
        for life in nominal_lives(source.nominal(), &evaluation) {
            assert_eq!(life.doubt(life.last, 4.0 * life.errors[1]), "", "{life:?}");
            let reached = life.reached.expected();
            assert!(reached > 4000.0 && reached < 8000.0, "{life:?}");
        }
    }
}
