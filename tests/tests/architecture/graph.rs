//! The graph of source files: which file uses an item that another one defines. Re-exports (`pub use`) are
//! followed to the file that defines the item and are no use of it.

use super::paths::{SourceFile, module_of};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The files of a crate, and which of them each one uses.
pub struct FileGraph<'a> {
    files: &'a BTreeMap<PathBuf, SourceFile>,
    by_module: BTreeMap<Vec<String>, &'a Path>,
}

impl<'a> FileGraph<'a> {
    /// The graph of the files of one crate.
    pub fn new(files: &'a BTreeMap<PathBuf, SourceFile>) -> Self {
        // The binary's root has the module of the library's; it uses everything and is used by nothing.
        let by_module = files
            .keys()
            .filter(|file| *file != Path::new("main.rs"))
            .map(|file| (module_of(file), file.as_path()))
            .collect();
        Self { files, by_module }
    }

    /// For each file the files whose items it uses.
    pub fn uses(&self) -> BTreeMap<&'a Path, BTreeSet<&'a Path>> {
        let roots = [Path::new("lib.rs"), Path::new("main.rs")];
        self.files
            .iter()
            .filter(|(file, _)| !roots.contains(&file.as_path()))
            .map(|(file, source)| {
                let own = module_of(file);
                let used = source
                    .paths
                    .iter()
                    .filter(|path| !path.reexport)
                    .filter_map(|path| self.definer(&absolute(&path.segments, &own, source)?, 0))
                    .filter(|used| *used != file.as_path() && !roots.contains(used));
                (file.as_path(), used.collect())
            })
            .collect()
    }

    /// The file that defines the item a path leads to. `segments`: without `crate`.
    fn definer(&self, segments: &[String], depth: usize) -> Option<&'a Path> {
        let length = (0..=segments.len())
            .rev()
            .find(|&length| self.by_module.contains_key(&segments[..length]))
            .expect("the root is a module");
        let (module, rest) = segments.split_at(length);
        let file = self.by_module[module];
        let source = &self.files[file];
        let Some(item) = rest.first().filter(|item| *item != "*" && !source.defined.contains(*item)) else {
            return Some(file);
        };
        // Eight re-exports of re-exports are a circle of them.
        let follow = |path: Vec<String>| if depth < 8 { self.definer(&path, depth + 1) } else { None };
        if let Some(import) = source.paths.iter().find(|path| path.alias == *item) {
            return follow(absolute(&import.segments, module, source)?);
        }
        // `pub use x::*`: the first module with such an item.
        source
            .paths
            .iter()
            .filter(|path| path.reexport && path.alias == "*")
            .filter_map(|path| {
                let mut path = absolute(&path.segments, module, source)?;
                path.pop();
                let defines =
                    self.by_module.get(&path).is_some_and(|file| self.files[*file].defined.contains(item));
                defines.then(|| self.by_module[&path])
            })
            .next()
            .or(Some(file))
    }

    /// Circles: groups of files of which each uses, directly or through others of the group, every other one.
    pub fn circles(&self) -> Vec<Vec<&'a Path>> {
        let uses = self.uses();
        let reached: BTreeMap<&Path, BTreeSet<&Path>> =
            uses.keys().map(|file| (*file, reach(file, &uses))).collect();
        let mut found: Vec<Vec<&Path>> = Vec::new();
        for &file in uses.keys() {
            if found.iter().any(|circle| circle.contains(&file)) || !reached[file].contains(file) {
                continue;
            }
            found.push(
                uses.keys()
                    .copied()
                    .filter(|other| reached[file].contains(other) && reached[other].contains(file))
                    .collect(),
            );
        }
        found
    }
}

/// All files that `file` uses directly or through others.
fn reach<'a>(file: &'a Path, uses: &BTreeMap<&'a Path, BTreeSet<&'a Path>>) -> BTreeSet<&'a Path> {
    let mut found = BTreeSet::new();
    let mut open = vec![file];
    while let Some(next) = open.pop() {
        for &used in uses.get(next).into_iter().flatten() {
            if found.insert(used) {
                open.push(used);
            }
        }
    }
    found
}

/// Segments from the crate's root, without `crate`, of a path named in module `own`; `None` for another crate's.
fn absolute(segments: &[String], own: &[String], source: &SourceFile) -> Option<Vec<String>> {
    match segments {
        [first, rest @ ..] if first == "crate" => Some(rest.to_vec()),
        [first, ..] if source.modules.contains(first) => Some([own, segments].concat()),
        _ => None,
    }
}
