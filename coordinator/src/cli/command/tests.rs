use super::super::shared::cores;
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
    assert_eq!(arguments.run.farm.workers, Some(cores()));
    let arguments = parse("coordinator -v run --workers 0 --seed 7 --method monte-carlo").unwrap();
    assert_eq!(arguments.verbosity.verbose, 1);
    let Some(CommandArguments::Run(run)) = arguments.command else { panic!() };
    assert_eq!((run.farm.workers, run.method.seed), (Some(0), Some(7)));
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

/// The conventions of the command line, and the commands that have reason to differ.
#[test]
fn commands_share_one_grammar() {
    let grammar = CommandLine::command();
    let shown = || grammar.get_subcommands().filter(|command| !command.is_hide_set());
    let option = |command: &clap::Command, name: &str| {
        command.get_arguments().find(|argument| argument.get_long() == Some(name)).cloned()
    };
    let has = |command: &clap::Command, name: &str| option(command, name).is_some();
    let first = |command: &clap::Command| {
        let word = command.get_positionals().next().map(|word| word.get_id().to_string());
        word.or(has(command, "scene").then(|| "scene".to_owned())).unwrap_or_default()
    };
    let differing = |is_so: &dyn Fn(&clap::Command) -> bool| -> Vec<&str> {
        let names = shown().filter(|command| !is_so(command)).map(clap::Command::get_name);
        names.collect::<BTreeSet<_>>().into_iter().collect()
    };
    // The first word is a scene or a study: `--scene` is one too, see `a_scene_is_the_first_word_of_its_command`.
    let of_scene = |command: &clap::Command| {
        first(command) == "scene" || (first(command) == "file" && has(command, "quick"))
    };
    let of_study = |command: &clap::Command| ["dir", "dirs"].contains(&first(command).as_str());
    let scenes: BTreeSet<&str> = shown().filter(|c| has(c, "scene")).map(clap::Command::get_name).collect();
    assert_eq!(scenes, OF_SCENES.into_iter().collect());
    assert_eq!(
        differing(&|command| of_scene(command) || of_study(command)),
        ["completions", "doctor", "init", "man", "scenes", "schema", "status", "weibull"]
    );
    // `--out` is a folder, and never required.
    let is_folder = |command: &clap::Command| {
        option(command, "out").is_none_or(|out| out.get_value_names().unwrap()[0].starts_with("DIR"))
    };
    assert_eq!(differing(&is_folder), [""; 0]);
    let is_required =
        |command: &clap::Command| option(command, "out").is_some_and(|out| out.is_required_set());
    assert_eq!(differing(&|command| !is_required(command)), [""; 0]);
    // `--set` wherever a scene is read, and `--accuracy` wherever its mechanism is simulated with one: `draw` simulates nothing, and
    // `tradeoff` compares accuracies, which `--setting` names.
    let set = |command: &clap::Command| !of_scene(command) || has(command, "set");
    assert_eq!(differing(&set), [""; 0]);
    let accuracy = |command: &clap::Command| !of_scene(command) || has(command, "accuracy");
    assert_eq!(differing(&accuracy), ["draw", "tradeoff"]);
    // `--json` prints: it belongs to all of them.
    assert!(option(&grammar, "json").is_some_and(|json| json.is_global_set()));
}

#[test]
fn a_destination_is_checked_before_anything_is_computed() {
    let folder = tempfile::tempdir().unwrap();
    let [file, inside] = ["taken", "taken/inside"].map(|name| folder.path().join(name).display().to_string());
    std::fs::write(&file, "").unwrap();
    let missing = folder.path().join("no/such/answer.md").display().to_string();
    for command in [
        "what-if s --set a=1",
        "designs s",
        "learn s --data d",
        "update s --measured m",
        "optimise s --problem p",
        "replace s --planned-cost 1 --failure-cost 2",
        "test-plan --reliability 0.9 --at 1000 --confidence 90%",
        "weibull f.csv",
        "calibrate --targets t",
    ] {
        let said = |out: &str| parse(&format!("coordinator {command} --out {out}")).unwrap_err().to_string();
        assert!(said(&inside).contains("taken is a file, expected a folder"), "{command}: {}", said(&inside));
        assert!(said(&missing).contains("there is no folder"), "{command}: {}", said(&missing));
        let fresh = folder.path().join("new/answers").display().to_string();
        assert!(parse(&format!("coordinator {command} --out {fresh}")).is_ok(), "{command}");
        assert!(!folder.path().join("new").exists());
    }
}
