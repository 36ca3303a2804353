//! Checkpoints: what is written comes back bit by bit; what is damaged is refused with a reason.

use std::fs::{self, OpenOptions};
use std::io::{Seek, SeekFrom, Write};

use proptest::collection::vec;
use proptest::prelude::*;
use sph_io::{
    Checkpoint, CheckpointFile, IoError, checkpoint_name, latest_checkpoint, prune_checkpoints,
    read_checkpoint, remove_checkpoints, write_checkpoint,
};

/// Any `f64` bits but NaN: zeros of both signs, denormals, infinities, ordinary numbers.
fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<f64>().prop_filter("no NaN", |x| !x.is_nan()),
        Just(0.0),
        Just(-0.0),
        Just(f64::MIN_POSITIVE / 3.0),
        Just(-f64::from_bits(1)),
        Just(f64::INFINITY),
        Just(f64::MAX),
    ]
}

type Particle<const D: usize> = (u64, [f64; D], f64, [f32; D], u16, u32);

fn particles<const D: usize>() -> impl Strategy<Value = Vec<Particle<D>>> {
    let vector = || vec(any_number(), D).prop_map(|v| <[f64; D]>::try_from(v).unwrap());
    let single = || {
        vec(any::<u32>(), D).prop_map(|bits| {
            let v: Vec<f32> = bits.into_iter().map(f32::from_bits).collect();
            <[f32; D]>::try_from(v).unwrap().map(|x| if x.is_nan() { 0.5 } else { x })
        })
    };
    let particle =
        move || (any::<u64>(), vector(), any_number(), single(), any::<u16>(), any::<u32>());
    prop_oneof![0..2_usize, 0..40_usize].prop_flat_map(move |n| vec(particle(), n))
}

fn bits<const D: usize>(rows: &[[f64; D]]) -> Vec<u64> {
    rows.as_flattened().iter().map(|x| x.to_bits()).collect()
}

fn round_trip<const D: usize>(
    particles: &[Particle<D>],
    time: f64,
    step: u64,
    text: &str,
    numbers: &[f64],
) -> Result<(), TestCaseError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(checkpoint_name(step));
    let ids: Vec<u64> = particles.iter().map(|p| p.0).collect();
    let positions: Vec<[f64; D]> = particles.iter().map(|p| p.1).collect();
    let density: Vec<f64> = particles.iter().map(|p| p.2).collect();
    let velocity: Vec<[f32; D]> = particles.iter().map(|p| p.3).collect();
    let kind: Vec<u16> = particles.iter().map(|p| p.4).collect();
    let group: Vec<u32> = particles.iter().map(|p| p.5).collect();
    let stress: Vec<[f64; 6]> = density.iter().map(|&x| [x, 0.0, -0.0, x, 1.0, 2.0]).collect();
    let state = Checkpoint::new(time, step, &ids[..], &positions[..])
        .with("density", &density)
        .with("velocity", &velocity)
        .with("kind", &kind)
        .with("group", &group)
        .with("stress", &stress)
        .with_attribute("scene", text)
        .with_attribute("dt", time)
        .with_attribute("count", step)
        .with_attribute("body", numbers)
        .with_attribute("counts", &[step, u64::MAX][..]);
    write_checkpoint(&path, &state).unwrap();

    let file = CheckpointFile::open(&path).unwrap();
    prop_assert_eq!(file.info().particles, ids.len() as u64);
    prop_assert_eq!(file.info().dimension, D);
    let back = file.read::<D>().unwrap();
    prop_assert_eq!(back.time.to_bits(), time.to_bits());
    prop_assert_eq!(back.step, step);
    prop_assert_eq!(&back.ids, &ids);
    prop_assert_eq!(bits(&back.positions), bits(&positions));
    prop_assert_eq!(bits(back.column::<[f64; 6]>("stress").unwrap()), bits(&stress));
    let same: Vec<u64> = density.iter().map(|x| x.to_bits()).collect();
    let read: Vec<u64> =
        back.column::<f64>("density").unwrap().iter().map(|x| x.to_bits()).collect();
    prop_assert_eq!(read, same);
    let single = |v: &[[f32; D]]| v.as_flattened().iter().map(|x| x.to_bits()).collect::<Vec<_>>();
    prop_assert_eq!(single(back.column("velocity").unwrap()), single(&velocity));
    prop_assert_eq!(back.column::<u16>("kind").unwrap(), &kind);
    prop_assert_eq!(back.column::<u32>("group").unwrap(), &group);
    prop_assert_eq!(&back.attributes, &state.attributes);

    // Two shares are the whole.
    let middle = ids.len() as u64 / 2;
    let first = file.read_rows::<D>(0..middle).unwrap();
    let second = file.read_rows::<D>(middle..u64::MAX).unwrap();
    let shares = [bits(&first.positions), bits(&second.positions)].concat();
    prop_assert_eq!(shares, bits(&positions));
    prop_assert_eq!([&first.ids[..], &second.ids[..]].concat(), &ids[..]);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    #[test]
    fn the_plane_survives_the_disk(
        particles in particles::<2>(), time in any_number(), step: u64,
        text in "[^\\x00]{0,200}", numbers in vec(any_number(), 0..9),
    ) {
        round_trip(&particles, time, step, &text, &numbers)?;
    }

    #[test]
    fn space_survives_the_disk(
        particles in particles::<3>(), time in any_number(), step: u64,
        text in "[a-z=\\n]{0,200}", numbers in vec(any_number(), 0..9),
    ) {
        round_trip(&particles, time, step, &text, &numbers)?;
    }
}

fn state(n: u64) -> Checkpoint<'static, 3> {
    let ids: Vec<u64> = (0..n).collect();
    let positions: Vec<[f64; 3]> = ids.iter().map(|&i| [i as f64, 0.5, -1.0]).collect();
    let density: Vec<f64> = ids.iter().map(|&i| 1000.0 + i as f64).collect();
    Checkpoint::new(0.5, 10, ids, positions).with("density", density)
}

#[test]
fn a_long_scene_and_many_attributes_fit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vtkhdf");
    let scene = "# Fluß – ρ = 1000 kg/m³\n".repeat(10_000);
    let mut long = state(3).with_attribute("scene", scene);
    for i in 0..100 {
        long.attributes.set(format!("parameter {i}"), f64::from(i));
    }
    write_checkpoint(&path, &long).unwrap();
    assert_eq!(read_checkpoint::<3>(&path).unwrap(), long);
}

#[test]
fn a_file_cut_anywhere_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vtkhdf");
    write_checkpoint(&path, &state(200).with_attribute("scene", "x".repeat(500))).unwrap();
    let whole = fs::read(&path).unwrap();
    for length in (0..whole.len()).step_by(97).chain([whole.len() - 1]) {
        fs::write(&path, &whole[..length]).unwrap();
        let error = read_checkpoint::<3>(&path).unwrap_err();
        assert!(matches!(error, IoError::NotACheckpoint { .. }), "{length}: {error:?}");
        assert!(error.to_string().contains("older checkpoint"), "{error}");
    }
}

#[test]
fn a_file_with_a_flipped_byte_never_panics() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vtkhdf");
    write_checkpoint(&path, &state(20)).unwrap();
    let whole = fs::read(&path).unwrap();
    let mut file = OpenOptions::new().write(true).open(&path).unwrap();
    let mut put = |place: usize, byte: u8| {
        file.seek(SeekFrom::Start(place as u64)).unwrap();
        file.write_all(&[byte]).unwrap();
    };
    let mut refused = 0;
    for (place, &byte) in whole.iter().enumerate() {
        put(place, byte ^ 0x5a);
        // A flipped bit of a density goes unseen; one of the structure is an error.
        refused += usize::from(read_checkpoint::<3>(&path).is_err());
        put(place, byte);
    }
    assert!(refused > whole.len() / 10, "{refused} of {}", whole.len());
}

#[test]
fn errors_say_what_is_wrong() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vtkhdf");
    let missing = read_checkpoint::<3>(&path).unwrap_err();
    assert!(matches!(missing, IoError::Read { .. }), "{missing:?}");

    fs::write(&path, "dimension = 3\n".repeat(100)).unwrap();
    let text = read_checkpoint::<3>(&path).unwrap_err().to_string();
    assert!(text.contains("not an HDF5 file") && text.contains("a.vtkhdf"), "{text}");

    write_checkpoint(&path, &state(4)).unwrap();
    let dimension = read_checkpoint::<2>(&path).unwrap_err().to_string();
    assert!(dimension.contains("3-dimensional"), "{dimension}");

    let back = read_checkpoint::<3>(&path).unwrap();
    let absent = back.column::<f64>("mass").unwrap_err().to_string();
    assert!(absent.contains("mass") && absent.contains("density"), "{absent}");
    let other = back.column::<u64>("density").unwrap_err().to_string();
    assert!(other.contains("f64") && other.contains("u64"), "{other}");
    assert!(back.attributes.f64("dt").is_err());

    let short = write_checkpoint(&path, &state(4).with("mass", vec![1.0; 3])).unwrap_err();
    assert!(matches!(short, IoError::ColumnLength { found: 3, expected: 4, .. }), "{short:?}");
    for name in ["", "a/b", "id", "density", "two\nlines"] {
        let error = write_checkpoint(&path, &state(4).with(name, vec![1.0; 4])).unwrap_err();
        assert!(matches!(error, IoError::Name { .. }), "{name}: {error:?}");
    }
    assert!(write_checkpoint(&path, &state(4).with_attribute("time", 1.0)).is_err());
    assert!(write_checkpoint(&path, &state(4).with_attribute("scene", "a\0b")).is_err());
    // The refusals left the file as it was.
    assert_eq!(read_checkpoint::<3>(&path).unwrap(), state(4));
}

#[test]
fn another_format_version_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vtkhdf");
    let mut builder = hdf5_pure::FileBuilder::new();
    let mut group = builder.create_group("sph");
    group.set_attr("format_version", hdf5_pure::AttrValue::U64(99));
    builder.add_group(group.finish());
    builder.write(&path).unwrap();
    let error = read_checkpoint::<3>(&path).unwrap_err();
    assert!(matches!(error, IoError::FormatVersion { found: 99, .. }), "{error:?}");

    let mut builder = hdf5_pure::FileBuilder::new();
    builder.create_dataset("x").with_f64_data(&[1.0]);
    builder.write(&path).unwrap();
    let error = read_checkpoint::<3>(&path).unwrap_err().to_string();
    assert!(error.contains("no group /sph"), "{error}");
}

#[test]
fn the_newest_whole_one_is_found_and_old_ones_go() {
    let folder = tempfile::tempdir().unwrap();
    assert!(latest_checkpoint(folder.path()).unwrap().is_none());
    for step in [5, 40, 300, 2_000_000] {
        let mut state = state(3);
        state.step = step;
        write_checkpoint(folder.path().join(checkpoint_name(step)), &state).unwrap();
    }
    fs::write(folder.path().join(checkpoint_name(7_000_000)), "half").unwrap();
    fs::write(folder.path().join("checkpoint-x.vtkhdf"), "not ours").unwrap();
    let latest = latest_checkpoint(folder.path()).unwrap().unwrap();
    assert_eq!(latest.info.step, 2_000_000);
    assert_eq!(latest.skipped.len(), 1);

    assert_eq!(remove_checkpoints(folder.path(), 2_000_001..).unwrap(), 1);
    assert_eq!(prune_checkpoints(folder.path(), 2).unwrap(), 2);
    assert_eq!(prune_checkpoints(folder.path(), 0).unwrap(), 1);
    assert_eq!(latest_checkpoint(folder.path()).unwrap().unwrap().info.step, 2_000_000);
    assert_eq!(remove_checkpoints(folder.path(), ..).unwrap(), 1);
    assert!(folder.path().join("checkpoint-x.vtkhdf").exists());

    fs::write(folder.path().join(checkpoint_name(1)), "half").unwrap();
    assert!(matches!(latest_checkpoint(folder.path()), Err(IoError::NotACheckpoint { .. })));
}
