//! A table as text for a terminal: columns as wide as their widest cell, two spaces apart.

/// The rows as lines. Columns stand to the right, those numbered in `to_the_left` to the left; a row may have fewer cells.
pub fn in_columns(rows: &[Vec<String>], to_the_left: &[usize]) -> String {
    let length = |text: &String| text.chars().count();
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |k: usize| rows.iter().filter_map(|row| row.get(k)).map(length).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let line = |row: &Vec<String>| {
        let cells = row.iter().zip(&widths).enumerate().map(|(k, (cell, width))| {
            let space = " ".repeat(width - length(cell));
            let gap = if k == 0 { "" } else { "  " };
            if to_the_left.contains(&k) {
                format!("{gap}{cell}{space}")
            } else {
                format!("{gap}{space}{cell}")
            }
        });
        format!("{}\n", cells.collect::<String>().trim_end())
    };
    rows.iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn issue_columns_of_long_numbers_touched_each_other() {
        let rows = [["cycles", "R wear", "form"], ["4", "0.999815 ± 0.000068", "a"]];
        let rows = rows.map(|row| row.map(str::to_owned).to_vec());
        assert_eq!(
            in_columns(&rows, &[2]),
            "cycles               R wear  form\n     4  0.999815 ± 0.000068  a\n"
        );
    }
}
