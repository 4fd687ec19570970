//! Tables of cases as data: a section begins with `== ` and its name; a row is a line, its cells are between ` ¦ `, `\n` is a new line,
//! and `# ` begins a comment.

/// The rows of a section of `tables`.
pub fn rows<const N: usize>(tables: &str, section: &str) -> Vec<[&'static str; N]> {
    let begin = format!("== {section}\n");
    let (_, rest) = tables.split_once(&begin).unwrap_or_else(|| panic!("there is no section {section}"));
    let row = |line: &str| -> [&'static str; N] {
        let cells = line.split(" ¦ ").map(|cell| &*cell.replace("\\n", "\n").leak());
        cells.collect::<Vec<_>>().try_into().unwrap_or_else(|_| panic!("{section}: {line}"))
    };
    let own = rest.lines().take_while(|line| !line.starts_with("== "));
    own.filter(|line| !line.is_empty() && !line.starts_with("# ")).map(row).collect()
}
