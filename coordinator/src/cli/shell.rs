//! `coordinator completions`, `coordinator man` and `coordinator schema`: the command line for shells and for `man`, files for editors.

use super::command::{CommandLine, grouped};
use super::{CommandError, Done, print};
use clap::{Command, CommandFactory};
use clap_complete::Shell;
use common::scene::SceneSource;
use coordinator::results::result_files::{ResultFileError, create_folder};
use std::path::Path;

/// Name of the program, as shells know it.
const PROGRAM: &str = "coordinator";

/// Prints the completions for a shell.
///
/// # Errors
/// [`CommandError::Output`].
pub fn completions(shell: Shell) -> Done {
    print(&script(shell))
}

/// The completions for a shell. To those of clap it adds files beside the names of scenes (zsh), and these names as first words (fish).
fn script(shell: Shell) -> String {
    let (mut command, mut script) = (CommandLine::command(), Vec::new());
    clap_complete::generate(shell, &mut command, PROGRAM, &mut script);
    let mut script = String::from_utf8_lossy(&script).into_owned();
    let names = SceneSource::builtin_names().join(" ");
    match shell {
        Shell::Zsh => script.replace(&format!(":({names})"), &format!(":{{compadd {names}; _files}}")),
        Shell::Fish => {
            let of_scene =
                |command: &&Command| command.get_positionals().any(|word| word.get_id() == "scene");
            script.extend(command.get_subcommands().filter(of_scene).map(|command| {
                let using = format!("__fish_{PROGRAM}_using_subcommand {}", command.get_name());
                format!("complete -c {PROGRAM} -n \"{using}\" -a \"{names}\"\n")
            }));
            script
        }
        _ => script,
    }
}

/// Prints the manual page of the program, or writes it and those of all commands to the folder `out`.
///
/// # Errors
/// [`CommandError::ResultFile`] or [`CommandError::Output`].
pub fn man(out: Option<&Path>) -> Done {
    let mut whole = grouped();
    whole.build();
    if let Some(folder) = out {
        create_folder(folder)?;
        let failed = |source| ResultFileError::Write(folder.to_path_buf(), source);
        return Ok(clap_mangen::generate_to(whole, folder).map_err(failed)?);
    }
    let mut text = Vec::new();
    clap_mangen::Man::new(whole).render(&mut text).map_err(CommandError::Output)?;
    print(&String::from_utf8_lossy(&text))
}

/// JSON Schema (2020-12) of the language of scenes.
const SCENE: &str = include_str!("../../schemas/scene.schema.json");

/// JSON Schema (2020-12) of `summary.json`.
const SUMMARY: &str = include_str!("../../schemas/summary.schema.json");

/// Prints the schema of scenes, or of `summary.json`.
///
/// # Errors
/// [`CommandError::Output`].
pub fn schema(results: bool) -> Done {
    print(if results { SUMMARY } else { SCENE })
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::ValueEnum;

    #[test]
    fn every_shell_has_completions_of_every_command() {
        for shell in Shell::value_variants() {
            let script = script(*shell);
            for name in ["simulate", "what-if", "max-evaluations"] {
                assert!(script.contains(name), "{shell}: no {name}");
            }
        }
    }

    /// As [`script`] gives them; scenes are offered beside files, and to every command that reads one.
    #[test]
    fn completions_offer_scenes_and_presets() {
        let scenes = SceneSource::builtin_names().join(" ");
        let fish = scenes.replace(' ', "\\t''\n");
        for (shell, offered) in [
            (Shell::Bash, [format!("{scenes}\"\n"), "-W \"draft balanced reference\"".to_owned()]),
            (
                Shell::Zsh,
                [format!(":{{compadd {scenes}; _files}}'"), ":(draft balanced reference)'".to_owned()],
            ),
            (Shell::Fish, [format!("-a \"{scenes}\""), "draft\\t''\nbalanced\\t''\nreference".to_owned()]),
        ] {
            let script = script(shell);
            for names in offered {
                assert!(script.matches(&names).count() >= 5, "{shell}: no {names}");
            }
        }
        assert!(script(Shell::Fish).contains(&fish));
    }

    #[test]
    fn every_command_has_a_page() {
        let folder = tempfile::tempdir().unwrap();
        man(Some(folder.path())).unwrap();
        for command in CommandLine::command().get_subcommands().filter(|command| !command.is_hide_set()) {
            let file = folder.path().join(format!("coordinator-{}.1", command.get_name()));
            let page =
                std::fs::read_to_string(&file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
            assert!(page.contains(".SH SYNOPSIS") && page.contains("OPTIONS"), "{page}");
        }
        assert!(folder.path().join("coordinator.1").exists());
    }
}
