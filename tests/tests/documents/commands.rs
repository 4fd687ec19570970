//! Commands and options in the documents are those of the programs.

use crate::markdown::{assert_none, documents, quoted, read, root, shown_lines, table_rows};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;
use tests::command_line::{objection, words};
use tests::program;

/// The page with every command and option.
const PAGE: &str = "coordinator/doc/commands.md";

/// Standard output of `PROGRAM ARGUMENTS --help`, none if that fails.
fn help(name: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program(name)).args(arguments).arg("--help").output().unwrap();
    output.status.success().then(|| String::from_utf8(output.stdout).unwrap())
}

/// Commands of the coordinator, from its help: words that begin an indented line, that wide space separates from
/// their description, and those of the line that lists more of them; each has a help of its own.
fn commands() -> BTreeSet<String> {
    let text = help("coordinator", &[]).unwrap();
    let candidates = text.lines().filter_map(|line| {
        let (word, rest) = line.strip_prefix("  ")?.trim_start().split_once("  ")?;
        let name = word.chars().all(|c| c.is_ascii_lowercase() || c == '-') && !word.starts_with('-');
        (name && !rest.is_empty() && word != "help").then_some(word)
    });
    let more = text.lines().find_map(|line| line.strip_prefix("More (COMMAND --help): "));
    let candidates = candidates.chain(more.expect("a line with more commands").split(", "));
    let own_help = |command: &&str| {
        help("coordinator", &[command]).is_some_and(|text| text.contains(&format!("coordinator {command}")))
    };
    candidates.filter(own_help).map(str::to_owned).collect()
}

/// Options, short and long, that a help lists: they begin a line with a small indent.
fn options(help: &str) -> BTreeSet<String> {
    let listed = help.lines().filter(|line| {
        let text = line.trim_start();
        text.starts_with('-') && (1..8).contains(&(line.len() - text.len()))
    });
    listed
        .flat_map(|line| line.trim_start().split(", ").take(2))
        .filter_map(|part| part.split([' ', '.', '=']).next())
        .filter(|word| word.len() > 1 && word.starts_with('-'))
        .map(str::to_owned)
        .collect()
}

/// The program and arguments of a line that starts one of ours, by `cargo run`, by path or name.
fn ours(line: &str) -> Option<(PathBuf, Vec<String>)> {
    let mut words = words(line.trim_start_matches("$ "));
    let cargo = |verb: &str| words.starts_with(&["cargo".into(), verb.into()]);
    if cargo("run") || cargo("bench") {
        let after =
            |option: &str| words.iter().position(|word| word == option).map(|at| words[at + 1].clone());
        let package = after("-p").unwrap_or_else(|| panic!("{line}: which package?"));
        // Measurements with arguments are examples in the folder of benchmarks.
        for (option, folders) in [("--example", &["examples", "benches"][..]), ("--bench", &["benches"])] {
            if let Some(name) = after(option) {
                let files =
                    |folder: &&str| ["", "/main"].map(|end| format!("{package}/{folder}/{name}{end}.rs"));
                let found = folders.iter().flat_map(files).any(|file| root().join(file).is_file());
                assert!(found, "{line}: {name} is not in {folders:?}");
                return None;
            }
        }
        assert!(words.iter().any(|word| word == "--release"), "{line}: an unoptimised build is too slow");
        let own = words.iter().position(|word| word == "--").map_or(words.len(), |at| at + 1);
        return Some((program(&package), words.split_off(own)));
    }
    let first = Path::new(words.first()?.strip_prefix("target/release/").unwrap_or(&words[0])).to_owned();
    let known = ["coordinator", "worker"].iter().find(|name| first == Path::new(name))?;
    Some((program(known), words.split_off(1)))
}

#[test]
fn every_command_line_is_accepted_and_every_command_is_shown() {
    let mut found = Vec::new();
    let mut shown = BTreeSet::new();
    for (name, text) in documents() {
        let in_prose = quoted(text).into_iter().filter(|span| span.contains(' '));
        for line in shown_lines(text).into_iter().chain(in_prose) {
            let Some((program, arguments)) = ours(line) else { continue };
            let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
            match objection(&program, &arguments) {
                None => _ = shown.insert((*arguments.first().unwrap_or(&"")).to_owned()),
                Some(said) => found.push(format!("{name}: {line}\n{said}")),
            }
        }
    }
    assert_none(&found);
    let missing: Vec<String> = commands().difference(&shown).cloned().collect();
    assert!(missing.is_empty(), "no document shows {missing:?}");
}

#[test]
fn every_option_named_in_prose_exists() {
    let mut known = options(&help("worker", &[]).unwrap());
    known.extend(options(&help("coordinator", &[]).unwrap()));
    for command in commands() {
        known.extend(options(&help("coordinator", &[&command]).unwrap()));
    }
    let mut unknown = Vec::new();
    for (name, text) in documents() {
        for span in quoted(text).into_iter().filter(|span| span.starts_with("--")) {
            let option = span.split([' ', '=']).next().unwrap();
            if !known.contains(option) {
                unknown.push(format!("{name}: {option} is an option of neither program"));
            }
        }
    }
    assert_none(&unknown);
}

/// Options in the first cells of a section's tables.
fn listed(section: &str) -> BTreeSet<String> {
    let first = |row: Vec<&str>| quoted(row[0]).into_iter().map(str::to_owned).collect::<Vec<_>>();
    table_rows(section).into_iter().flat_map(first).filter(|word| word.starts_with('-')).collect()
}

/// Sections of a page by title, without the marks of headings and backquotes; each ends at the next heading.
fn sections(text: &str) -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    let mut title = String::new();
    for line in text.lines() {
        if line.starts_with("##") {
            title = line.trim_start_matches('#').trim().replace('`', "");
        } else {
            let body: &mut String = found.entry(title.clone()).or_default();
            body.push_str(line);
            body.push('\n');
        }
    }
    found
}

/// The page lists every command with exactly the options that its help lists; groups of options are linked.
#[test]
fn the_page_of_commands_is_complete() {
    let page = read(PAGE);
    let sections = sections(&page);
    let of_page: BTreeSet<String> =
        sections.keys().filter_map(|title| title.strip_prefix("coordinator ")).map(str::to_owned).collect();
    assert_eq!(of_page, commands());
    let named = commands().into_iter().map(|command| ("coordinator", Some(command)));
    for (program, command) in named.chain([("worker", None)]) {
        let arguments: Vec<&str> = command.iter().map(String::as_str).collect();
        let expected = options(&help(program, &arguments).unwrap());
        let title = command.as_ref().map_or(program.to_owned(), |command| format!("{program} {command}"));
        let section = &sections[&title];
        let mut found = listed(section);
        for (group, anchor) in [
            ("Common options", "(#common-options)"),
            ("Worker options", "(#worker-options)"),
            ("Accuracy options", "(#accuracy-options)"),
            ("Learning options", "(#learning-options)"),
            ("Monitoring options", "(#monitoring-options)"),
        ] {
            if section.contains(anchor) {
                found.extend(listed(&sections[group]));
            }
        }
        assert_eq!(found, expected, "options of {title}, on the page and in its help");
    }
}
