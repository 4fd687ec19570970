//! Text for users stays plain: words that make a sentence hard to read for a stranger occur in no document, no doc
//! comment and no string of the programs.

use crate::markdown::{assert_none, documents, root};
use proc_macro2::{TokenStream, TokenTree};
use std::path::Path;

/// Words that have a plain alternative.
const AVOIDED: [&str; 6] = ["whoever", "nobody", "somebody", "takes notice", "held against", "so many"];

/// Sources of the programs, and the scenes.
const SOURCES: [&str; 5] =
    ["common/src", "common/scenes", "worker/src", "coordinator/src", "coordinator/statistics/src"];

/// The avoided words in a text, whose line breaks count as spaces.
fn avoided(text: &str) -> Vec<&'static str> {
    let letter = |c: char| if c.is_alphanumeric() { c.to_ascii_lowercase() } else { ' ' };
    let letters: String = text.chars().map(letter).collect();
    let text = format!(" {} ", letters.split_whitespace().collect::<Vec<_>>().join(" "));
    AVOIDED.into_iter().filter(|word| text.contains(&format!(" {word} "))).collect()
}

/// String literals of a token stream in order, doc comments among them: a sentence may continue in the next one.
fn strings(tokens: TokenStream) -> Vec<String> {
    let of_token = |token| match token {
        TokenTree::Group(group) => strings(group.stream()),
        TokenTree::Literal(literal) => vec![literal.to_string()],
        _ => vec![],
    };
    tokens.into_iter().flat_map(of_token).filter(|text: &String| text.contains('"')).collect()
}

/// Calls `look` with every Rust and TOML file below a folder.
fn each_source(folder: &Path, look: &mut dyn FnMut(&Path)) {
    let mut entries: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            each_source(&path, look);
        } else if path.extension().is_some_and(|extension| extension == "rs" || extension == "toml") {
            look(&path);
        }
    }
}

#[test]
fn documents_use_plain_words() {
    let mut found = Vec::new();
    for (name, text) in documents() {
        // Entries of the past stay as they were written.
        if name == "CHANGELOG.md" {
            continue;
        }
        found.extend(avoided(text).into_iter().map(|word| format!("{name}: {word}")));
    }
    assert_none(&found);
}

#[test]
fn doc_comments_and_strings_use_plain_words() {
    let mut found = Vec::new();
    for folder in SOURCES {
        each_source(&root().join(folder), &mut |path| {
            let source = std::fs::read_to_string(path).unwrap();
            let is_rust = path.extension().is_some_and(|extension| extension == "rs");
            let text = if is_rust { strings(source.parse().unwrap()).join(" ") } else { source };
            let path = path.strip_prefix(root()).unwrap().display();
            found.extend(avoided(&text).into_iter().map(|word| format!("{path}: {word}")));
        });
    }
    assert_none(&found);
}

#[test]
fn words_are_found_across_lines_and_within_none() {
    assert_eq!(avoided("It takes\n/// notice, and Nobody asks"), ["nobody", "takes notice"]);
    assert!(avoided("also manyfold, busybody").is_empty());
}
