use super::super::shared::Slots;
use super::*;
use coordinator::study::Method;
use std::collections::BTreeSet;

/// Most lines of the first help page: one screen.
const SCREEN: usize = 40;
/// Most commands that it describes.
const DESCRIBED: usize = 18;

fn parse(line: &str) -> Result<CommandLine, clap::Error> {
    let words = with_scene_option(line.split_whitespace());
    let matches = accept_negative_numbers(grouped()).try_get_matches_from(words)?;
    CommandLine::from_arg_matches(&matches)
}

#[test]
fn a_scene_is_the_first_word_of_its_command() {
    for command in OF_SCENES {
        let more = if command == "tradeoff" { "--out x" } else { "" };
        let more = if command == "calibrate" { "--targets x" } else { more };
        let read =
            |scene: &str| format!("{:?}", parse(&format!("coordinator {command} {scene} {more}")).unwrap());
        assert_eq!(read("my.toml"), read("--scene my.toml"), "{command}");
    }
    assert!(parse("coordinator run a --scene b").is_err() && parse("coordinator run a b").is_err());
}

#[test]
fn negative_numbers_are_answered_with_what_is_allowed() {
    for (line, allowed) in [
        ("coordinator --workers -1", "allowed: auto, or a whole number from 0 to 1024"),
        ("coordinator run --workers -1", "allowed: auto, or a whole number from 0 to 1024"),
        ("coordinator run --seed -5", "allowed: a whole number from 0 to 18446744073709551615"),
        ("coordinator run --samples -3", "allowed: a whole number >= 1"),
        ("coordinator run --max-failed -1", "allowed: a share above 0"),
        ("coordinator tradeoff --out x --points -2", "allowed: a whole number >= 1"),
    ] {
        let said = parse(line).unwrap_err().to_string();
        assert!(said.contains(allowed), "{line}: {said}");
    }
}

#[test]
fn the_grammar_is_consistent() {
    CommandLine::command().debug_assert();
    accept_negative_numbers(grouped()).debug_assert();
}

#[test]
fn the_first_help_page_names_every_command_once_on_one_screen() {
    let page = grouped().try_get_matches_from(["coordinator", "--help"]).unwrap_err().to_string();
    assert!(page.lines().count() <= SCREEN, "{} lines:\n{page}", page.lines().count());
    assert!(!page.contains("--max-evaluations"), "{page}");
    assert!(GROUPS.iter().map(|(_, names)| names.len()).sum::<usize>() <= DESCRIBED);
    let command = CommandLine::command();
    let shown = command.get_subcommands().filter(|command| !command.is_hide_set());
    let shown: BTreeSet<&str> = shown.map(clap::Command::get_name).collect();
    let grouped: Vec<&str> = GROUPS.iter().flat_map(|(_, names)| names.iter().copied()).chain(MORE).collect();
    assert_eq!(grouped.iter().copied().collect::<BTreeSet<_>>(), shown);
    assert_eq!(grouped.len(), shown.len());
}

#[test]
fn the_main_job_needs_no_command() {
    let arguments = parse("coordinator --workers auto").unwrap();
    assert!(arguments.command.is_none());
    assert_eq!(arguments.run.farm.workers, Some(Slots::Auto));
    let arguments = parse("coordinator -v run --workers 0 --seed 7 --method monte-carlo").unwrap();
    assert_eq!(arguments.verbosity.verbose, 1);
    let Some(CommandArguments::Run(run)) = arguments.command else { panic!() };
    assert_eq!((run.farm.workers, run.method.seed), (Some(Slots::Count(0)), Some(7)));
    assert_eq!(run.method.method, Some(Method::MonteCarlo));
}

#[test]
fn slips_are_refused() {
    for line in [
        "coordinator --workers many",
        "coordinator --workers 5000",
        "coordinator run --accuracy exact",
        "coordinator run --accuracy draft --max-error 1%",
        "coordinator run --max-error 0",
        "coordinator simulate --max-error half",
        "coordinator tradeoff --out x --setting draft+jump-x",
        "coordinator tradeoff --out x --setting draft --settings quick",
        "coordinator run --samples 0",
        "coordinator run --seed -1",
        "coordinator resume",
        "coordinator simulate --quiet -v",
        "coordinator tradeof",
    ] {
        assert_eq!(parse(line).unwrap_err().exit_code(), 2, "{line}");
    }
}
