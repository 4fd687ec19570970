//! What the sources say of themselves: laws name their source, and every documented item gets more than a word.

use super::{CRATES, crate_sources, none, root};

/// Folders whose files hold formulas.
const LAWS: [&str; 13] = [
    "common/src/random",
    "worker/src/contact",
    "worker/src/integrate",
    "worker/src/quasi_static",
    "worker/src/wear",
    "worker/src/mechanism/elimination.rs",
    "worker/src/bore.rs",
    "worker/src/interpolate.rs",
    "coordinator/statistics/src/design",
    "coordinator/statistics/src/surrogate",
    "coordinator/statistics/src/learning",
    "coordinator/statistics/src/reliability",
    "coordinator/statistics/src/sensitivity",
];

/// Files of these folders without a formula: what they hold instead. A new file belongs here only if it computes
/// nothing that a reader would look up in a book.
const NO_LAW: [(&str, &str); 8] = [
    ("common/src/random/mod.rs", "list of modules"),
    ("common/src/random/distribution.rs", "dispatch to the distributions"),
    ("common/src/random/distribution/constant.rs", "one value with probability one"),
    ("worker/src/integrate/mod.rs", "interface of a system and list of modules"),
    ("worker/src/integrate/stepper.rs", "loop over the steps of `rosenbrock.rs`"),
    ("worker/src/integrate/lane_stepper.rs", "loop over the steps of `rosenbrock.rs`"),
    ("worker/src/wear/mod.rs", "list of modules"),
    ("coordinator/statistics/src/surrogate/form.rs", "names of kernel and trend"),
];

#[test]
fn every_law_names_its_source() {
    let mut found = Vec::new();
    let mut read = 0;
    for name in CRATES {
        for file in crate_sources(name).into_keys() {
            let path = format!("{name}/src/{}", file.display());
            if !LAWS.iter().any(|law| path.starts_with(law)) {
                continue;
            }
            read += 1;
            let has_source = std::fs::read_to_string(root().join(&path)).unwrap().contains("# Source");
            let excepted = NO_LAW.iter().any(|(file, _)| *file == path);
            match (has_source, excepted) {
                (false, false) => found.push(format!("{path}: no `# Source`")),
                (true, true) => found.push(format!("{path}: has a source: its exception can go")),
                _ => {}
            }
        }
    }
    assert!(read > 60, "only {read} files of laws were read");
    for (file, _) in NO_LAW {
        if !root().join(file).exists() {
            found.push(format!("{file}: an exception for a file that is not there"));
        }
    }
    none(&found);
}

/// A doc comment of one or two words, without a unit or a shape, repeats the name of its item.
#[test]
fn doc_comments_say_more_than_two_words() {
    let mut found = Vec::new();
    let mut read = 0;
    for name in CRATES {
        for file in crate_sources(name).into_keys() {
            let path = format!("{name}/src/{}", file.display());
            let text = std::fs::read_to_string(root().join(&path)).unwrap();
            let lines: Vec<Option<&str>> =
                text.lines().map(|line| line.trim_start().strip_prefix("///")).collect();
            for (k, line) in lines.iter().enumerate() {
                let alone = k.checked_sub(1).is_none_or(|before| lines[before].is_none())
                    && lines.get(k + 1).is_none_or(Option::is_none);
                let Some(line) = line.filter(|_| alone) else { continue };
                read += 1;
                let words = line.split_whitespace().count();
                if words <= 2
                    || ["The same ", "See the module"].iter().any(|start| line.trim().starts_with(start))
                {
                    found.push(format!("{path}:{}: {}", k + 1, line.trim()));
                }
            }
        }
    }
    assert!(read > 1000, "only {read} doc comments were read");
    none(&found);
}
