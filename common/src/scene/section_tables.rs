//! Tables below a table: of one key, of names, and rows of lists with unique names.

use super::faults::FaultKind;
use super::section::Section;
use toml::Value;

/// Tables below this one.
impl<'s> Section<'s> {
    /// A required table.
    pub fn section(&mut self, key: &'static str, expected: &str) -> Option<Section<'s>> {
        self.require(key, || expected.to_owned())?;
        self.section_if_any(key)
    }

    /// An optional table.
    pub(super) fn section_if_any(&mut self, key: &'static str) -> Option<Section<'s>> {
        let value = self.get(key)?;
        self.as_section(key, value)
    }

    /// The tables of a table, each with its name.
    pub(super) fn named(&mut self, key: &'static str) -> Vec<(&'s str, Section<'s>)> {
        let Some(all) = self.section_if_any(key) else { return Vec::new() };
        all.entries()
            .filter_map(|(name, value)| Some((name.as_str(), all.as_section(name, value)?)))
            .collect()
    }

    fn as_section(&self, key: &str, value: &'s Value) -> Option<Section<'s>> {
        if let Some(table) = value.as_table() {
            return Some(Section::new(self.cx, self.key(key), table));
        }
        self.wrong_type(key, value, "a table");
        None
    }

    /// The rows of a list of tables without names; their paths have their numbers, from 1.
    pub fn unnamed_rows(&mut self, key: &'static str) -> Vec<Section<'s>> {
        let Some(value) = self.get(key) else { return Vec::new() };
        let Some(list) = value.as_array() else {
            self.wrong_type(key, value, format!("a list of tables [[{key}]]"));
            return Vec::new();
        };
        (1..)
            .zip(list)
            .filter_map(|(number, value)| self.as_section(&format!("{key}[{number}]"), value))
            .collect()
    }

    /// What `read` makes of each row of a list of tables with unique names; a key that it does not ask for is a fault.
    pub(super) fn each_row<T>(
        &mut self,
        key: &'static str,
        mut read: impl FnMut(&'s str, &mut Section<'s>) -> T,
    ) -> Vec<T> {
        let read = |(name, mut row): (&'s str, Section<'s>)| {
            let found = read(name, &mut row);
            row.finish();
            found
        };
        self.rows(key).into_iter().map(read).collect()
    }

    /// The rows of a list of tables, each with its unique name, which becomes the last part of its path.
    pub fn rows(&mut self, key: &'static str) -> Vec<(&'s str, Section<'s>)> {
        let path = self.key(key);
        let mut rows: Vec<(&str, Section)> = Vec::new();
        for mut row in self.unnamed_rows(key) {
            let Some(name) = row.text("name", "a name") else { continue };
            if rows.iter().any(|(taken, _)| *taken == name) {
                row.fault("name", FaultKind::Duplicate { what: path.clone(), value: name.to_owned() });
                continue;
            }
            if name.is_empty() || name.contains('.') || name.contains(char::is_control) {
                let reason = "names are not empty and have no dots or control characters".to_owned();
                row.fault("name", FaultKind::BadName { value: name.to_owned(), reason });
                continue;
            }
            row.path = format!("{path}.{name}");
            rows.push((name, row));
        }
        rows
    }
}
