//! Sets `HINGEWISE_BUILD` to the digest of what determines the bits of a simulation: the sources of `worker` and `common`, the locked
//! versions of their dependencies, and the platform, whose elementary functions may round differently.

use std::path::{Path, PathBuf};

fn main() {
    // Relative to this package, as the dependencies that it prints are: a target directory may serve several checkouts.
    let root = Path::new("..");
    let mut files = vec![root.join("Cargo.lock")];
    for crate_name in ["worker", "common"] {
        sources(&root.join(crate_name).join("src"), &mut files);
    }
    files.sort();
    let mut digest = Fnv::default();
    for file in files {
        println!("cargo::rerun-if-changed={}", file.display());
        // Without a lock file the versions are not known.
        digest.add(&std::fs::read(&file).unwrap_or_default());
    }
    for variable in ["CARGO_CFG_TARGET_ARCH", "CARGO_CFG_TARGET_OS", "CARGO_CFG_TARGET_ENV"] {
        digest.add(std::env::var(variable).unwrap_or_default().as_bytes());
    }
    println!("cargo::rustc-env=HINGEWISE_BUILD={:016x}", digest.0);
}

/// The Rust sources below a folder, without tests.
fn sources(folder: &Path, files: &mut Vec<PathBuf>) {
    println!("cargo::rerun-if-changed={}", folder.display());
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        let name = entry.file_name().to_string_lossy().into_owned();
        if path.is_dir() {
            sources(&path, files);
        } else if name.ends_with(".rs") && !name.ends_with("tests.rs") {
            files.push(path);
        }
    }
}

/// FNV-1a hash, 64 bit: the same in every version of the compiler.
struct Fnv(u64);

impl Default for Fnv {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Fnv {
    fn add(&mut self, bytes: &[u8]) {
        let mut hash = |byte: u8| self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        bytes.iter().for_each(|byte| hash(*byte));
        bytes.len().to_le_bytes().into_iter().for_each(hash);
    }
}
