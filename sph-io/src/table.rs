//! CSV tables that grow by one row at a time: probes, energies, forces.

use std::fmt::Write as _;
use std::fs::{self, File, OpenOptions};
use std::io::Write as _;
use std::path::{Path, PathBuf};

use crate::IoError;
use crate::atomic::write_text_atomically;

/// Appends rows to a CSV table whose first column is the time in seconds.
///
/// The head names each column with its unit, `pressure [Pa]`. A row goes to the system in one
/// call as soon as it is given, so a process that dies leaves whole rows; resuming cuts off what
/// a machine that lost power may have left. A value that there is not, NaN, leaves its cell empty.
///
/// # Examples
///
/// ```
/// use sph_io::{TableWriter, read_table};
///
/// # fn main() -> Result<(), sph_io::IoError> {
/// # let folder = tempfile::tempdir().unwrap();
/// let path = folder.path().join("P1.csv");
/// let columns = [("pressure", "Pa"), ("depth", "m")];
/// let mut table = TableWriter::create(&path, &columns)?;
/// table.row(0.0, &[0.0, 0.3])?;
/// table.row(0.1, &[981.0, 0.2])?;
/// drop(table);
///
/// let mut table = TableWriter::resume(&path, &columns, 0.05)?;
/// table.row(0.1, &[980.0, 0.2])?;
/// assert_eq!(read_table(&path)?.column("pressure").unwrap(), [0.0, 980.0]);
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct TableWriter {
    path: PathBuf,
    file: File,
    values: usize,
    line: String,
}

impl TableWriter {
    /// Starts a table, in place of one that may be there. `columns` are pairs of name and unit,
    /// without the time; an empty unit is left out.
    ///
    /// # Errors
    ///
    /// [`IoError::Name`] for a name with a comma, quote, bracket or line break,
    /// [`IoError::Write`] when the file cannot be written.
    pub fn create(path: impl Into<PathBuf>, columns: &[(&str, &str)]) -> Result<Self, IoError> {
        let path = path.into();
        write_text_atomically(&path, &head(columns)?)?;
        Self::append(path, columns.len())
    }

    /// Continues a table from `time`: a cut last row and rows of later times are dropped.
    ///
    /// A table that does not exist yet is started.
    ///
    /// # Errors
    ///
    /// [`IoError::Text`] when the table has another head or is damaged, [`IoError::Write`].
    pub fn resume(
        path: impl Into<PathBuf>,
        columns: &[(&str, &str)],
        time: f64,
    ) -> Result<Self, IoError> {
        let path = path.into();
        let head = head(columns)?;
        if !path.exists() {
            return Self::create(path, columns);
        }
        let text = fs::read_to_string(&path).map_err(IoError::read(&path))?;
        if !text.starts_with(&head) {
            let found = text.lines().next().unwrap_or_default();
            return Err(text_error(
                &path,
                1,
                format!(
                    "the head is \"{found}\" but this run writes \"{}\": the probes of the scene \
                     changed; move the table away",
                    head.trim_end()
                ),
            ));
        }
        let keep = head.len() + kept(&path, &text[head.len()..], time)?;
        let table = Self::append(path, columns.len())?;
        if keep < text.len() {
            table.file.set_len(keep as u64).map_err(IoError::write(&table.path))?;
        }
        Ok(table)
    }

    /// Appends one row: the time in seconds and one value per column.
    ///
    /// # Errors
    ///
    /// [`IoError::RowLength`], [`IoError::Write`].
    pub fn row(&mut self, time: f64, values: &[f64]) -> Result<(), IoError> {
        if values.len() != self.values {
            return Err(IoError::RowLength {
                path: self.path.clone(),
                found: values.len(),
                expected: self.values,
            });
        }
        self.line.clear();
        push_number(&mut self.line, time);
        for &value in values {
            self.line.push(',');
            if !value.is_nan() {
                push_number(&mut self.line, value);
            }
        }
        self.line.push('\n');
        self.file.write_all(self.line.as_bytes()).map_err(IoError::write(&self.path))
    }

    /// Where the table lies.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    fn append(path: PathBuf, values: usize) -> Result<Self, IoError> {
        let file = OpenOptions::new().append(true).open(&path).map_err(IoError::write(&path))?;
        Ok(Self { path, file, values, line: String::new() })
    }
}

/// A table read back.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Names without units; the first is `time`.
    pub names: Vec<String>,
    /// Units, empty where there is none.
    pub units: Vec<String>,
    /// The rows, the time first.
    pub rows: Vec<Vec<f64>>,
}

impl Table {
    /// The values of the column `name`, one per row; `None` when no column carries the name.
    #[must_use]
    pub fn column(&self, name: &str) -> Option<Vec<f64>> {
        let i = self.names.iter().position(|n| n == name)?;
        Some(self.rows.iter().map(|row| row[i]).collect())
    }
}

/// Reads a table that [`TableWriter`] wrote. A last row without line end is left out; empty cells
/// become NaN.
///
/// # Errors
///
/// [`IoError::Read`], or [`IoError::Text`] with the line.
pub fn read_table(path: impl AsRef<Path>) -> Result<Table, IoError> {
    let path = path.as_ref();
    let text = fs::read_to_string(path).map_err(IoError::read(path))?;
    let mut lines = whole_lines(&text);
    let head = lines.next().ok_or_else(|| text_error(path, 1, "the table has no head".into()))?;
    let (names, units): (Vec<String>, Vec<String>) = head
        .split(',')
        .map(|title| match title.strip_suffix(']').and_then(|t| t.split_once(" [")) {
            Some((name, unit)) => (name.to_owned(), unit.to_owned()),
            None => (title.to_owned(), String::new()),
        })
        .unzip();
    let value_of = |cell: &str| if cell.is_empty() { Ok(f64::NAN) } else { cell.parse() };
    let rows = lines
        .zip(2..)
        .map(|(line, number)| {
            let row: Result<Vec<f64>, _> = line.split(',').map(value_of).collect();
            match row {
                Ok(row) if row.len() == names.len() => Ok(row),
                Ok(row) => Err(text_error(
                    path,
                    number,
                    format!("{} values under {} titles", row.len(), names.len()),
                )),
                Err(_) => Err(text_error(path, number, format!("not a row of numbers: {line}"))),
            }
        })
        .collect::<Result<_, _>>()?;
    Ok(Table { names, units, rows })
}

fn head(columns: &[(&str, &str)]) -> Result<String, IoError> {
    let mut head = String::from("time [s]");
    for (name, unit) in columns {
        for text in [name, unit] {
            if text.contains([',', '"', '[', ']', '\n', '\r']) {
                return Err(IoError::Name {
                    name: (*text).to_owned(),
                    problem: "a table title holds no comma, quote, bracket or line break",
                });
            }
        }
        if name.is_empty() {
            return Err(IoError::Name { name: String::new(), problem: "it is empty" });
        }
        head.push(',');
        head.push_str(name);
        if !unit.is_empty() {
            let _ = write!(head, " [{unit}]");
        }
    }
    head.push('\n');
    Ok(head)
}

/// Bytes of `body` up to the first row that is cut or later than `time`.
fn kept(path: &Path, body: &str, time: f64) -> Result<usize, IoError> {
    let mut bytes = 0;
    for (line, number) in whole_lines(body).zip(2..) {
        let first = line.split(',').next().unwrap_or_default();
        let row_time: f64 = first.parse().map_err(|_| {
            text_error(path, number, format!("the row starts with \"{first}\", not with a time"))
        })?;
        if row_time > time {
            break;
        }
        bytes += line.len() + 1;
    }
    Ok(bytes)
}

/// The lines that end with a line end, without it.
fn whole_lines(text: &str) -> impl Iterator<Item = &str> {
    text.split_inclusive('\n').filter_map(|line| line.strip_suffix('\n'))
}

/// The shortest text that reads back as the same number, with an exponent where plain digits
/// would be long.
fn push_number(text: &mut String, x: f64) {
    let size = x.abs();
    // Writing to a String cannot fail.
    let _ = if size == 0.0 || (1e-5..1e16).contains(&size) || !size.is_finite() {
        write!(text, "{x}")
    } else {
        write!(text, "{x:e}")
    };
}

fn text_error(path: &Path, line: usize, problem: String) -> IoError {
    IoError::Text { path: path.to_path_buf(), line, problem }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const COLUMNS: [(&str, &str); 2] = [("p", "Pa"), ("count", "")];

    #[test]
    fn resuming_drops_a_cut_row_and_later_rows() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.csv");
        let mut table = TableWriter::create(&path, &COLUMNS).unwrap();
        for i in 0..10 {
            table.row(f64::from(i) * 0.1, &[f64::from(i), 1e-300]).unwrap();
        }
        assert!(matches!(table.row(1.0, &[1.0]), Err(IoError::RowLength { .. })));
        drop(table);
        let whole = fs::read_to_string(&path).unwrap();
        for cut in 0..40 {
            fs::write(&path, &whole[..whole.len() - cut]).unwrap();
            let mut table = TableWriter::resume(&path, &COLUMNS, 0.45).unwrap();
            table.row(0.5, &[-0.0, f64::INFINITY]).unwrap();
            let read = read_table(&path).unwrap();
            assert_eq!(read.names, ["time", "p", "count"]);
            assert_eq!(read.units, ["s", "Pa", ""]);
            assert_eq!(read.column("p").unwrap(), [0.0, 1.0, 2.0, 3.0, 4.0, -0.0]);
            assert_eq!(read.rows[5][2], f64::INFINITY);
        }
    }

    #[test]
    fn what_there_is_not_leaves_its_cell_empty() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.csv");
        let mut table = TableWriter::create(&path, &COLUMNS).unwrap();
        table.row(0.5, &[f64::NAN, 0.0]).unwrap();
        table.row(1.0, &[2.0, f64::NAN]).unwrap();
        assert!(fs::read_to_string(&path).unwrap().ends_with("\n0.5,,0\n1,2,\n"));
        let read = read_table(&path).unwrap();
        assert!(read.rows[0][1].is_nan() && read.rows[1][2].is_nan());
        assert_eq!((read.rows[0][2], read.rows[1][1]), (0.0, 2.0));
    }

    #[test]
    fn another_head_is_refused_and_a_missing_table_started() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.csv");
        TableWriter::resume(&path, &COLUMNS, 1.0).unwrap();
        let error = TableWriter::resume(&path, &COLUMNS[..1], 1.0).unwrap_err();
        assert!(error.to_string().contains("move the table away"), "{error}");
        assert!(TableWriter::create(&path, &[("a,b", "m")]).is_err());
        fs::write(&path, "time [s],p [Pa],count\n0,1\n").unwrap();
        assert!(matches!(read_table(&path), Err(IoError::Text { line: 2, .. })));
    }

    proptest! {
        #[test]
        fn numbers_read_back_as_the_same_bits(bits: u64) {
            let x = f64::from_bits(bits);
            let mut text = String::new();
            push_number(&mut text, x);
            let back: f64 = text.parse().unwrap();
            prop_assert!(text.len() < 30);
            prop_assert!(back.to_bits() == bits || (x.is_nan() && back.is_nan()));
        }
    }
}
