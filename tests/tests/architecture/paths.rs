//! The paths a source file names, read from its tokens: comments and strings do not count, and of macros what
//! stands in them does.

use proc_macro2::{Delimiter, Punct, Spacing, TokenStream, TokenTree};
use std::collections::BTreeSet;
use std::path::Path;

/// A path such as `crate::wear::Profile`, where it stands.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Named {
    /// Segments; `self` and `super` are resolved to `crate`.
    pub segments: Vec<String>,
    /// The first line, from 1, that has its last segment outside of comments. (Positions of tokens would need a
    /// feature of `proc-macro2` with which every procedural macro, and so nearly every crate, is compiled anew.)
    pub line: usize,
    /// True for a `pub use`, which passes a name on without using it.
    pub reexport: bool,
    /// The name it has in the file: the last segment, or what stands after `as`.
    pub alias: String,
}

/// What a file names.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct SourceFile {
    /// Paths outside of `#[cfg(test)]`.
    pub paths: Vec<Named>,
    /// Paths inside of it.
    pub test_paths: Vec<Named>,
    /// Modules in files of their own that exist only for tests.
    pub test_modules: Vec<String>,
    /// Other modules in files of their own.
    pub modules: Vec<String>,
    /// Names of the items that the file defines.
    pub defined: BTreeSet<String>,
    /// Names of the types and traits among them, outside of functions and implementations.
    pub types: BTreeSet<String>,
}

/// Segments of the module a file holds: `src/wear/step.rs` is `[wear, step]`, `src/wear/mod.rs` is `[wear]`.
pub fn module_of(file: &Path) -> Vec<String> {
    let mut segments: Vec<String> =
        file.with_extension("").components().map(|c| c.as_os_str().to_string_lossy().into_owned()).collect();
    if matches!(segments.last().map(String::as_str), Some("mod" | "lib" | "main")) {
        segments.pop();
    }
    segments
}

/// Reads a file whose module is `module`.
pub fn read(text: &str, module: &[String]) -> SourceFile {
    let tokens: TokenStream = text.parse().expect("the sources compile");
    let mut source = SourceFile::default();
    walk(tokens, module, Place::default(), &mut source);
    for path in source.paths.iter_mut().chain(&mut source.test_paths) {
        path.line =
            line_of(text, path.segments.iter().rfind(|segment| *segment != "*").map_or("", String::as_str));
    }
    source
}

/// The first line, from 1, with `word` outside of comments; 0 if there is none.
fn line_of(text: &str, word: &str) -> usize {
    let has_word = |line: &str| line.split(|c: char| !(c.is_alphanumeric() || c == '_')).any(|w| w == word);
    text.lines().position(|line| !line.trim_start().starts_with("//") && has_word(line)).map_or(0, |k| k + 1)
}

/// Where tokens stand.
#[derive(Debug, Default, Clone, Copy)]
struct Place {
    /// In an item that exists only for tests.
    in_test: bool,
    /// In the body of an item that is no module.
    inside: bool,
}

fn walk(tokens: TokenStream, module: &[String], place: Place, out: &mut SourceFile) {
    let Place { in_test, inside } = place;
    let tokens: Vec<TokenTree> = tokens.into_iter().collect();
    // Whether the item that begins here, or began before, is for tests only.
    let mut marked = false;
    let mut at = 0;
    while at < tokens.len() {
        match &tokens[at] {
            TokenTree::Punct(punct) if matches!(punct.as_char(), ';' | '}') => marked = false,
            TokenTree::Group(group) => {
                let attribute =
                    at > 0 && matches!(&tokens[at - 1], TokenTree::Punct(p) if p.as_char() == '#');
                if attribute && is_cfg_test(group.stream()) {
                    marked = true;
                } else {
                    let body = Place { in_test: in_test || marked, inside: true };
                    walk(group.stream(), module, body, out);
                    // An item with a body ends with it.
                    marked &= attribute || group.delimiter() != Delimiter::Brace;
                }
            }
            TokenTree::Ident(word) if word == "mod" => {
                if let (Some(TokenTree::Ident(name)), Some(next)) = (tokens.get(at + 1), tokens.get(at + 2)) {
                    if let TokenTree::Group(body) = next {
                        let inner = [module, &[name.to_string()]].concat();
                        walk(body.stream(), &inner, Place { in_test: in_test || marked, inside }, out);
                    } else if marked {
                        out.test_modules.push(name.to_string());
                    } else if !in_test {
                        out.modules.push(name.to_string());
                    }
                    marked = false;
                    at += 2;
                }
            }
            TokenTree::Ident(word) => {
                let begin = at;
                let imports = begin > 0 && is_word(&tokens[begin - 1], &["use"]);
                let reexport = imports && is_public(&tokens[..begin - 1]);
                if begin > 0 && is_word(&tokens[begin - 1], &DEFINING) {
                    out.defined.insert(word.to_string());
                    let counts = !(in_test || marked) && is_word(&tokens[begin - 1], &TYPES);
                    if counts && !inside {
                        out.types.insert(word.to_string());
                    }
                }
                let mut segments = vec![word.to_string()];
                while is_colons(&tokens, at + 1) {
                    match tokens.get(at + 3) {
                        Some(TokenTree::Ident(next)) => {
                            segments.push(next.to_string());
                            at += 3;
                        }
                        _ => break,
                    }
                }
                let group = if is_colons(&tokens, at + 1) { tokens.get(at + 3) } else { None };
                let paths = if in_test || marked { &mut out.test_paths } else { &mut out.paths };
                match group {
                    Some(TokenTree::Group(group)) => {
                        tree(group.stream(), &segments, (module, reexport), paths);
                        at += 3;
                    }
                    Some(TokenTree::Punct(star)) if star.as_char() == '*' => {
                        segments.push("*".into());
                        paths.push(named(&segments, (module, reexport)));
                    }
                    _ if imports || segments.len() > 1 => {
                        let mut path = named(&segments, (module, reexport));
                        if let (true, [a, TokenTree::Ident(alias)]) =
                            (imports, tokens.get(at + 1..at + 3).unwrap_or(&[]))
                            && is_word(a, &["as"])
                        {
                            path.alias = alias.to_string();
                        }
                        paths.push(path);
                    }
                    _ => {}
                }
            }
            _ => {}
        }
        at += 1;
    }
}

/// The leaves of `{a, b::c, d::{e, f}}` after `prefix::`; `from`: the module, and whether it is a re-export.
fn tree(tokens: TokenStream, prefix: &[String], from: (&[String], bool), paths: &mut Vec<Named>) {
    let mut segments = prefix.to_vec();
    let mut alias = None;
    let mut renamed = false;
    for token in tokens.into_iter().chain([TokenTree::Punct(Punct::new(',', Spacing::Alone))]) {
        match token {
            TokenTree::Punct(comma) if comma.as_char() == ',' => {
                if segments.len() > prefix.len() {
                    let path = named(&segments, from);
                    paths.push(Named { alias: alias.take().unwrap_or(path.alias), ..path });
                }
                segments.truncate(prefix.len());
                renamed = false;
            }
            TokenTree::Group(group) => {
                tree(group.stream(), &segments, from, paths);
                segments.truncate(prefix.len());
            }
            TokenTree::Ident(word) if word == "as" => renamed = true,
            TokenTree::Ident(word) if renamed => alias = Some(word.to_string()),
            TokenTree::Ident(word) => {
                if word != "self" || segments.is_empty() {
                    segments.push(word.to_string());
                } else {
                    paths.push(named(&segments, from));
                }
            }
            TokenTree::Punct(star) if star.as_char() == '*' => segments.push("*".into()),
            _ => {}
        }
    }
}

/// A path as it is kept; `from`: the module, and whether it is a re-export.
fn named(segments: &[String], from: (&[String], bool)) -> Named {
    let alias = segments.last().cloned().unwrap_or_default();
    Named { segments: resolved(segments, from.0), line: 0, reexport: from.1, alias }
}

/// Words before the name of an item that a file defines.
const DEFINING: [&str; 8] = ["struct", "enum", "trait", "fn", "type", "const", "static", "union"];

/// Those of them before the name of a type.
const TYPES: [&str; 5] = ["struct", "enum", "trait", "type", "union"];

fn is_word(token: &TokenTree, words: &[&str]) -> bool {
    matches!(token, TokenTree::Ident(word) if words.iter().any(|w| word == w))
}

/// Whether an item begins with `pub` or `pub(...)` right before the end of `tokens`.
fn is_public(tokens: &[TokenTree]) -> bool {
    match tokens {
        [.., TokenTree::Ident(word)] => word == "pub",
        [.., TokenTree::Ident(word), TokenTree::Group(group)] => {
            word == "pub" && group.delimiter() == Delimiter::Parenthesis
        }
        _ => false,
    }
}

/// `super::x` and `self::x`, seen from `module`, as `crate::...::x`.
fn resolved(segments: &[String], module: &[String]) -> Vec<String> {
    let ups = segments.iter().take_while(|segment| *segment == "super").count();
    let (base, rest) = match segments.first().map(String::as_str) {
        Some("self") => (module, &segments[1..]),
        Some("super") => (&module[..module.len().saturating_sub(ups)], &segments[ups..]),
        _ => return segments.to_vec(),
    };
    std::iter::once("crate".to_owned()).chain(base.iter().cloned()).chain(rest.iter().cloned()).collect()
}

fn is_colons(tokens: &[TokenTree], at: usize) -> bool {
    let colon = |i| matches!(tokens.get(i), Some(TokenTree::Punct(p)) if p.as_char() == ':');
    colon(at) && colon(at + 1)
}

fn is_cfg_test(attribute: TokenStream) -> bool {
    let text: String = attribute.to_string().split_whitespace().collect();
    text == "cfg(test)"
}
