use super::super::shared::cores;
use super::*;
use coordinator::study::Method;
use std::collections::{BTreeMap, BTreeSet};

/// Most lines of the first help page: one screen.
const SCREEN: usize = 40;
/// Most commands that it describes.
const DESCRIBED: usize = 18;

fn parse(line: &str) -> Result<CommandLine, clap::Error> {
    let matches = accept_negative_numbers(grouped()).try_get_matches_from(line.split_whitespace())?;
    CommandLine::from_arg_matches(&matches)
}

/// Commands that read a scene.
const OF_SCENES: [&str; 7] = ["calibrate", "check", "draw", "explain", "run", "simulate", "tradeoff"];

/// Options with other words for the same meaning in several commands, and what all of them say.
const MEANINGS: [(&str, &str); 16] = [
    ("accuracy", "Accuracy of the"),
    ("confidence", "onfidence"),
    ("config", "Zenoh configuration (JSON5)"),
    ("curve", "that count: a limit state, or total"),
    ("initial", "Evaluations of the"),
    ("inspect-every", "Inspect every N cycles"),
    ("max-evaluations", "Most evaluations"),
    ("max-failed", "Share of failed evaluations above which the study ends"),
    ("out", "older"),
    ("quick", "simulate no life"),
    ("reliability", "eliability"),
    ("samples", "Points of"),
    ("seed", "Seed of every random draw"),
    ("set", "Set a"),
    ("target-error", "Half width of the whole 95 % interval of every R(n)"),
    ("variants", "Variants of the model"),
];

#[test]
fn a_scene_is_the_first_word_of_its_command() {
    for command in OF_SCENES {
        let more = if command == "calibrate" { "--targets x" } else { "" };
        let read = |words: &str| {
            let line = format!("coordinator {command} {words} {more}");
            let matches = grouped().try_get_matches_from(line.split_whitespace())?;
            SceneName::from_arg_matches(matches.subcommand().unwrap().1).map(|scene| scene.get().to_owned())
        };
        for words in ["my.toml", "--scene my.toml", "--set a=1 my.toml", "my.toml --set a=1"] {
            assert_eq!(read(words).unwrap(), "my.toml", "{command} {words}");
        }
        assert_eq!(read("").unwrap(), "flapping-wing", "{command}");
        let said = read("a --scene b").unwrap_err().to_string();
        assert!(said.contains("cannot be used with"), "{command}: {said}");
        assert!(read("a b").is_err() && read("--help").unwrap_err().to_string().contains("[SCENE]"));
    }
}

#[test]
fn earlier_spellings_are_aliases() {
    for (earlier, present) in [
        ("what-if s --refine 3", "what-if s --max-evaluations 3"),
        ("designs s --refine 3", "designs s --max-evaluations 3"),
        ("learn s --data d --refine 3", "learn s --data d --max-evaluations 3"),
        ("calibrate --targets t --simulations 9", "calibrate --targets t --initial 9"),
        ("update s --measured m --points 600", "update s --measured m --samples 600"),
        ("tradeoff --points 2", "tradeoff --samples 2"),
        ("designs s --at a=1", "designs s --set a=1"),
        ("draw --at 0.5", "draw --phase 0.5"),
    ] {
        let read = |line: &str| format!("{:?}", parse(&format!("coordinator {line}")).unwrap());
        assert_eq!(read(earlier), read(present));
    }
}

#[test]
fn negative_numbers_are_answered_with_what_is_allowed() {
    for (line, allowed) in [
        ("coordinator --workers -1", "allowed: auto, or a whole number from 0 to 1024"),
        ("coordinator run --workers -1", "allowed: auto, or a whole number from 0 to 1024"),
        ("coordinator run --seed -5", "allowed: a whole number from 0 to 18446744073709551615"),
        ("coordinator run --samples -3", "allowed: a whole number >= 1"),
        ("coordinator run --max-failed -1", "allowed: a share above 0"),
        ("coordinator tradeoff --out x --samples -2", "allowed: a whole number >= 1"),
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
    let Some(CommandArguments::Run { options: run, .. }) = arguments.command else { panic!() };
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

/// The conventions of the command line; a list of commands that differ states why.
#[test]
fn commands_share_one_grammar() {
    let grammar = CommandLine::command();
    let shown = || grammar.get_subcommands().filter(|command| !command.is_hide_set());
    let option = |command: &clap::Command, name: &str| {
        let is_shown = |argument: &&clap::Arg| argument.get_long() == Some(name) && !argument.is_hide_set();
        command.get_arguments().find(is_shown).cloned()
    };
    let has = |command: &clap::Command, name: &str| option(command, name).is_some();
    let first = |command: &clap::Command| {
        command.get_positionals().next().map(|word| word.get_id().to_string()).unwrap_or_default()
    };
    let differing = |is_so: &dyn Fn(&clap::Command) -> bool| -> Vec<&str> {
        let names = shown().filter(|command| !is_so(command)).map(clap::Command::get_name);
        names.collect::<BTreeSet<_>>().into_iter().collect()
    };
    // The first word is a scene or a study; these read neither of them, `status` an address too, `weibull` lives alone.
    let of_scene = |command: &clap::Command| first(command) == "scene";
    let of_study = |command: &clap::Command| ["dir", "dirs"].contains(&first(command).as_str());
    assert_eq!(differing(&|command| !of_scene(command)), OF_SCENES);
    assert_eq!(
        differing(&|command| of_scene(command) || of_study(command)),
        ["completions", "doctor", "init", "man", "scenes", "schema", "status", "weibull"]
    );
    // `--out` is a folder, and never required.
    let is_folder = |command: &clap::Command| {
        option(command, "out")
            .is_none_or(|out| out.get_value_names().unwrap() == ["DIR"] && !out.is_required_set())
    };
    assert_eq!(differing(&is_folder), [""; 0]);
    // `--set` wherever a scene is read, and `--accuracy` wherever its mechanism is simulated with one: `draw` simulates nothing, and
    // `tradeoff` compares accuracies, which `--setting` names.
    let set = |command: &clap::Command| !of_scene(command) || has(command, "set");
    assert_eq!(differing(&set), [""; 0]);
    let accuracy = |command: &clap::Command| !of_scene(command) || has(command, "accuracy");
    assert_eq!(differing(&accuracy), ["draw", "tradeoff"]);
    // `--max-evaluations` wherever workers simulate until something is reached: what the samples or the rounds of the other two cost is
    // fixed beforehand.
    let bounded = |command: &clap::Command| !has(command, "workers") || has(command, "max-evaluations");
    assert_eq!(differing(&bounded), ["calibrate", "tradeoff"]);
    let earlier = ["refine", "simulations"];
    assert_eq!(differing(&|command| !earlier.iter().any(|word| has(command, word))), [""; 0]);
    // One meaning of an option: its value has one name, and its help is one text or says what all of them say.
    let mut options = BTreeMap::<&str, [BTreeSet<String>; 2]>::new();
    for argument in shown().flat_map(clap::Command::get_arguments).filter(|argument| !argument.is_hide_set())
    {
        let Some(name) = argument.get_long() else { continue };
        let value = argument.get_value_names().map(|names| names[0].trim_end_matches(",...").to_owned());
        let [values, helps] = options.entry(name).or_default();
        values.extend(value);
        helps.extend(argument.get_help().map(ToString::to_string));
    }
    let several: BTreeMap<_, _> =
        options.into_iter().filter(|(_, all)| all.iter().any(|all| all.len() > 1)).collect();
    assert_eq!(several.keys().copied().collect::<Vec<_>>(), MEANINGS.map(|(name, _)| name), "{several:#?}");
    for ((name, [values, helps]), (_, meaning)) in several.iter().zip(MEANINGS) {
        assert_eq!(values.len(), 1, "--{name}: {values:?}");
        assert!(helps.iter().all(|help| help.contains(meaning)), "--{name}: {helps:#?}");
    }
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
