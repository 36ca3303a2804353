//! CSV tables of a run.

use std::fs;
use std::path::Path;

/// A table whose first column is the time in seconds.
#[derive(Debug, Clone)]
pub struct Table {
    /// Titles with units.
    pub titles: Vec<String>,
    /// The rows, the time first; NaN for an empty cell.
    pub rows: Vec<Vec<f64>>,
}

/// Bit by bit, so that empty cells are equal.
impl PartialEq for Table {
    fn eq(&self, other: &Self) -> bool {
        let bits = |rows: &[Vec<f64>]| -> Vec<Vec<u64>> {
            rows.iter().map(|row| row.iter().map(|x| x.to_bits()).collect()).collect()
        };
        self.titles == other.titles && bits(&self.rows) == bits(&other.rows)
    }
}

impl Table {
    /// The times of the rows, s.
    pub fn times(&self) -> Vec<f64> {
        self.rows.iter().map(|row| row[0]).collect()
    }

    /// Whether every row is later than the one before.
    pub fn times_increase(&self) -> bool {
        self.rows.windows(2).all(|pair| pair[0][0] < pair[1][0])
    }

    /// The values of a column, by its title without unit.
    ///
    /// # Panics
    ///
    /// When there is no such column.
    #[track_caller]
    pub fn column(&self, name: &str) -> Vec<f64> {
        let title = |title: &String| title.split(" [").next() == Some(name);
        let index = self.titles.iter().position(title);
        let index = index.unwrap_or_else(|| panic!("no column {name} in {:?}", self.titles));
        self.rows.iter().map(|row| row[index]).collect()
    }
}

/// Reads a table strictly: every line ends, every row has as many numbers as there are titles.
///
/// # Panics
///
/// When that is not so.
#[track_caller]
pub fn read_table(path: &Path) -> Table {
    let text = fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    assert!(text.ends_with('\n'), "{} ends in the middle of a line", path.display());
    let mut lines = text.lines();
    let head = lines.next().unwrap_or_else(|| panic!("{} has no head", path.display()));
    let titles: Vec<String> = head.split(',').map(Into::into).collect();
    assert!(titles[0].starts_with("time"), "{}: {head}", path.display());
    let number = |text: &str| -> f64 {
        if text.is_empty() {
            return f64::NAN;
        }
        assert!(text != "NaN", "{} holds NaN", path.display());
        text.parse().unwrap_or_else(|_| panic!("{}: \"{text}\" is no number", path.display()))
    };
    let rows: Vec<Vec<f64>> = lines.map(|line| line.split(',').map(number).collect()).collect();
    for row in &rows {
        assert_eq!(row.len(), titles.len(), "{}: {row:?}", path.display());
    }
    Table { titles, rows }
}
