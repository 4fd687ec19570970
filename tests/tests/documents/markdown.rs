//! The Markdown documents of the repository, and what can be checked of them: blocks, quoted words, links, headings.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

/// The contents page of the book.
pub const CONTENTS: &str = "coordinator/doc/README.md";

/// Top folder of the repository.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_path_buf()
}

/// Text of a file, by its path from the root.
pub fn read(name: &str) -> String {
    std::fs::read_to_string(root().join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Every Markdown document that git tracks or would track, by its path from the root.
pub fn documents() -> &'static BTreeMap<String, String> {
    static DOCUMENTS: OnceLock<BTreeMap<String, String>> = OnceLock::new();
    DOCUMENTS.get_or_init(|| {
        let listed = Command::new("git")
            .args(["ls-files", "-z", "--cached", "--others", "--exclude-standard", "*.md"])
            .current_dir(root())
            .output()
            .expect("git lists the documents");
        let names = String::from_utf8(listed.stdout).expect("paths are UTF-8");
        let exists = |name: &&str| !name.is_empty() && root().join(name).is_file();
        let found: BTreeMap<String, String> =
            names.split('\0').filter(exists).map(|name| (name.to_owned(), read(name))).collect();
        assert!(found.contains_key("README.md") && found.contains_key(CONTENTS), "{:?}", found.keys());
        found
    })
}

/// Lines of the blocks between ``` fences.
pub fn shown_lines(text: &str) -> Vec<&str> {
    fenced(text).filter(|(inside, _)| *inside).map(|(_, line)| line).collect()
}

/// Text between backquotes, outside of blocks.
pub fn quoted(text: &str) -> Vec<&str> {
    fenced(text)
        .filter(|(inside, _)| !inside)
        .flat_map(|(_, line)| line.split('`').skip(1).step_by(2))
        .collect()
}

/// Every line but the fences, with whether it is inside a block.
fn fenced(text: &str) -> impl Iterator<Item = (bool, &str)> {
    let mut inside = false;
    text.lines().filter_map(move |line| {
        let fence = line.starts_with("```");
        inside ^= fence;
        (!fence).then_some((inside, line))
    })
}

/// Targets of `[text](target)` and `![text](target)` within the repository: path, which is empty for the page itself,
/// and anchor.
pub fn links(text: &str) -> Vec<(&str, Option<&str>)> {
    text.split("](")
        .skip(1)
        .filter_map(|rest| rest.split(')').next())
        .filter(|target| !target.contains("://"))
        .map(|target| target.split_once('#').map_or((target, None), |(path, anchor)| (path, Some(anchor))))
        .collect()
}

/// Path from the root of a link's target in this document; a folder stands for its `README.md` if it has one.
pub fn target(document: &str, path: &str) -> String {
    if path.is_empty() {
        return document.to_owned();
    }
    let mut parts: Vec<&str> = document.split('/').collect();
    parts.pop();
    for part in path.split('/') {
        match part {
            "." | "" => {}
            ".." => _ = parts.pop(),
            name => parts.push(name),
        }
    }
    let found = parts.join("/");
    let index = format!("{found}/README.md");
    if root().join(&index).is_file() { index } else { found }
}

/// Anchors of the headings, as hosts of Markdown make them: lower case, hyphens for spaces, letters, digits, hyphens and underscores kept.
pub fn anchors(text: &str) -> Vec<String> {
    let headings = fenced(text).filter(|(inside, line)| !inside && line.starts_with('#'));
    headings
        .map(|(_, line)| {
            let title = line.trim_start_matches('#').trim().to_lowercase();
            let kept = title.chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c));
            kept.map(|c| if c == ' ' { '-' } else { c }).collect()
        })
        .collect()
}

/// Cells of the rows of all tables, without heads.
pub fn table_rows(text: &str) -> Vec<Vec<&str>> {
    fn cells(line: &str) -> Vec<&str> {
        line.trim_matches('|').split('|').map(str::trim).collect()
    }
    let rows: Vec<&str> = text.lines().filter(|line| line.starts_with('|')).collect();
    let is_rule = |line: &str| line.starts_with("|---") || line.starts_with("| ---");
    rows.iter()
        .enumerate()
        .filter(|(k, line)| !is_rule(line) && rows.get(k + 1).is_none_or(|next| !is_rule(next)))
        .map(|(_, line)| cells(line))
        .collect()
}

/// Passes if nothing was found; else prints it.
#[track_caller]
pub fn assert_none(found: &[String]) {
    assert!(found.is_empty(), "\n{}\n", found.join("\n"));
}
