//! Other people's readers (VTK, h5py) open our files and find every number.

use std::io::Write;
use std::path::Path;
use std::process::Command;
use std::{fs, io};

use sph_io::{Checkpoint, ParticleFrame, SnapshotSeries, write_checkpoint};

/// True when Python has the libraries; says so when it has not.
fn readers_present() -> bool {
    let found = Command::new("python3").args(["-c", "import vtk, h5py"]).output();
    let present = found.is_ok_and(|output| output.status.success());
    if !present {
        // Past the test runner's capture, so that a skip is seen.
        let _ = writeln!(
            io::stderr(),
            "SKIPPED: VTK and h5py did not read our files, as \
             `python3 -c \"import vtk, h5py\"` fails (pip install vtk h5py)"
        );
    }
    present
}

/// A name that XML can only carry escaped.
const PRESSURE: &str = " pressure <p & \"q\"> 'µ' ]]> ";

fn expect<T: bytemuck::Pod>(folder: &Path, name: &str, kind: &str, components: usize, data: &[T]) {
    let path = folder.join("expected").join(format!("{name}.{kind}.{components}"));
    fs::write(path, bytemuck::cast_slice(data)).unwrap();
}

fn check<const D: usize>(n: u64) {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::create_dir(folder.join("expected")).unwrap();
    let ids: Vec<u64> = (0..n).map(|i| i.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 4).collect();
    let positions: Vec<[f64; D]> = ids
        .iter()
        .map(|&i| std::array::from_fn(|k| (i as f64 * 1e-18).powi(k as i32 + 1) - 0.5))
        .collect();
    let velocity: Vec<[f32; D]> = positions.iter().map(|x| x.map(|x| -0.0 * x as f32)).collect();
    let pressure: Vec<f32> = ids.iter().map(|&i| i as f32 * 1e-12).collect();
    let density: Vec<f64> = ids.iter().map(|&i| f64::from_bits(i)).collect();
    let kind: Vec<u8> = ids.iter().map(|&i| (i % 3) as u8).collect();
    let body: Vec<u16> = ids.iter().map(|&i| (i % 60_000) as u16).collect();
    let colour: Vec<u32> = ids.iter().map(|&i| i as u32).collect();
    let stress: Vec<[f64; 6]> = ids.iter().map(|&i| [i as f64; 6]).collect();
    let limit: Vec<f32> = [f32::NAN, f32::INFINITY, -f32::INFINITY, 1.0, f32::MIN_POSITIVE]
        .into_iter()
        .cycle()
        .take(ids.len())
        .collect();
    let signed: Vec<i64> = ids.iter().map(|&i| !(i as i64)).collect();
    expect(folder, "Points", "float64", D, &positions);
    expect(folder, "velocity", "float32", D, &velocity);
    expect(folder, PRESSURE, "float32", 1, &pressure);
    expect(folder, "density", "float64", 1, &density);
    expect(folder, "kind", "uint8", 1, &kind);
    expect(folder, "body", "uint16", 1, &body);
    expect(folder, "colour", "uint32", 1, &colour);
    expect(folder, "stress", "float64", 6, &stress);
    expect(folder, "limit", "float32", 1, &limit);
    expect(folder, "signed", "int64", 1, &signed);
    expect(folder, "id", "uint64", 1, &ids);

    let frame = |time| {
        ParticleFrame::new(time, &positions)
            .with("velocity", &velocity)
            .with(PRESSURE, &pressure)
            .with("density", &density)
            .with("kind", &kind)
            .with("body", &body)
            .with("colour", &colour)
            .with("stress", &stress)
            .with("limit", &limit)
            .with("signed", &signed)
            .with("id", &ids)
    };
    let backwards: Vec<u32> = (0..n as u32).rev().collect();
    let walls = [[0.0; D], [1.0; D], [2.0; D]];
    let mut series = SnapshotSeries::create(folder, "series").unwrap();
    series.fixed_part("walls", &ParticleFrame::new(0.0, &walls)).unwrap();
    series.write(&frame(0.0)).unwrap();
    series.write(&frame(0.25).select(&backwards)).unwrap();

    let state = Checkpoint::new(0.5, 120, &ids[..], &positions[..])
        .with("velocity", &velocity)
        .with(PRESSURE, &pressure)
        .with("density", &density)
        .with("kind", &kind)
        .with("body", &body)
        .with("colour", &colour)
        .with("stress", &stress)
        .with("limit", &limit)
        .with("signed", &signed)
        .with_attribute("dt", 1e-4)
        .with_attribute("scene", "# Fluß\ndimension = 3\n")
        .with_attribute("body", [0.5, -1.5]);
    write_checkpoint(folder.join("state.vtkhdf"), &state).unwrap();

    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/python/check_readers.py");
    let output = Command::new("python3").arg(script).arg(folder).output().unwrap();
    assert!(
        output.status.success(),
        "{n} particles in {D} dimensions\n{}{}",
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
}

#[test]
fn vtk_and_h5py_find_every_number() {
    if readers_present() {
        check::<2>(1000);
        // Every array just fills blocks of the packing.
        check::<2>(32_768);
        // More than one piece of a selection and more than one compressed chunk.
        check::<3>(70_000);
    }
}

#[test]
fn vtk_and_h5py_open_one_particle_and_none() {
    if readers_present() {
        check::<2>(1);
        check::<3>(1);
        check::<2>(0);
        check::<3>(0);
    }
}
