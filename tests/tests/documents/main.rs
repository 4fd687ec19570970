//! The documents are true: paths, links and command lines exist, the book is complete, and pages that describe results
//! agree with them.

mod commands;
mod front_page;
mod markdown;
mod quick_study;
mod reproduction;
mod results;
mod words;

use markdown::{CONTENTS, anchors, assert_none, documents, links, quoted, read, root, shown_lines, target};

/// Folders whose files a document may name in backquotes.
const FOLDERS: [&str; 6] = ["common/", "worker/", "coordinator/", "deploy/", "tests/", ".ci/"];

#[test]
fn every_link_and_path_exists() {
    let mut missing = Vec::new();
    for (name, text) in documents() {
        for (path, anchor) in links(text) {
            let target = target(name, path);
            if !root().join(&target).exists() {
                missing.push(format!("{name}: {path} does not exist"));
            } else if let Some(anchor) = anchor
                && !anchors(&read(&target)).iter().any(|known| known == anchor)
            {
                missing.push(format!("{name}: {target} has no heading #{anchor}"));
            }
        }
        for word in
            quoted(text).into_iter().filter(|word| FOLDERS.iter().any(|folder| word.starts_with(folder)))
        {
            if !root().join(word).exists() {
                missing.push(format!("{name}: {word} does not exist"));
            }
        }
    }
    assert_none(&missing);
}

/// The contents page links every document; the front page and every page of the book link the contents page.
#[test]
fn the_book_is_complete() {
    let linked = |name: &str| -> Vec<String> {
        links(&documents()[name]).into_iter().map(|(path, _)| target(name, path)).collect()
    };
    let contents = linked(CONTENTS);
    let mut missing = Vec::new();
    for name in documents().keys().filter(|name| *name != CONTENTS) {
        if !contents.contains(name) {
            missing.push(format!("{CONTENTS} does not link {name}"));
        }
        let is_page = name.starts_with("coordinator/doc/");
        if (is_page || name == "README.md") && !linked(name).iter().any(|target| target == CONTENTS) {
            missing.push(format!("{name} does not link {CONTENTS}"));
        }
    }
    assert_none(&missing);
}

#[test]
fn the_glossary_is_in_alphabetical_order() {
    let rows = markdown::table_rows(&documents()["coordinator/doc/glossary.md"]);
    let terms: Vec<String> = rows.iter().map(|row| row[0].to_lowercase()).collect();
    assert!(terms.len() >= 60 && rows.iter().all(|row| row.len() == 2 && !row[1].is_empty()));
    assert!(terms.is_sorted(), "{terms:?}");
}

/// An extension of each kind touches no more files than this.
#[test]
fn extensions_touch_few_files() {
    let page = &documents()["coordinator/doc/extending.md"];
    let goals =
        [("Contact law", 5), ("Load", 3), ("Output", 3), ("Distribution", 3), ("Learning function", 3)];
    let sections: Vec<&str> = page.split("\n## ").skip(1).collect();
    assert_eq!(sections.len(), goals.len());
    for (section, (title, most)) in sections.iter().zip(goals) {
        assert!(section.starts_with(title), "{title} is expected, not {section}");
        let numbered =
            |line: &&str| line.split_once(". ").is_some_and(|(number, _)| number.parse::<u32>().is_ok());
        let files = section.lines().filter(numbered).count();
        assert!((1..=most).contains(&files), "{title}: {files} files");
        assert!(quoted(section).iter().any(|word| word.ends_with(".rs")), "{title}: no file is named");
    }
}

/// Each built-in scene has its section, and no other scene has one.
#[test]
fn every_built_in_scene_has_its_section() {
    let page = read("coordinator/doc/scenes.md");
    let sections: Vec<&str> = page.lines().filter_map(|line| line.strip_prefix("## ")).collect();
    let scenes = common::scene::SceneSource::builtin_names();
    assert_eq!(sections, scenes.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>());
    for (section, name) in page.split("\n## ").skip(1).zip(&scenes) {
        let shown = shown_lines(section);
        assert!(
            shown.iter().any(|line| line.split(' ').any(|word| word == *name)),
            "{name}: no command to run"
        );
        assert!(section.contains("\n- Reference: "), "{name}: no reference values");
    }
}
