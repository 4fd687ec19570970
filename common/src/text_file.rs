//! Reads files of text that a person wrote, with reasons in words where they cannot be read.

use std::io::ErrorKind;
use std::path::Path;

/// The text of a file; `expected` says what it should be, e.g. `a CSV file`.
///
/// # Errors
/// Why it cannot be read, and what to do, as a clause that follows the name of the file.
pub fn read_text(path: &Path, expected: &str) -> Result<String, String> {
    // Neither a device nor a pipe: it may have no end.
    if std::fs::metadata(path).is_ok_and(|of| !of.is_file() && !of.is_dir()) {
        return Err(format!("it is no file but a device or a pipe, expected {expected}"));
    }
    let bytes = std::fs::read(path).map_err(|error| match error.kind() {
        ErrorKind::NotFound => "there is no such file".to_owned(),
        ErrorKind::IsADirectory => format!("it is a folder, expected {expected}"),
        ErrorKind::PermissionDenied => "reading it is not permitted".to_owned(),
        _ => error.to_string(),
    })?;
    let is_text = !bytes.contains(&0);
    String::from_utf8(bytes).map_err(|_| match is_text {
        true => "its letters are not in UTF-8: save it as UTF-8 (Excel: \"CSV UTF-8\")".to_owned(),
        false => format!("it is no text, expected {expected}"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn issue_a_file_that_cannot_be_read_was_answered_with_a_number_of_the_system() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("units.csv");
        let said = |path: &Path| read_text(path, "a CSV file").unwrap_err();
        assert_eq!(said(&file), "there is no such file");
        assert_eq!(said(folder.path()), "it is a folder, expected a CSV file");
        assert_eq!(said(Path::new("/dev/zero")), "it is no file but a device or a pipe, expected a CSV file");
        std::fs::write(&file, b"gap [\xb5m]\n1\n").unwrap();
        assert!(said(&file).contains("save it as UTF-8"), "{}", said(&file));
        std::fs::write(&file, b"\x7fELF\0\xff").unwrap();
        assert_eq!(said(&file), "it is no text, expected a CSV file");
        std::fs::write(&file, "gap [µm]\n").unwrap();
        assert_eq!(read_text(&file, "a CSV file").unwrap(), "gap [µm]\n");
    }
}
