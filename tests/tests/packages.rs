//! The packages made by `deploy/packages/build.sh` hold programs that run from where they are unpacked, and the Python package
//! passes its tests with the programs of this build.

use serde_json::Value;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tests::deployed::{deployed, if_installed, root};
use tests::{program, skipped};

const VERSION: &str = env!("CARGO_PKG_VERSION");

#[track_caller]
fn done(command: &mut Command) -> String {
    let Output { status, stdout, stderr } = command.output().unwrap();
    assert!(status.success(), "{command:?}: {}", String::from_utf8_lossy(&stderr));
    String::from_utf8(stdout).unwrap()
}

/// Python of the first version with `tomllib`: that of `.ci/run`, which has pandas, or the one on the search path.
fn python(what: &str) -> Option<PathBuf> {
    let test = std::env::current_exe().unwrap();
    let own = test.ancestors().nth(3).unwrap().join("umbridge/bin/python");
    for python in [own, "python3".into()] {
        if Command::new(&python).args(["-c", "import tomllib"]).output().is_ok_and(|o| o.status.success()) {
            return Some(python);
        }
    }
    skipped(what, "there is no python3 of version 3.11 or newer");
    None
}

#[test]
fn the_python_package_passes_its_tests() {
    let Some(python) = python("the Python package") else { return };
    let mut tests = Command::new(python);
    tests
        .args(["-m", "unittest", "-v", "test_hingewise", "test_cycles"])
        .current_dir(root().join("deploy/python/tests"));
    tests.env("HINGEWISE_COORDINATOR", program("coordinator")).env("PYTHONDONTWRITEBYTECODE", "1");
    let output = tests.output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    assert!(said.contains("test_rows_have_the_values_of_the_files"), "{said}");
    for line in said.lines().filter(|line| line.contains("skipped")) {
        skipped("the Python package", line);
    }
}

#[test]
fn the_types_of_the_python_package_are_right() {
    let Some(python) = python("the types of the Python package") else { return };
    let mut mypy = Command::new(python);
    mypy.args(["-m", "mypy", "--no-incremental", "hingewise"]).current_dir(root().join("deploy/python"));
    let output = mypy.output().unwrap();
    if String::from_utf8_lossy(&output.stderr).contains("No module named mypy") {
        return skipped("the types of the Python package", "mypy is not installed");
    }
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
}

#[test]
fn the_python_package_has_the_version_of_the_programs() {
    let project: toml::Table = deployed("python/pyproject.toml").parse().unwrap();
    assert_eq!(project["project"]["version"].as_str(), Some(VERSION));
}

/// The packages of the programs of this build, and what may not be installed here.
fn packages(folder: &Path) -> Option<()> {
    let what = "the packages";
    python(what)?;
    if_installed(what, Command::new("objdump").arg("--version"))?;
    if_installed(what, Command::new("dpkg-deb").arg("--version"))?;
    program("worker");
    let mut build = Command::new(root().join("deploy/packages/build.sh"));
    build.arg(folder).arg(program("coordinator").parent().unwrap());
    let said = done(&mut build);
    assert!(said.contains("oldest C library: glibc 2."), "{said}");
    Some(())
}

/// The one file of a folder with this end.
fn the(folder: &Path, end: &str) -> PathBuf {
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let found: Vec<PathBuf> =
        files.filter(|path| path.file_name().unwrap().to_str().unwrap().ends_with(end)).collect();
    assert_eq!(found.len(), 1, "{end}: {found:?}");
    found.into_iter().next().unwrap()
}

/// Manual pages, completions, licences and bill of materials below `share`; `compressed` is the end of a manual page.
fn assert_complete(share: &Path, compressed: &str) {
    let pages = [
        format!("man/man1/coordinator.1{compressed}"),
        format!("man/man1/coordinator-run.1{compressed}"),
        format!("man/man1/worker.1{compressed}"),
    ];
    let completions = ["coordinator", "worker"].map(|name| format!("bash-completion/completions/{name}"));
    let fish = ["coordinator", "worker"].map(|name| format!("fish/vendor_completions.d/{name}.fish"));
    let manual = ["coordinator/doc/tutorial.md", "common/scenes/README.md"]
        .map(|name| format!("doc/hingewise/{name}"));
    for file in pages.iter().chain(&completions).chain(&fish).chain(&manual) {
        assert!(share.join(file).metadata().is_ok_and(|file| file.len() > 500), "{file}");
    }
    let licences = std::fs::read_to_string(share.join("doc/hingewise/third-party-licences.txt")).unwrap();
    let text = std::fs::read_to_string(share.join("doc/hingewise/sbom.cdx.json")).unwrap();
    let bill: Value = serde_json::from_str(&text).unwrap();
    assert_eq!((bill["bomFormat"].as_str(), bill["specVersion"].as_str()), (Some("CycloneDX"), Some("1.6")));
    let whole = format!("pkg:generic/hingewise@{VERSION}");
    let components = bill["components"].as_array().unwrap();
    let mut references: BTreeSet<&str> = [whole.as_str()].into();
    for component in components {
        let (name, version) = (component["name"].as_str().unwrap(), component["version"].as_str().unwrap());
        references.insert(component["bom-ref"].as_str().unwrap());
        assert!(component["licenses"][0]["expression"].is_string(), "{name}");
        if ["common", "coordinator", "sessions", "statistics", "worker"].contains(&name) {
            continue;
        }
        assert_eq!(component["hashes"][0]["content"].as_str().unwrap().len(), 64, "{name}");
        assert!(licences.contains(&format!("\n{name} {version}: ")), "{name} has no licence in the list");
    }
    assert!(components.len() > 300 && components.iter().any(|component| component["name"] == "zenoh"));
    assert!(!components.iter().any(|component| component["name"] == "proptest"), "a crate for tests only");
    for node in bill["dependencies"].as_array().unwrap() {
        let used = node["dependsOn"].as_array().unwrap().iter().chain([&node["ref"]]);
        assert!(used.into_iter().all(|reference| references.contains(reference.as_str().unwrap())));
    }
}

#[track_caller]
fn assert_runs(programs: &Path) {
    for name in ["coordinator", "worker"] {
        assert_eq!(done(Command::new(programs.join(name)).arg("--version")), format!("{name} {VERSION}\n"));
    }
    let scenes = done(Command::new(programs.join("coordinator")).arg("scenes"));
    assert!(scenes.contains("four-bar"), "{scenes}");
}

#[test]
fn packages_are_unpacked_and_their_programs_run() {
    let folder = tempfile::tempdir().unwrap();
    let made = folder.path().join("made");
    if packages(&made).is_none() {
        return;
    }

    let unpacked = folder.path().join("archive");
    std::fs::create_dir(&unpacked).unwrap();
    done(Command::new("tar").arg("-xzf").arg(the(&made, ".tar.gz")).arg("-C").arg(&unpacked));
    let tree = the(&unpacked, "-linux-gnu");
    assert_runs(&tree.join("bin"));
    assert_complete(&tree.join("share"), "");

    let installed = folder.path().join("debian");
    let deb = the(&made, ".deb");
    done(Command::new("dpkg-deb").arg("-x").arg(&deb).arg(&installed));
    assert_runs(&installed.join("usr/bin"));
    assert_complete(&installed.join("usr/share"), ".gz");
    assert!(installed.join("usr/share/doc/hingewise/copyright").is_file());
    for unit in ["coordinator", "worker"] {
        let file = installed.join(format!("usr/lib/systemd/system/hingewise-{unit}.service"));
        let text = std::fs::read_to_string(file).unwrap();
        assert!(text.contains(&format!("/usr/bin/{unit} ")) && !text.contains("/opt/"), "{text}");
        for named in text.split(['"', ' ', '\n']).filter_map(|word| word.split_once("file://")) {
            assert!(installed.join(named.1.trim_start_matches('/')).is_file(), "{}", named.1);
        }
    }
    let field = |name: &str| done(Command::new("dpkg-deb").arg("-f").arg(&deb).arg(name));
    assert_eq!(field("Version"), format!("{VERSION}-1\n"));
    assert!(field("Depends").starts_with("libc6 (>= 2."));

    let wheel = the(&made, ".whl");
    let python = python("the wheel").unwrap();
    let target = folder.path().join("python");
    let mut pip = Command::new(&python);
    pip.args(["-m", "pip", "install", "-q", "--no-index", "--no-deps", "--target"]).arg(&target).arg(&wheel);
    if Command::new(&python).args(["-m", "pip", "--version"]).output().is_ok_and(|o| o.status.success()) {
        done(&mut pip);
        assert_runs(&target.join("bin"));
        let code = "import hingewise; print(len(hingewise.call('scenes')))";
        let mut import = Command::new(&python);
        import.args(["-c", code]).env("PYTHONPATH", &target);
        import.env("HINGEWISE_COORDINATOR", target.join("bin/coordinator"));
        assert!(done(&mut import).trim().parse::<usize>().unwrap() > 3);
    } else {
        skipped("the wheel", "pip is not installed");
    }
}
