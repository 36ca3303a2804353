//! Tables that a scene names: CSV files with remarks.

use std::path::Path;

/// A column over another one, in SI units.
pub type Series = Vec<(f64, f64)>;

/// A row: the line where it stands, and its numbers.
pub type Row = (usize, Vec<f64>);

/// Reads the columns of a CSV file that `pick` chooses by their names. Lines that begin with # are
/// remarks, the first other line names the columns; empty lines, spaces around cells and a byte-order mark
/// do no harm.
///
/// # Errors
///
/// What is wrong, with the line; also what `pick` finds wrong.
pub fn rows(
    path: &Path,
    pick: impl FnOnce(&[&str]) -> Result<Vec<usize>, String>,
) -> Result<Vec<Row>, String> {
    let text = std::fs::read_to_string(path)
        .map_err(|error| format!("cannot read {}: {error}", path.display()))?;
    let text = text.trim_start_matches('\u{feff}');
    let at = |line: usize| at(path, line);
    let mut lines =
        text.lines().zip(1..).filter(|(line, _)| !line.trim().is_empty() && !line.starts_with('#'));
    let (head, line) = lines.next().ok_or_else(|| format!("{}: the table is empty", at(1)))?;
    let names: Vec<&str> = head.split(',').map(str::trim).collect();
    let places = pick(&names).map_err(|problem| format!("{}: {problem}", at(line)))?;
    let row = |(row, line): (&str, usize)| {
        let cells: Vec<&str> = row.split(',').map(str::trim).collect();
        let number = |place: &usize| {
            let cell = cells.get(*place).copied().unwrap_or("");
            let value = cell.parse::<f64>().ok().filter(|value| value.is_finite());
            value.ok_or_else(|| format!("{}: \"{cell}\" is no number", at(line)))
        };
        Ok((line, places.iter().map(number).collect::<Result<_, String>>()?))
    };
    lines.map(row).collect()
}

fn at(path: &Path, line: usize) -> String {
    format!("{}:{line}", path.display())
}

/// Reads two columns of a CSV file, the first two when `columns` is `None`. Rows in the order of time.
///
/// # Errors
///
/// What is wrong, with the line.
pub fn read(path: &Path, columns: Option<[&str; 2]>, units: [f64; 2]) -> Result<Series, String> {
    let pick = |names: &[&str]| {
        let find = |name: &str| {
            names.iter().position(|other| *other == name).ok_or_else(|| {
                format!("no column is called {name}; there are {}", names.join(", "))
            })
        };
        match columns {
            Some([time, value]) => Ok(vec![find(time)?, find(value)?]),
            None if names.len() >= 2 => Ok(vec![0, 1]),
            None => Err("there is one column only".into()),
        }
    };
    let mut series: Series = Vec::new();
    let mut last = 1;
    for (line, numbers) in rows(path, pick)? {
        let (time, value) = (units[0] * numbers[0], units[1] * numbers[1]);
        if series.last().is_some_and(|(before, _)| *before >= time) {
            return Err(format!("{}: times must rise", at(path, line)));
        }
        series.push((time, value));
        last = line;
    }
    if series.len() < 2 {
        return Err(format!("{}: two rows or more are needed", at(path, last)));
    }
    Ok(series)
}

/// The value between two rows, linear in time; `None` before the first and after the last.
pub fn between(series: &[(f64, f64)], time: f64) -> Option<f64> {
    let after = series.partition_point(|(t, _)| *t < time);
    let &(t1, v1) = series.get(after)?;
    if t1 == time {
        return Some(v1);
    }
    let &(t0, v0) = series.get(after.checked_sub(1)?)?;
    Some(v0 + (v1 - v0) * (time - t0) / (t1 - t0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(text: &str, columns: Option<[&str; 2]>) -> Result<Series, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        std::fs::write(&path, text).unwrap();
        read(&path, columns, [2.0, 10.0])
    }

    #[test]
    fn columns_are_found_by_name_and_scaled() {
        let text = "# from a book\nT, X, Y\n0, 1, 5\n\n1, 2, 6\n";
        assert_eq!(table(text, None).unwrap(), [(0.0, 10.0), (2.0, 20.0)]);
        assert_eq!(table(text, Some(["T", "Y"])).unwrap(), [(0.0, 50.0), (2.0, 60.0)]);
    }

    #[test]
    fn mistakes_have_a_line() {
        for (text, columns, words) in [
            ("", None, "the table is empty"),
            ("T,X\n0,1\n1,a\n", None, "a.csv:3: \"a\" is no number"),
            ("T,X\n0,1\n1\n", None, "a.csv:3: \"\" is no number"),
            ("T,X\n0,1\n0,1\n", None, "a.csv:3: times must rise"),
            ("T,X\n0,1\n", None, "two rows"),
            ("# a\nT,X\n0,1\n1,1\n", Some(["T", "Z"]), "a.csv:2: no column is called Z"),
        ] {
            let error = table(text, columns).unwrap_err();
            assert!(error.contains(words), "{text}: {error}");
        }
        assert!(read(Path::new("/nowhere.csv"), None, [1.0; 2]).unwrap_err().contains("nowhere"));
    }

    #[test]
    fn values_lie_between_rows() {
        let series = [(0.0, 1.0), (1.0, 3.0), (3.0, 3.0)];
        assert_eq!(between(&series, 0.5), Some(2.0));
        assert_eq!(between(&series, 3.0), Some(3.0));
        assert_eq!(between(&series, 0.0), Some(1.0));
        assert_eq!((between(&series, -0.1), between(&series, 3.1)), (None, None));
    }
}
