//! The `.pvd` index: which file shows which part at which time.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use crate::IoError;
use crate::atomic::write_text_atomically;

/// One file of the index.
#[derive(Clone, Debug, PartialEq)]
pub struct PvdEntry {
    /// Time in seconds.
    pub time: f64,
    /// Part number: the files of one time differ in it (0 the fluid, 1 the walls, …).
    pub part: u32,
    /// The file, relative to the index, with `/` between folders.
    pub file: String,
}

/// A ParaView collection of files over time, kept whole on the disk after every addition.
///
/// A part that does not change is named again at every time, so that it is drawn at every time
/// while its file is written once.
///
/// # Examples
///
/// ```
/// # fn main() -> Result<(), sph_io::IoError> {
/// # let folder = tempfile::tempdir().unwrap();
/// let path = folder.path().join("tank.pvd");
/// let mut index = sph_io::PvdIndex::create(&path)?;
/// index.add(0.0, &["tank-0000.vtu", "walls.vtu"])?;
/// index.add(0.1, &["tank-0001.vtu", "walls.vtu"])?;
///
/// // The run was killed and starts again from its state at 0.05 s.
/// let index = sph_io::PvdIndex::resume(&path, 0.05)?;
/// assert_eq!(index.entries().len(), 2);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct PvdIndex {
    path: PathBuf,
    entries: Vec<PvdEntry>,
}

impl PvdIndex {
    /// Starts an empty index, in place of one that may be there.
    ///
    /// # Errors
    ///
    /// [`IoError::Write`].
    pub fn create(path: impl Into<PathBuf>) -> Result<Self, IoError> {
        let index = Self { path: path.into(), entries: Vec::new() };
        index.write()?;
        Ok(index)
    }

    /// Reads an index.
    ///
    /// # Errors
    ///
    /// [`IoError::Read`] when there is none, [`IoError::Text`] when it is not in the form that
    /// this crate writes.
    pub fn open(path: impl Into<PathBuf>) -> Result<Self, IoError> {
        let path = path.into();
        let text = fs::read_to_string(&path).map_err(IoError::read(&path))?;
        let entries = parse(&text).map_err(|(line, problem)| IoError::Text {
            path: path.clone(),
            line,
            problem,
        })?;
        Ok(Self { path, entries })
    }

    /// Continues an index from `time`: entries of later times are dropped, from the disk too.
    ///
    /// The files that they name are not deleted. An index that does not exist yet is started.
    ///
    /// # Errors
    ///
    /// [`IoError::Text`] as [`PvdIndex::open`], and [`IoError::Write`].
    pub fn resume(path: impl Into<PathBuf>, time: f64) -> Result<Self, IoError> {
        let path = path.into();
        if !path.exists() {
            return Self::create(path);
        }
        let mut index = Self::open(path)?;
        index.entries.retain(|entry| entry.time <= time);
        index.write()?;
        Ok(index)
    }

    /// Adds the files of one time, part 0 first, and brings the index to the disk.
    ///
    /// A time that is already there is replaced. The files must be whole under these names
    /// before they are added.
    ///
    /// # Errors
    ///
    /// [`IoError::Write`]; [`IoError::Name`] for a file name with a line break.
    pub fn add<S: AsRef<str>>(&mut self, time: f64, files: &[S]) -> Result<(), IoError> {
        for file in files {
            if file.as_ref().is_empty() || file.as_ref().chars().any(char::is_control) {
                return Err(IoError::Name {
                    name: file.as_ref().to_owned(),
                    problem: "a file name in the index is empty or holds a control character",
                });
            }
        }
        self.entries.retain(|entry| entry.time != time);
        self.entries.extend((0..).zip(files).map(|(part, file)| PvdEntry {
            time,
            part,
            file: file.as_ref().to_owned(),
        }));
        self.write()
    }

    /// The entries in the order in which they were added.
    #[must_use]
    pub fn entries(&self) -> &[PvdEntry] {
        &self.entries
    }

    /// Where the index lies.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    fn write(&self) -> Result<(), IoError> {
        let mut text = String::from(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n",
        );
        for PvdEntry { time, part, file } in &self.entries {
            // Writing to a String cannot fail. `{}` is the shortest text that reads back as the
            // same number.
            let _ = writeln!(
                text,
                "<DataSet timestep=\"{time}\" part=\"{part}\" file=\"{}\"/>",
                escape(file)
            );
        }
        text.push_str("</Collection>\n</VTKFile>\n");
        write_text_atomically(&self.path, &text)
    }
}

/// Reads the `DataSet` elements; the error is a line number and what is wrong there.
fn parse(text: &str) -> Result<Vec<PvdEntry>, (usize, String)> {
    let line_of = |rest: &str| 1 + text[..text.len() - rest.len()].matches('\n').count();
    if !text.contains("type=\"Collection\"") || !text.trim_end().ends_with("</VTKFile>") {
        return Err((
            1,
            "this is not a whole .pvd collection; delete it to start a new index".to_owned(),
        ));
    }
    let mut entries = Vec::new();
    let mut rest = text;
    while let Some(start) = rest.find("<DataSet") {
        rest = &rest[start + "<DataSet".len()..];
        let line = line_of(rest);
        let fail = |problem: &str| (line, format!("{problem} in a <DataSet …/> element"));
        let (mut time, mut part, mut file) = (None, 0, None);
        loop {
            rest = rest.trim_start();
            if rest.starts_with("/>") || rest.starts_with('>') {
                break;
            }
            let (key, after) = rest.split_once('=').ok_or_else(|| fail("no closing bracket"))?;
            let after = after.trim_start();
            let quote = after.chars().next().filter(|c| matches!(c, '"' | '\''));
            let quote = quote.ok_or_else(|| fail("a value without quotes"))?;
            let (value, after) =
                after[1..].split_once(quote).ok_or_else(|| fail("a quote that does not end"))?;
            rest = after;
            match key.trim() {
                "timestep" => {
                    time = Some(value.trim().parse().map_err(|_| fail("timestep is no number"))?);
                }
                "part" => {
                    part = value.trim().parse().map_err(|_| fail("part is no whole number"))?;
                }
                "file" => file = Some(unescape(value)),
                _ => {}
            }
        }
        entries.push(PvdEntry {
            time: time.ok_or_else(|| fail("no timestep"))?,
            part,
            file: file.ok_or_else(|| fail("no file"))?,
        });
    }
    Ok(entries)
}

/// Text as the value of an XML attribute.
fn escape(text: &str) -> String {
    // The ampersand first: those of the others stay.
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

fn unescape(value: &str) -> String {
    // The ampersand last: "&amp;lt;" is the text "&lt;".
    value
        .replace("&lt;", "<")
        .replace("&gt;", ">")
        .replace("&quot;", "\"")
        .replace("&apos;", "'")
        .replace("&amp;", "&")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_survive_the_disk_bit_by_bit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.pvd");
        let mut index = PvdIndex::create(&path).unwrap();
        for (i, time) in [0.0, 0.1 + 0.2, 1e-300, 1.0 / 3.0].into_iter().enumerate() {
            index.add(time, &[format!("a & \"b\" <{i}>.vtu"), "walls.vtu".to_owned()]).unwrap();
        }
        let read = PvdIndex::open(&path).unwrap();
        assert_eq!(read.entries(), index.entries());
        assert_eq!(read.entries().len(), 8);
        assert_eq!(read.entries()[1].part, 1);
    }

    #[test]
    fn resuming_drops_later_times_and_a_repeated_time_is_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.pvd");
        let mut index = PvdIndex::resume(&path, 1.0).unwrap();
        for i in 0..5 {
            index.add(f64::from(i), &[format!("{i}.vtu")]).unwrap();
        }
        let mut index = PvdIndex::resume(&path, 2.0).unwrap();
        index.add(2.0, &["again.vtu"]).unwrap();
        let files: Vec<_> =
            PvdIndex::open(&path).unwrap().entries.into_iter().map(|e| e.file).collect();
        assert_eq!(files, ["0.vtu", "1.vtu", "again.vtu"]);
    }

    #[test]
    fn foreign_spellings_are_read_and_broken_ones_refused() {
        let foreign = "<VTKFile type=\"Collection\">\n<Collection>\n\
            <DataSet group='' file='x.vtu' part = '3' timestep=\"1e-3\" ></DataSet>\n\
            </Collection></VTKFile>";
        let entry = PvdEntry { time: 1e-3, part: 3, file: "x.vtu".to_owned() };
        assert_eq!(parse(foreign).unwrap(), [entry]);
        let (line, problem) = parse(&foreign.replace("1e-3", "soon")).unwrap_err();
        assert_eq!(line, 3);
        assert!(problem.contains("timestep"), "{problem}");
        assert!(parse(&foreign.replace("file='x.vtu'", "")).is_err());
        assert!(parse(&foreign[..foreign.len() - 12]).is_err());
        assert!(parse("hello").is_err());
    }
}
