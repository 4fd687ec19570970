//! Sets `HINGEWISE_COMMIT` to `, commit ` and the commit that the sources are from, with `-dirty` where files differ from it; to nothing
//! outside a repository. It looks again when the sources change, so that a commit alone costs no build.

use std::process::Command;

fn main() {
    for sources in [
        "src",
        "schemas",
        "statistics/src",
        "../common/src",
        "../common/scenes",
        "../worker/src",
        "../Cargo.lock",
    ] {
        println!("cargo::rerun-if-changed={sources}");
    }
    let described =
        Command::new("git").args(["describe", "--always", "--dirty", "--abbrev=12", "--exclude=*"]).output();
    let known = described.ok().filter(|output| output.status.success());
    let commit = known.map(|output| format!(", commit {}", String::from_utf8_lossy(&output.stdout).trim()));
    println!("cargo::rustc-env=HINGEWISE_COMMIT={}", commit.unwrap_or_default());
}
