//! The replies of a life under way in a file, so that another worker goes on where one has died: no cycle is simulated twice but the one
//! under way.
//!
//! A file belongs to a life: scene, sample and accuracy. A line has the digest of a request and the reply to it. A line that was not
//! finished counts for nothing. The request contains the surfaces, which follow from the replies before it: a life that goes on has the
//! same bits. The file is removed at the end of the life.

use crate::scene::source::digest;
use std::collections::BTreeMap;
use std::fs::{File, OpenOptions, create_dir_all, read_to_string, remove_file};
use std::io::{Result, Write};
use std::path::{Path, PathBuf};

/// The journal of one life.
#[derive(Debug)]
pub struct CycleJournal {
    path: PathBuf,
    known: BTreeMap<u128, String>,
    file: File,
}

impl CycleJournal {
    /// Opens the journal of the life identified by the text `life` in `folder`, which is created if missing.
    ///
    /// # Errors
    /// The file cannot be read or written.
    pub fn open(folder: &Path, life: &str) -> Result<Self> {
        create_dir_all(folder)?;
        let path = folder.join(format!("{:032x}.cycles", digest(life)));
        let text = if path.exists() { read_to_string(&path)? } else { String::new() };
        let entry = |line: &str| {
            let (digest, reply) = line.strip_suffix('\n')?.split_once(' ')?;
            Some((u128::from_str_radix(digest, 16).ok()?, serde_json::from_str(reply).ok()?))
        };
        let known = text.split_inclusive('\n').filter_map(entry).collect();
        let mut file = OpenOptions::new().create(true).append(true).open(&path)?;
        if !text.is_empty() && !text.ends_with('\n') {
            file.write_all(b"\n")?;
        }
        Ok(CycleJournal { path, known, file })
    }

    /// The reply to a request, if it is known.
    pub fn reply(&self, request: &str) -> Option<&str> {
        self.known.get(&digest(request)).map(String::as_str)
    }

    /// Adds the reply to a request.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn add(&mut self, request: &str, reply: &str) -> Result<()> {
        let text = serde_json::to_string(reply)?;
        self.file.write_all(format!("{:032x} {text}\n", digest(request)).as_bytes())?;
        self.file.sync_data()
    }

    /// Removes the file, at the end of the life.
    ///
    /// # Errors
    /// The file cannot be removed.
    pub fn remove(self) -> Result<()> {
        remove_file(self.path)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reply_outlives_its_worker_and_half_a_line_does_not() {
        let folder = tempfile::tempdir().unwrap();
        let mut journal = CycleJournal::open(folder.path(), "life").unwrap();
        journal.add("first", "{\"a\":\n1}").unwrap();
        journal.add("second", "2").unwrap();
        drop(journal);
        let path = folder.path().join(format!("{:032x}.cycles", digest("life")));
        let text = read_to_string(&path).unwrap();
        std::fs::write(&path, &text[..text.len() - 2]).unwrap();
        let mut journal = CycleJournal::open(folder.path(), "life").unwrap();
        assert_eq!((journal.reply("first"), journal.reply("second")), (Some("{\"a\":\n1}"), None));
        journal.add("second", "3").unwrap();
        let journal = CycleJournal::open(folder.path(), "life").unwrap();
        assert_eq!(journal.reply("second"), Some("3"));
        assert_eq!(CycleJournal::open(folder.path(), "other").unwrap().reply("first"), None);
        journal.remove().unwrap();
        assert!(!path.exists());
    }
}
