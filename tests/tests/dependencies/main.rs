//! What the project depends on keeps to the rules of `deploy/packages/deny.toml`: licences, sources, and one version of a
//! crate but for named exceptions. `cargo deny` reads the same file; it is not needed here.

mod expression;

use expression::is_satisfied;
use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;
use tests::deployed::{deployed, root};

/// The rules.
fn rules() -> toml::Table {
    deployed("packages/deny.toml").parse().unwrap()
}

/// The strings of a list of the rules.
fn strings(list: &toml::Value) -> BTreeSet<String> {
    list.as_array().unwrap().iter().map(|text| text.as_str().unwrap().to_owned()).collect()
}

/// The field `key` of every entry of a list of tables.
fn field(list: &toml::Value, key: &str) -> Vec<String> {
    list.as_array().unwrap().iter().map(|entry| entry[key].as_str().unwrap().to_owned()).collect()
}

/// A crate from elsewhere.
struct Foreign {
    name: String,
    version: String,
    licence: Option<String>,
}

/// Every crate from elsewhere that is compiled for some program or test of the workspace on the first system of the rules.
fn packages() -> Vec<Foreign> {
    let system = rules()["graph"]["targets"][0].as_str().unwrap().to_owned();
    let output = Command::new(env!("CARGO"))
        .args(["tree", "--workspace", "--locked", "--target", &system])
        .args(["--edges", "normal,build,dev", "--prefix", "none", "--format", "{p}|{l}|"])
        .current_dir(root())
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    // A crate is shown once for each that uses it; one of the workspace with its folder.
    let lines: BTreeSet<&str> = text.lines().filter(|line| !line.is_empty()).collect();
    let foreign = lines.into_iter().filter_map(|line| {
        let (package, rest) = line.split_once('|').unwrap();
        let (licence, _) = rest.split_once('|').unwrap();
        let mut words = package.split(' ');
        let (name, version) = (words.next().unwrap(), words.next().unwrap());
        let licence = Some(licence.to_owned()).filter(|text| !text.is_empty());
        let is_own = words.next().is_some_and(|word| word.starts_with("(/"));
        (!is_own).then(|| Foreign {
            name: name.to_owned(),
            version: version.trim_start_matches('v').to_owned(),
            licence,
        })
    });
    let foreign: Vec<Foreign> = foreign.collect();
    assert!(foreign.len() > 300, "only {} crates were read", foreign.len());
    foreign
}

/// Names, versions and sources of `Cargo.lock`, for all systems; without a source, those of the workspace.
fn locked() -> Vec<(String, String, Option<String>)> {
    let text = std::fs::read_to_string(root().join("Cargo.lock")).unwrap();
    let lock: toml::Table = text.parse().unwrap();
    let text = |package: &toml::Value, key: &str| package.get(key).map(|v| v.as_str().unwrap().to_owned());
    let packages = lock["package"].as_array().unwrap().iter();
    packages.map(|p| (text(p, "name").unwrap(), text(p, "version").unwrap(), text(p, "source"))).collect()
}

#[track_caller]
fn none(found: &[String]) {
    assert!(found.is_empty(), "\n{}\n", found.join("\n"));
}

#[test]
fn licences_are_allowed() {
    let rules = rules();
    let rules = &rules["licenses"];
    let allow = strings(&rules["allow"]);
    let exceptions: BTreeMap<String, BTreeSet<String>> = rules["exceptions"]
        .as_array()
        .unwrap()
        .iter()
        .map(|entry| (entry["crate"].as_str().unwrap().to_owned(), strings(&entry["allow"])))
        .collect();
    let clarified: BTreeMap<String, String> =
        field(&rules["clarify"], "crate").into_iter().zip(field(&rules["clarify"], "expression")).collect();
    let (mut found, mut used) = (Vec::new(), BTreeSet::new());
    for package in packages() {
        let name = package.name.as_str();
        let label = format!("{name} {}", package.version);
        let expression = match (package.licence.as_deref(), clarified.get(name)) {
            (Some(stated), None) => stated,
            (None, Some(clarified)) => clarified,
            (None, None) => {
                found.push(format!("{label}: no licence is stated; see [[licenses.clarify]]"));
                continue;
            }
            (Some(stated), Some(_)) => {
                found.push(format!("{label}: states {stated}; its clarification can go"));
                continue;
            }
        };
        let of_this = exceptions.get(name);
        let mut allowed = |licence: &str| {
            if allow.contains(licence) {
                used.insert(licence.to_owned());
                return true;
            }
            let excepted = of_this.is_some_and(|licences| licences.contains(licence));
            if excepted {
                used.insert(name.to_owned());
            }
            excepted
        };
        match is_satisfied(expression, &mut allowed) {
            Some(true) => {}
            Some(false) => found.push(format!("{label}: {expression} is not allowed")),
            None => found.push(format!("{label}: {expression} is no licence expression")),
        }
    }
    let listed = allow.iter().chain(exceptions.keys());
    found.extend(
        listed.filter(|entry| !used.contains(*entry)).map(|entry| format!("{entry}: no longer used")),
    );
    none(&found);
}

#[test]
fn every_crate_comes_from_an_allowed_registry() {
    let allowed = strings(&rules()["sources"]["allow-registry"]);
    let own = ["common", "coordinator", "sessions", "statistics", "tests", "worker"];
    let mut found = Vec::new();
    for (name, version, source) in locked() {
        let is_allowed = match &source {
            None => own.contains(&name.as_str()),
            Some(source) => source.strip_prefix("registry+").is_some_and(|from| allowed.contains(from)),
        };
        if !is_allowed {
            found.push(format!("{name} {version}: comes from {}", source.as_deref().unwrap_or("a folder")));
        }
    }
    none(&found);
}

/// Whether `version` is one of `wanted`, which may leave out the last parts.
fn is_version(version: &str, wanted: &str) -> bool {
    version.strip_prefix(wanted).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
}

#[test]
fn second_versions_are_listed_and_needed() {
    let mut versions: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for package in packages() {
        versions.entry(package.name).or_default().insert(package.version);
    }
    let rules = rules();
    let skipped: Vec<String> = field(&rules["bans"]["skip"], "crate");
    assert_eq!(field(&rules["bans"]["skip"], "reason").iter().filter(|reason| reason.is_empty()).count(), 0);
    let skipped: Vec<(&str, &str)> = skipped.iter().map(|entry| entry.split_once('@').unwrap()).collect();
    let mut found = Vec::new();
    for (name, all) in &versions {
        let rest: Vec<&String> = all
            .iter()
            .filter(|version| !skipped.iter().any(|(skip, of)| skip == name && is_version(version, of)))
            .collect();
        if rest.len() > 1 {
            found.push(format!("{name}: {rest:?}; update what asks for the earlier one, or list it"));
        }
    }
    for (name, version) in &skipped {
        let needed = versions
            .get(*name)
            .is_some_and(|all| all.len() > 1 && all.iter().any(|found| is_version(found, version)));
        if !needed {
            found.push(format!("{name}@{version}: no longer a second version; take it off the list"));
        }
    }
    none(&found);
}

/// A crate that is no longer maintained stays only with a line about what is done.
#[test]
fn unmaintained_crates_are_in_the_table() {
    let page = deployed("README.md");
    let section = page.split_once("## Dependencies\n").expect("a section").1;
    let section = section.split("\n## ").next().unwrap();
    let rows: BTreeSet<&str> = section
        .lines()
        .filter_map(|line| line.strip_prefix("| `")?.split_once('`'))
        .map(|(name, _)| name)
        .collect();
    let reasons = field(&rules()["advisories"]["ignore"], "reason");
    let ignored: BTreeSet<&str> = reasons.iter().map(|reason| reason.split_once(':').unwrap().0).collect();
    let locked: BTreeSet<String> = locked().into_iter().map(|(name, _, _)| name).collect();
    assert!(!ignored.is_empty() && ignored.is_subset(&rows), "{ignored:?} are not all in {rows:?}");
    let gone: Vec<&&str> = rows.iter().filter(|name| !locked.contains(**name)).collect();
    assert!(gone.is_empty(), "{gone:?} are no dependencies any more");
}
