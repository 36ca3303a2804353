//! VTK: surfaces of polygon data (`.vtp`, legacy) and of unstructured grids (`.vtu`, legacy), through
//! vtkio.

use super::soup::Soup;
use super::vtk_claims;
use std::panic::{AssertUnwindSafe, catch_unwind};
use vtkio::Vtk;
use vtkio::model::{CellType, DataSet, IOBuffer, Piece, VertexNumbers};

/// Adds the polygons and strips of a file.
pub fn read(bytes: &[u8], xml: bool, soup: &mut Soup) -> Result<(), String> {
    if xml {
        vtk_claims::check(bytes).map_err(|error| format!("it is a broken VTK file: {error}"))?;
    }
    // The parser was made for files of friends: on some broken ones it panics.
    let parsed = catch_unwind(AssertUnwindSafe(|| {
        if xml { Vtk::parse_xml(bytes) } else { Vtk::parse_legacy_be(bytes) }
    }));
    let file = match parsed {
        Ok(Ok(file)) => file,
        Ok(Err(error)) => return Err(format!("it is a broken VTK file: {error}")),
        Err(_) => return Err("it is a broken VTK file".into()),
    };
    match file.data {
        DataSet::PolyData { pieces, .. } => {
            for piece in pieces {
                let piece = loaded(piece)?;
                let vertices = vertices(&piece.points, soup)?;
                for corners in piece.polys.map_or(Ok(Vec::new()), lists)? {
                    cell(&corners, CellType::Polygon, &vertices, soup)?;
                }
                for corners in piece.strips.map_or(Ok(Vec::new()), lists)? {
                    cell(&corners, CellType::TriangleStrip, &vertices, soup)?;
                }
            }
            Ok(())
        }
        DataSet::UnstructuredGrid { pieces, .. } => {
            for piece in pieces {
                let piece = loaded(piece)?;
                let vertices = vertices(&piece.points, soup)?;
                let lists = lists(piece.cells.cell_verts)?;
                if lists.len() != piece.cells.types.len() {
                    return Err("it has not as many types of cells as cells".into());
                }
                for (corners, kind) in lists.iter().zip(piece.cells.types) {
                    cell(corners, kind, &vertices, soup)?;
                }
            }
            Ok(())
        }
        _ => Err("it is a VTK file without polygons: extract the surface in ParaView".into()),
    }
}

fn loaded<P>(piece: Piece<P>) -> Result<P, String> {
    match piece {
        Piece::Inline(piece) => Ok(*piece),
        _ => Err("it only names other VTK files: give one of those".into()),
    }
}

/// Vertices of the points, three numbers each.
fn vertices(points: &IOBuffer, soup: &mut Soup) -> Result<Vec<u32>, String> {
    if let IOBuffer::F32(numbers) = points {
        if let Some(bad) = numbers.iter().position(|x| !x.is_finite()) {
            return Err(format!("point {} is not finite", bad / 3));
        }
        return Ok(numbers.chunks_exact(3).map(|x| soup.vertex_f32([x[0], x[1], x[2]])).collect());
    }
    let numbers: Vec<f64> = points.cast_into().ok_or("its points are no numbers")?;
    if let Some(bad) = numbers.iter().position(|x| !x.is_finite()) {
        return Err(format!("point {} is not finite", bad / 3));
    }
    Ok(numbers.chunks_exact(3).map(|x| soup.vertex([x[0], x[1], x[2]])).collect())
}

/// The points of each cell.
fn lists(cells: VertexNumbers) -> Result<Vec<Vec<usize>>, String> {
    let cut = "a cell has more points than there are in the file";
    let mut lists = Vec::new();
    match cells {
        VertexNumbers::Legacy { vertices, .. } => {
            let mut rest = &vertices[..];
            while let Some((&count, after)) = rest.split_first() {
                let (own, after) = after.split_at_checked(count as usize).ok_or(cut)?;
                lists.push(own.iter().map(|&point| point as usize).collect());
                rest = after;
            }
        }
        VertexNumbers::XML { connectivity, offsets } => {
            let mut start = 0;
            for (index, end) in offsets.into_iter().enumerate() {
                // Some writers begin with the start of the first cell.
                if index == 0 && end == 0 {
                    continue;
                }
                let end = usize::try_from(end).map_err(|_| cut)?;
                let own = connectivity.get(start..end).ok_or(cut)?;
                lists.push(own.iter().map(|&point| point as usize).collect());
                start = end;
            }
        }
    }
    Ok(lists)
}

fn cell(points: &[usize], kind: CellType, vertices: &[u32], soup: &mut Soup) -> Result<(), String> {
    let corners = points
        .iter()
        .map(|&point| {
            vertices.get(point).copied().ok_or_else(|| {
                format!("a cell names point {point}, but there are {}", vertices.len())
            })
        })
        .collect::<Result<Vec<u32>, _>>()?;
    match kind {
        CellType::Triangle | CellType::Quad | CellType::Polygon => soup.polygon(&corners),
        CellType::Pixel => {
            if let [a, b, c, d] = corners[..] {
                soup.polygon(&[a, b, d, c]);
            }
        }
        CellType::TriangleStrip => {
            for (index, three) in corners.windows(3).enumerate() {
                let turned = index % 2 == 1;
                soup.triangle(if turned {
                    [three[1], three[0], three[2]]
                } else {
                    [three[0], three[1], three[2]]
                });
            }
        }
        CellType::Vertex | CellType::PolyVertex | CellType::Line | CellType::PolyLine => {}
        _ => {
            return Err(
                "it has cells with a volume or curved ones: extract the surface in ParaView".into(),
            );
        }
    }
    Ok(())
}
