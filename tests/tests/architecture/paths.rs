//! The paths a source file names, read from its tokens: comments and strings do not count, and of macros what
//! stands in them does.

use proc_macro2::{Delimiter, TokenStream, TokenTree};
use std::path::Path;

/// A path such as `crate::wear::Profile`, where it stands.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Named {
    /// Segments; `self` and `super` are resolved to `crate`.
    pub segments: Vec<String>,
    /// Line, from 1.
    pub line: usize,
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
    walk(tokens, module, false, &mut source);
    source
}

fn walk(tokens: TokenStream, module: &[String], in_test: bool, out: &mut SourceFile) {
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
                    walk(group.stream(), module, in_test || marked, out);
                    // An item with a body ends with it.
                    marked &= attribute || group.delimiter() != Delimiter::Brace;
                }
            }
            TokenTree::Ident(word) if word == "mod" => {
                if let (Some(TokenTree::Ident(name)), Some(next)) = (tokens.get(at + 1), tokens.get(at + 2)) {
                    if let TokenTree::Group(body) = next {
                        let inner = [module, &[name.to_string()]].concat();
                        walk(body.stream(), &inner, in_test || marked, out);
                    } else if marked {
                        out.test_modules.push(name.to_string());
                    }
                    marked = false;
                    at += 2;
                }
            }
            TokenTree::Ident(word) => {
                let begin = at;
                let imports = begin > 0 && matches!(&tokens[begin - 1], TokenTree::Ident(u) if u == "use");
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
                let line = word.span().start().line;
                let group = if is_colons(&tokens, at + 1) { tokens.get(at + 3) } else { None };
                let paths = if in_test || marked { &mut out.test_paths } else { &mut out.paths };
                match group {
                    Some(TokenTree::Group(group)) => {
                        tree(group.stream(), &segments, module, paths);
                        at += 3;
                    }
                    Some(TokenTree::Punct(star)) if star.as_char() == '*' => {
                        segments.push("*".into());
                        paths.push(Named { segments: resolved(&segments, module), line });
                    }
                    _ if imports || segments.len() > 1 => {
                        paths.push(Named { segments: resolved(&segments, module), line });
                    }
                    _ => {}
                }
            }
            _ => {}
        }
        at += 1;
    }
}

/// The leaves of `{a, b::c, d::{e, f}}` after `prefix::`.
fn tree(tokens: TokenStream, prefix: &[String], module: &[String], paths: &mut Vec<Named>) {
    let mut segments = prefix.to_vec();
    let mut line = 0;
    let mut skip = false;
    let flush = |segments: &mut Vec<String>, line: usize, paths: &mut Vec<Named>| {
        if segments.len() > prefix.len() {
            paths.push(Named { segments: resolved(segments, module), line });
        }
        segments.truncate(prefix.len());
    };
    for token in tokens {
        match token {
            TokenTree::Punct(comma) if comma.as_char() == ',' => {
                flush(&mut segments, line, paths);
                skip = false;
            }
            TokenTree::Group(group) => {
                tree(group.stream(), &segments, module, paths);
                segments.truncate(prefix.len());
            }
            // What a name is called here does not matter.
            TokenTree::Ident(word) if word == "as" => skip = true,
            TokenTree::Ident(word) if !skip => {
                line = word.span().start().line;
                if word != "self" || segments.is_empty() {
                    segments.push(word.to_string());
                } else {
                    paths.push(Named { segments: resolved(&segments, module), line });
                }
            }
            _ => {}
        }
    }
    flush(&mut segments, line, paths);
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
