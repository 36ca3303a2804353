//! One `.vtu` file: an unstructured grid whose cells are the particles, one vertex each.
//!
//! The arrays follow the XML head as one raw appended block (VTK XML formats, "appended data",
//! header type `UInt64`). The caller's arrays go to the file as they lie in memory: no text
//! encoding, no copy of the state.

use std::fmt::Write as _;
use std::io::{self, Write};
use std::path::Path;

use crate::atomic::write_atomically;
use crate::frame::Rows;
use crate::{IoError, ParticleFrame, Scalar};

/// VTK's number for a cell that is a single point.
pub(crate) const VTK_VERTEX: u8 = 1;

/// Writes the particles of one moment as a `.vtu` file, whole or not at all.
///
/// Two-dimensional positions and vectors are written with z = 0. The time is stored as the field
/// `TimeValue`. Any VTK reader since 5.x opens the file.
///
/// # Errors
///
/// [`IoError`] when a column does not fit the particles or the file cannot be written.
pub fn write_vtu<const D: usize>(
    path: impl AsRef<Path>,
    frame: &ParticleFrame<'_, D>,
) -> Result<(), IoError> {
    frame.check()?;
    write_atomically(path, |file| encode(file, frame))
}

/// An array of the head: where its numbers come from.
enum Source<'a> {
    Rows(Rows<'a>),
    /// `first, first + 1, …`: connectivity and offsets of vertices.
    Counting {
        first: u64,
    },
    /// The cell type, repeated.
    CellTypes,
}

impl Source<'_> {
    fn shape(&self, wide: bool) -> (Scalar, usize) {
        match self {
            Self::Rows(rows) => (rows.scalar, rows.components),
            Self::Counting { .. } if wide => (Scalar::I64, 1),
            Self::Counting { .. } => (Scalar::U32, 1),
            Self::CellTypes => (Scalar::U8, 1),
        }
    }
}

fn encode<const D: usize>(out: &mut impl Write, frame: &ParticleFrame<'_, D>) -> io::Result<()> {
    let n = frame.len();
    // VTK reads counting arrays of 32 bits; half the size as long as they suffice.
    let wide = i32::try_from(n).is_err();
    let mut head = Head { text: String::new(), offset: 0, rows: n, wide };
    let positions =
        Source::Rows(Rows::from_bytes(Scalar::F64, D, bytemuck::cast_slice(frame.positions)));
    let columns: Vec<(&str, Source<'_>)> = frame
        .columns
        .iter()
        .map(|(name, c)| (name.as_str(), Source::Rows(Rows::new(c.values(), c.components()))))
        .collect();
    let cells = [
        ("connectivity", Source::Counting { first: 0 }),
        ("offsets", Source::Counting { first: 1 }),
        ("types", Source::CellTypes),
    ];

    head.open(frame.time);
    head.text.push_str("<Points>\n");
    head.array("Points", &positions);
    head.text.push_str("</Points>\n<PointData>\n");
    for (name, source) in &columns {
        head.array(name, source);
    }
    head.text.push_str("</PointData>\n<Cells>\n");
    for (name, source) in &cells {
        head.array(name, source);
    }
    head.close();
    out.write_all(head.text.as_bytes())?;

    let sources = [&positions].into_iter().chain(columns.iter().chain(&cells).map(|(_, s)| s));
    for source in sources {
        write_array(out, source, frame.selection, n, wide)?;
    }
    out.write_all(b"\n</AppendedData>\n</VTKFile>\n")
}

/// The XML text before the numbers, with the place of each array among them.
struct Head {
    text: String,
    offset: u64,
    rows: usize,
    wide: bool,
}

impl Head {
    fn open(&mut self, time: f64) {
        let order = if cfg!(target_endian = "little") { "LittleEndian" } else { "BigEndian" };
        let n = self.rows;
        // Writing to a String cannot fail.
        let _ = write!(
            self.text,
            "<?xml version=\"1.0\"?>\n\
             <VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"{order}\" \
             header_type=\"UInt64\">\n<UnstructuredGrid>\n<FieldData>\n\
             <DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" \
             format=\"ascii\">{time:e}</DataArray>\n</FieldData>\n\
             <Piece NumberOfPoints=\"{n}\" NumberOfCells=\"{n}\">\n"
        );
    }

    fn array(&mut self, name: &str, source: &Source<'_>) {
        let (scalar, components) = source.shape(self.wide);
        // Connectivity is read as a signed number.
        let vtk_type = match source {
            Source::Counting { .. } if !self.wide => "Int32",
            _ => scalar.vtk_name(),
        };
        let _ = writeln!(
            self.text,
            "<DataArray type=\"{vtk_type}\" Name=\"{}\" NumberOfComponents=\"{components}\" \
             format=\"appended\" offset=\"{}\"/>",
            escape(name),
            self.offset
        );
        self.offset += 8 + (self.rows * components * scalar.size()) as u64;
    }

    fn close(&mut self) {
        self.text.push_str(
            "</Cells>\n</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_",
        );
    }
}

fn write_array(
    out: &mut impl Write,
    source: &Source<'_>,
    selection: Option<&[u32]>,
    n: usize,
    wide: bool,
) -> io::Result<()> {
    let (scalar, components) = source.shape(wide);
    let bytes = (n * components * scalar.size()) as u64;
    out.write_all(&bytes.to_ne_bytes())?;
    match source {
        Source::Rows(rows) => rows.for_each_piece(selection, |piece| out.write_all(piece)),
        Source::CellTypes => {
            io::copy(&mut io::Read::take(io::repeat(VTK_VERTEX), bytes), out).map(|_| ())
        }
        Source::Counting { first } => {
            let last = first + n as u64;
            if wide {
                (*first..last).try_for_each(|i| out.write_all(&i.to_ne_bytes()))
            } else {
                // `n` fits an i32, so these values do too.
                (*first..last).try_for_each(|i| out.write_all(&(i as u32).to_ne_bytes()))
            }
        }
    }
}

/// Text as the value of an XML attribute.
pub(crate) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            c => out.push(c),
        }
    }
    out
}
