//! Files as programs write them, spoilt files, and bytes of no meaning.

use super::*;
use proptest::prelude::*;
use std::fmt::Write as _;

fn unit() -> TriangleMesh {
    TriangleMesh::cuboid([0.0; 3], [1.0; 3])
}

fn ascii(mesh: &TriangleMesh) -> String {
    let mut text = String::from("solid part facet of it\n");
    for triangle in 0..mesh.triangles.len() {
        text.push_str(" facet normal 0 -0.5e0 nan\n  outer loop\n");
        for [x, y, z] in mesh.corners(triangle) {
            writeln!(text, "   vertex {x:e} {y} {z}").unwrap();
        }
        text.push_str("  endloop\n endfacet\n");
    }
    text.push_str("endsolid part\n");
    text
}

fn obj(mesh: &TriangleMesh) -> String {
    let mut text = String::from("# made by hand\nmtllib a.mtl\no thing\n");
    for [x, y, z] in &mesh.vertices {
        writeln!(text, "v {x} {y:e} {z} 1.0").unwrap();
    }
    text.push_str("vn 0 0 1\nusemtl red\ns off\n");
    for [a, b, c] in &mesh.triangles {
        writeln!(text, "f {}/7/1 {}//1 {}", a + 1, b + 1, c + 1).unwrap();
    }
    text
}

fn ply(mesh: &TriangleMesh, format: &str) -> Vec<u8> {
    let (vertices, faces) = (mesh.vertices.len(), mesh.triangles.len());
    let mut bytes = format!(
        "ply\nformat {format} 1.0\ncomment made by hand\nelement vertex {vertices}\n\
         property double x\nproperty double y\nproperty double z\nproperty uchar red\n\
         element face {faces}\nproperty list uchar int vertex_indices\nproperty short flags\n\
         end_header\n"
    )
    .into_bytes();
    if format == "ascii" {
        for [x, y, z] in &mesh.vertices {
            bytes.extend(format!("{x} {y:e} {z} 255\n").bytes());
        }
        for [a, b, c] in &mesh.triangles {
            bytes.extend(format!("3 {a} {b} {c} -1\n").bytes());
        }
        return bytes;
    }
    let little = format == "binary_little_endian";
    let mut put = |little_end: &[u8]| {
        if little {
            bytes.extend(little_end);
        } else {
            bytes.extend(little_end.iter().rev());
        }
    };
    for x in &mesh.vertices {
        x.iter().for_each(|x| put(&x.to_le_bytes()));
        put(&[255]);
    }
    for corners in &mesh.triangles {
        put(&[3]);
        corners.iter().for_each(|corner| put(&corner.to_le_bytes()));
        put(&(-1_i16).to_le_bytes());
    }
    bytes
}

const PLY_FORMATS: [&str; 3] = ["ascii", "binary_little_endian", "binary_big_endian"];

/// Polygon data in the old text format.
fn vtk_legacy(mesh: &TriangleMesh) -> String {
    let (points, cells) = (mesh.vertices.len(), mesh.triangles.len());
    let mut text = format!(
        "# vtk DataFile Version 3.0\nmade by hand\nASCII\nDATASET POLYDATA\nPOINTS {points} double\n"
    );
    mesh.vertices.iter().for_each(|[x, y, z]| writeln!(text, "{x} {y:e} {z}").unwrap());
    writeln!(text, "POLYGONS {cells} {}", 4 * cells).unwrap();
    mesh.triangles.iter().for_each(|[a, b, c]| writeln!(text, "3 {a} {b} {c}").unwrap());
    text
}

/// Polygon data or an unstructured grid in XML, as text.
fn vtk_xml(mesh: &TriangleMesh, grid: bool) -> String {
    let (points, cells) = (mesh.vertices.len(), mesh.triangles.len());
    let join = |numbers: Vec<String>| numbers.join(" ");
    let coordinates = join(mesh.vertices.iter().flatten().map(f64::to_string).collect());
    let corners = join(mesh.triangles.iter().flatten().map(u32::to_string).collect());
    let ends = join((1..=cells).map(|k| (3 * k).to_string()).collect());
    let array = |kind: &str, name: &str, numbers: &str| {
        format!("<DataArray type=\"{kind}\" Name=\"{name}\" format=\"ascii\">{numbers}</DataArray>")
    };
    let lists = array("Int64", "connectivity", &corners) + &array("Int64", "offsets", &ends);
    let (set, count, lists) = if grid {
        let types = array("UInt8", "types", &join(vec!["5".into(); cells]));
        ("UnstructuredGrid", "NumberOfCells", format!("<Cells>{lists}{types}</Cells>"))
    } else {
        ("PolyData", "NumberOfPolys", format!("<Polys>{lists}</Polys>"))
    };
    let others =
        if grid { "" } else { "NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\"" };
    format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"{set}\" version=\"1.0\" byte_order=\"LittleEndian\" \
         header_type=\"UInt64\">\n<{set}><Piece NumberOfPoints=\"{points}\" {count}=\"{cells}\" {others}>\
         <Points><DataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\" \
         format=\"ascii\">{coordinates}</DataArray></Points>{lists}</Piece></{set}>\n</VTKFile>\n"
    )
}

/// Polygon data in binary, in the old format or in compressed XML.
fn vtk_binary(mesh: &TriangleMesh, xml: bool) -> Vec<u8> {
    use vtkio::model::{ByteOrder, DataSet, PolyDataPiece, Version, VertexNumbers, Vtk};
    let cells = mesh.triangles.len() as u32;
    let vertices = mesh.triangles.iter().flat_map(|&[a, b, c]| [3, a, b, c]).collect();
    let piece = PolyDataPiece {
        points: mesh.vertices.iter().flatten().copied().collect::<Vec<f64>>().into(),
        polys: Some(VertexNumbers::Legacy { num_cells: cells, vertices }),
        ..PolyDataPiece::default()
    };
    let file = Vtk {
        version: Version::new_xml(1, 0),
        title: "made by a program".into(),
        byte_order: if xml { ByteOrder::LittleEndian } else { ByteOrder::BigEndian },
        file_path: None,
        data: DataSet::inline(piece),
    };
    let mut bytes = Vec::new();
    if xml {
        let xml = file.try_into_xml_format(vtkio::xml::Compressor::ZLib, 5).unwrap();
        xml.write(&mut bytes).unwrap();
    } else {
        file.write_legacy(&mut bytes).unwrap();
    }
    bytes
}

/// The same mesh in all formats.
fn files(mesh: &TriangleMesh) -> Vec<(MeshFormat, Vec<u8>)> {
    let [a, l, b] = PLY_FORMATS.map(|format| ply(mesh, format));
    vec![
        (MeshFormat::StlBinary, mesh.to_stl().unwrap()),
        (MeshFormat::StlAscii, ascii(mesh).into_bytes()),
        (MeshFormat::Obj, obj(mesh).into_bytes()),
        (MeshFormat::PlyAscii, a),
        (MeshFormat::PlyBinary, l),
        (MeshFormat::PlyBinary, b),
        (MeshFormat::VtkLegacy, vtk_legacy(mesh).into_bytes()),
        (MeshFormat::VtkLegacy, vtk_binary(mesh, false)),
        (MeshFormat::VtkXml, vtk_xml(mesh, false).into_bytes()),
        (MeshFormat::VtkXml, vtk_xml(mesh, true).into_bytes()),
        (MeshFormat::VtkXml, vtk_binary(mesh, true)),
    ]
}

/// The corners of all triangles, whatever the order of the vertices.
fn corners(mesh: &TriangleMesh) -> Vec<[[f64; 3]; 3]> {
    (0..mesh.triangles.len()).map(|triangle| mesh.corners(triangle)).collect()
}

fn reason(bytes: &[u8]) -> String {
    match TriangleMesh::from_bytes(bytes) {
        Err(MeshError::Format { reason, .. }) => reason,
        other => panic!("{other:?}"),
    }
}

#[track_caller]
fn assert_box(bytes: &[u8]) -> MeshFile {
    let file = MeshFile::from_bytes(bytes).unwrap();
    assert_eq!(corners(&file.mesh), corners(&unit()));
    assert_eq!(file.mesh.vertices.len(), 8);
    file
}

proptest! {
    #[test]
    fn every_format_holds_the_same_numbers(
        min in prop::array::uniform3(-9999..9999i32),
        size in prop::array::uniform3(1..9999i32),
    ) {
        // Up to six digits: what people type, and what 32 bits hold.
        let place = |i: i32| f64::from(i) / 1000.0;
        let max = [0, 1, 2].map(|k| place(min[k] + size[k]));
        let mesh = TriangleMesh::cuboid(min.map(place), max);
        for (format, bytes) in files(&mesh) {
            let file = MeshFile::from_bytes(&bytes).unwrap();
            prop_assert_eq!(file.format, format);
            prop_assert_eq!(corners(&file.mesh), corners(&mesh));
            prop_assert_eq!((file.collapsed, file.surplus), (0, 0));
        }
    }

    #[test]
    fn text_is_read_in_double_precision(shift in prop::array::uniform3(-1e6..1e6)) {
        let mesh = TriangleMesh::cuboid(shift, shift.map(|x| x + 1.0));
        for (format, bytes) in files(&mesh) {
            let file = MeshFile::from_bytes(&bytes).unwrap();
            let largest = mesh.vertices.iter().flatten().fold(0.0, |m: f64, x| m.max(x.abs()));
            if format == MeshFormat::StlBinary {
                prop_assert!((file.resolution / largest / 1.2e-7 - 1.0).abs() < 0.01);
            } else {
                prop_assert_eq!(corners(&file.mesh), corners(&mesh));
                prop_assert!(file.resolution < 1e-15 * largest + 1e-300);
            }
        }
    }

    #[test]
    fn any_bytes_are_an_error_and_not_a_panic(
        mut bytes in prop::collection::vec(any::<u8>(), 0..300),
        start in prop::sample::select(vec![
            "", "solid ", "facet normal\n", "v 1 2 3\nf ", "\u{feff}solid x\n", "ply\nformat ascii 1.0\n",
            "ply\nformat binary_big_endian 1.0\nelement vertex 9\nproperty float x\nproperty float y\n\
             property float z\nelement face 4\nproperty list uchar uint vertex_index\nend_header\n",
        ]),
    ) {
        bytes.splice(0..0, start.bytes());
        if let Ok(file) = MeshFile::from_bytes(&bytes) {
            prop_assert!(file.mesh.vertices.iter().all(crate::vector::is_finite));
            let most = file.mesh.vertices.len();
            prop_assert!(file.mesh.triangles.iter().flatten().all(|v| (*v as usize) < most));
        }
    }

    #[test]
    fn files_with_a_hole_or_a_wrong_byte_never_panic(
        which in 0..11usize,
        at in 0.0..1.0,
        length in 0..40usize,
        byte in any::<u8>(),
    ) {
        let (_, mut bytes) = files(&unit()).swap_remove(which);
        let at = (at * bytes.len() as f64) as usize;
        bytes[at] = byte;
        let _ = MeshFile::from_bytes(&bytes).map(|file| crate::mesh::check(&file.mesh));
        bytes.drain(at..(at + length).min(bytes.len()));
        let _ = MeshFile::from_bytes(&bytes).map(|file| crate::mesh::check(&file.mesh));
    }

    /// What is left of a spoilt file is a mesh in order, or refused with a reason: all the way to a shape.
    #[test]
    fn spoilt_files_make_shapes_or_reasons(
        which in 0..11usize,
        changes in prop::collection::vec(
            (0.0..1.0, 0..12usize, prop::sample::select(vec![
                "", "9", "-", " 1e300 ", "nan", " 4000000000 ", "\n", "0 ", "\u{0}\u{0}", "<", "3 0 1 2\n",
            ])),
            1..4,
        ),
    ) {
        let (_, mut bytes) = files(&unit()).swap_remove(which);
        for (at, length, word) in changes {
            let at = (at * bytes.len() as f64) as usize;
            bytes.splice(at..(at + length).min(bytes.len()), word.bytes());
        }
        let shape = MeshFile::from_bytes(&bytes)
            .and_then(|file| crate::mesh::repaired(&file.mesh))
            .and_then(|file| crate::mesh::bodies(&file.mesh));
        match shape {
            Ok(bodies) => {
                let shape = crate::shape::Shape::<3>::bodies(&bodies).unwrap();
                prop_assert!(!shape.signed_distance(&[0.3, 0.4, 0.6]).is_nan());
            }
            Err(error) => prop_assert!(error.to_string().len() > 10, "{}", error),
        }
    }

    /// A mesh with its end missing is refused, or lacks triangles; it is never something else.
    #[test]
    fn truncated_files_have_no_triangles_of_their_own(which in 0..6usize, part in 0.0..1.0) {
        let (_, bytes) = files(&unit()).swap_remove(which);
        let part = (part * bytes.len() as f64) as usize;
        if let Ok(file) = MeshFile::from_bytes(&bytes[..part]) {
            let whole = corners(&unit());
            prop_assert!(corners(&file.mesh).len() <= whole.len());
        }
    }
}

#[test]
fn text_comes_in_many_ways() {
    let text = ascii(&unit());
    let marked = [b"\xef\xbb\xbf".as_slice(), text.as_bytes()].concat();
    let wide = |little: bool| -> Vec<u8> {
        let units = "\u{feff}".encode_utf16().chain(text.encode_utf16());
        units.flat_map(|u| if little { u.to_le_bytes() } else { u.to_be_bytes() }).collect()
    };
    let ways: Vec<Vec<u8>> = vec![
        text.to_uppercase().into(),
        text.replace('\n', "\r\n").into(),
        text.replace('\n', "\r").into(),
        text.replace('\n', "\n\n").replace(' ', "\t").into(),
        text.replace('\n', " ").replacen("of it", "of it\n", 1).into(),
        marked,
        wide(true),
        wide(false),
        format!("# exported by a program\n\n// in metres\n{text}").into(),
        format!("Exported by a program\n{text}").into(),
        format!("{text}\0\0\0").into(),
        format!("{text}\u{1a}").into(),
        text.replace("endfacet", "end facet").into(),
        text.replace("solid part facet of it\n", "").replace("endsolid part\n", "").into(),
        text.replace("e0 ", "D+00 ").into(),
    ];
    for bytes in ways {
        let file = assert_box(&bytes);
        assert_eq!(file.format, MeshFormat::StlAscii);
    }
    assert_box(obj(&unit()).replace('\n', "\r").as_bytes());
    assert_box(obj(&unit()).replace(" 1.0\n", " \\\n 1.0\r\n").as_bytes());
    assert_box(&[b"\xef\xbb\xbf".as_slice(), &ply(&unit(), "ascii")].concat());
}

#[test]
fn binary_comes_in_many_ways() {
    let plain = unit().to_stl().unwrap();
    let mut solid = plain.clone();
    solid[..11].copy_from_slice(b"solid thing");
    assert_eq!(assert_box(&solid).format, MeshFormat::StlBinary);
    solid[11..80].fill(b' ');
    for more in [1, 7, 50, 5000] {
        let longer = [solid.as_slice(), &vec![b'x'; more]].concat();
        let file = assert_box(&longer);
        assert_eq!((file.format, file.surplus), (MeshFormat::StlBinary, more));
    }
    for count in [0, u32::MAX] {
        let mut unknown = plain.clone();
        unknown[80..84].copy_from_slice(&count.to_le_bytes());
        assert_box(&unknown);
    }
}

#[test]
fn several_solids_become_one_mesh() {
    let one = ascii(&unit());
    let two = ascii(&TriangleMesh::cuboid([3.0; 3], [4.0; 3]));
    let mesh = TriangleMesh::from_bytes((one + &two).as_bytes()).unwrap();
    assert_eq!((mesh.vertices.len(), mesh.triangles.len()), (16, 24));
}

#[test]
fn polygons_and_indices_from_the_end() {
    let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf -4 -3 -2 -1\n";
    let mesh = TriangleMesh::from_bytes(text.as_bytes()).unwrap();
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
}

#[test]
fn triangles_that_have_collapsed_are_counted() {
    let text = ascii(&unit()).replacen(
        "endsolid",
        "facet normal 0 0 0 outer loop\nvertex 1 1 1\n\
         vertex 1.0 1 1\nvertex 0 0 0\nendloop endfacet endsolid",
        1,
    );
    let file = MeshFile::from_bytes(text.as_bytes()).unwrap();
    assert_eq!((file.mesh.triangles.len(), file.collapsed), (12, 1));
}

#[test]
fn other_files_are_named() {
    for (start, words) in [
        (b"\x1f\x8b\x08\0\0\0\0\0\0\x03".as_slice(), "gzip archive: unpack"),
        (b"PK\x03\x04\x14\0\0\0", "zip archive"),
        (b"ISO-10303-21;\nHEADER;", "STEP file"),
        (b"<!DOCTYPE html><html>", "web page"),
        (b"version https://git-lfs.github.com/spec/v1\noid", "git lfs pull"),
        (b"OFF\n8 12 0\n", "OFF file"),
        (b"# a text file\n", "no content but comments"),
        (b"hello world\n", "starts with `hello world`"),
        (b"", "empty"),
        (b"\x01\x02\x03", "only 3 bytes"),
    ] {
        let reason = reason(&[start, b""].concat());
        assert!(reason.contains(words), "{reason}");
        assert!(!reason.contains("promises"), "{reason}");
    }
    assert!(reason(&[0xff; 400]).contains("neither text nor a mesh"));
}

#[test]
fn broken_files_say_what_is_wrong() {
    let binary = unit().to_stl().unwrap();
    assert!(reason(&binary[..300]).contains("12 triangles in 684 bytes but has 300"));
    let mut many = binary.clone();
    many[80..84].copy_from_slice(&1_000_000_000_u32.to_le_bytes());
    assert!(reason(&many).contains("1000000000 triangles"));
    let mut infinite = binary;
    infinite[96 + 50..100 + 50].copy_from_slice(&f32::INFINITY.to_le_bytes());
    assert!(reason(&infinite).contains("neither text") || reason(&infinite).contains("not finite"));
    let text = ascii(&unit());
    let cut = text.trim_end().trim_end_matches("endsolid part");
    assert!(reason(cut.as_bytes()).contains("endsolid"));
    for (right, wrong, words) in [
        ("vertex 0", "vertex O", "line 4: `Oe0` is not a number"),
        ("vertex 0e0 0 0", "vertex 0,5 0 0", "point, not a comma"),
        ("vertex 0e0 0 0", "vertex 0 0", "three numbers"),
        ("vertex 0e0 0 0", "vertex nan 0 0", "not finite"),
        ("vertex 0e0 0 0", "vertex 1e999 0 0", "not finite"),
        ("outer loop", "outer ring", "line 3: `ring`"),
        ("   vertex 0e0 0 0\n", "", "2 corners, not 3"),
        ("  endloop\n", "vertex 0 0 0\n", "more than three corners"),
        ("solid part", "solid a\nsolid part", "inside a solid"),
    ] {
        let reason = reason(text.replacen(right, wrong, 1).as_bytes());
        assert!(reason.contains(words), "{words}: {reason}");
    }
    assert!(reason((text + "more").as_bytes()).contains("between solids"));
    let text = obj(&unit());
    for (right, wrong, words) in [
        ("f 1/", "f 9/", "names vertex 9, but there are 8"),
        ("f 1/", "f 0/", "names vertex 0"),
        ("f 1/", "f -99999999999999999/", "names vertex -9"),
        ("f 1/", "f x/", "`x/7/1` is no corner"),
        ("v 0", "v y", "`y` is not a number"),
    ] {
        let reason = reason(text.replacen(right, wrong, 1).as_bytes());
        assert!(reason.contains(words), "{words}: {reason}");
    }
}

#[test]
fn broken_ply_files_say_what_is_wrong() {
    for format in PLY_FORMATS {
        let good = ply(&unit(), format);
        let header = good.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
        let (head, body) = (String::from_utf8_lossy(&good[..header]).into_owned(), &good[header..]);
        for (right, wrong, words) in [
            ("vertex 8", "vertex 1000000000", "promises 1000000000 elements `vertex`"),
            ("vertex 8", "vertex many", "no number of elements"),
            ("double x", "half x", "`half` is no type"),
            ("double x", "double w", "no coordinate x"),
            ("end_header", "end", "no part of a header"),
            ("format", "formatted", "no part of a header"),
            ("element vertex 8\n", "", "property without an element"),
        ] {
            let bytes = [head.replacen(right, wrong, 1).as_bytes(), body].concat();
            let reason = reason(&bytes);
            assert!(reason.contains(words), "{words}: {reason}");
        }
        // One vertex less: everything behind it moves, whatever it means then.
        let fewer = [head.replacen("vertex 8", "vertex 7", 1).as_bytes(), body].concat();
        assert!(MeshFile::from_bytes(&fewer).is_err());
        assert!(reason(&good[..good.len() - 8]).contains("end of the file is missing"));
    }
}

#[test]
fn strips_and_cells_of_vtk_files() {
    let text = "# vtk DataFile Version 3.0\nstrip\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n\
                0 0 0 1 0 0 0 1 0 1 1 0\nTRIANGLE_STRIPS 1 5\n4 0 1 2 3\n";
    let file = MeshFile::from_bytes(text.as_bytes()).unwrap();
    assert_eq!(file.mesh.triangles, [[0, 1, 2], [2, 1, 3]]);
    let cube = "# vtk DataFile Version 3.0\ntetrahedron\nASCII\nDATASET UNSTRUCTURED_GRID\n\
                POINTS 4 float\n0 0 0 1 0 0 0 1 0 0 0 1\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n";
    assert!(reason(cube.as_bytes()).contains("extract the surface"), "{}", reason(cube.as_bytes()));
    let beyond = text.replace("4 0 1 2 3", "4 0 1 2 9");
    assert!(reason(beyond.as_bytes()).contains("names point 9, but there are 4"));
    let other = vtk_xml(&unit(), false).replace("PolyData", "PPolyData");
    assert!(MeshFile::from_bytes(other.as_bytes()).is_err());
}
