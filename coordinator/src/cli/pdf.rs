//! Prints a page to a PDF file with a browser of this machine.

use super::CommandError;
use std::ffi::OsStr;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Browsers that print without a window, in the order of preference.
const BROWSERS: [&str; 5] =
    ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "microsoft-edge"];

/// The first browser in the folders of `path`, the value of the environment variable PATH.
fn browser(path: &OsStr) -> Option<PathBuf> {
    BROWSERS.iter().find_map(|name| {
        std::env::split_paths(path).map(|folder| folder.join(name)).find(|file| file.is_file())
    })
}

/// Prints a page to the file of the same name that ends in `.pdf`, with a browser from the folders of `path`; returns the
/// file.
///
/// # Errors
/// [`CommandError::Failed`] if none of the browsers is there, starts or writes a file.
pub fn print_page(page: &Path, path: &OsStr) -> Result<PathBuf, CommandError> {
    let no_pdf = |fault: String| CommandError::Failed(format!("no PDF: {fault}"));
    let browser = browser(path).ok_or_else(|| {
        let (browsers, page) = (BROWSERS.join(", "), page.display());
        no_pdf(format!(
            "none of {browsers} is on the path; open {page} in any browser and print it to a file, its style sheet is made for A4"
        ))
    })?;
    let not_started =
        |error: std::io::Error| no_pdf(format!("{} cannot be started: {error}", browser.display()));
    let page = std::path::absolute(page).map_err(not_started)?;
    let file = page.with_extension("pdf");
    if let Err(error) = std::fs::remove_file(&file)
        && error.kind() != std::io::ErrorKind::NotFound
    {
        return Err(not_started(error));
    }
    // A profile of its own: a browser with open windows would take the page over and print nothing.
    let profile = tempfile::tempdir().map_err(not_started)?;
    let mut command = Command::new(&browser);
    command
        .args([
            "--headless",
            "--disable-gpu",
            "--disable-background-networking",
            "--no-first-run",
            "--no-pdf-header-footer",
        ])
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .arg(format!("--print-to-pdf={}", file.display()));
    // Chromium refuses to start as root (the owner of the new profile) in its sandbox; the page is this program's own and loads
    // nothing.
    if std::fs::metadata(profile.path()).map_err(not_started)?.uid() == 0 {
        command.arg("--no-sandbox");
    }
    let done = command.arg(&page).output().map_err(not_started)?;
    if file.is_file() {
        return Ok(file);
    }
    let messages = String::from_utf8_lossy(&done.stderr);
    let message = messages.lines().rev().find(|line| !line.trim().is_empty()).unwrap_or("none");
    Err(no_pdf(format!("{} wrote no file; its last message: {message}", browser.display())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::fs::PermissionsExt;

    /// A folder with a program `google-chrome` of these lines of the shell, and a page next to it.
    fn with_browser(lines: &str) -> (tempfile::TempDir, PathBuf) {
        let dir = tempfile::tempdir().expect("a folder");
        let program = dir.path().join("google-chrome");
        std::fs::write(&program, format!("#!/bin/sh\n{lines}\n")).expect("a program");
        std::fs::set_permissions(&program, std::fs::Permissions::from_mode(0o755)).expect("its rights");
        let page = dir.path().join("report.html");
        std::fs::write(&page, "<p>a</p>").expect("a page");
        (dir, page)
    }

    #[test]
    fn a_browser_on_the_path_prints_the_page() {
        let lines = "for word; do case $word in --print-to-pdf=*) out=${word#*=};; esac; last=$word; done\n\
                     /bin/cp \"$last\" \"$out\"";
        let (dir, page) = with_browser(lines);
        let file = print_page(&page, dir.path().as_os_str()).expect("a PDF file");
        assert_eq!(file, dir.path().join("report.pdf"));
        assert_eq!(std::fs::read_to_string(file).expect("the copy"), "<p>a</p>");
    }

    #[test]
    fn without_a_file_or_a_browser_there_is_a_sentence() {
        let (dir, page) = with_browser("echo first >&2; echo no display >&2; exit 3");
        // A file from before is no result.
        std::fs::write(page.with_extension("pdf"), "old").expect("an old file");
        let said = print_page(&page, dir.path().as_os_str()).unwrap_err().to_string();
        assert!(said.ends_with("google-chrome wrote no file; its last message: no display"), "{said}");
        let said = print_page(&page, OsStr::new("")).unwrap_err().to_string();
        assert!(
            said.starts_with("no PDF: none of chromium, ") && said.contains("report.html in any browser"),
            "{said}"
        );
    }
}
