//! A process that is killed at any moment leaves only whole files under final names.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};
use std::{env, fs};

use sph_io::{
    Checkpoint, ParticleFrame, PvdIndex, SnapshotSeries, TableWriter, checkpoint_name,
    latest_checkpoint, prune_checkpoints, read_checkpoint, read_table, remove_stale_temporaries,
    write_checkpoint, write_text_atomically,
};
use vtkio::model::{Attribute, DataSet};
use vtkio::{IOBuffer, Vtk};

const FOLDER: &str = "SPH_IO_KILL_FOLDER";
const COLUMNS: [(&str, &str); 2] = [("step", ""), ("pressure", "Pa")];
const PARTICLES: u64 = 2000;
const KILLS: u64 = 30;

/// The victim: starts or resumes a run in the folder and writes as fast as it can.
#[test]
#[ignore = "writes until it is killed; the other test starts it"]
fn victim() {
    let folder = PathBuf::from(env::var_os(FOLDER).expect("the other test sets the folder"));
    let ids: Vec<u64> = (0..PARTICLES).collect();
    remove_stale_temporaries(&folder).unwrap();
    let (mut step, mut series, mut table) = match latest_checkpoint(&folder).unwrap() {
        None => (
            0,
            SnapshotSeries::create(&folder, "run").unwrap(),
            TableWriter::create(folder.join("probe.csv"), &COLUMNS).unwrap(),
        ),
        Some(latest) => (
            latest.info.step,
            SnapshotSeries::resume(&folder, "run", latest.info.time).unwrap(),
            TableWriter::resume(folder.join("probe.csv"), &COLUMNS, latest.info.time).unwrap(),
        ),
    };
    // A parent that died must not leave the victim behind.
    let end = Instant::now() + Duration::from_secs(20);
    while Instant::now() < end {
        let positions: Vec<[f64; 3]> = ids.iter().map(|&i| [i as f64, step as f64, 0.0]).collect();
        let time = step as f64;
        series.write(&ParticleFrame::new(time, &positions).with("id", &ids)).unwrap();
        let state = Checkpoint::new(time, step, &ids[..], &positions[..]);
        write_checkpoint(folder.join(checkpoint_name(step)), &state).unwrap();
        prune_checkpoints(&folder, 2).unwrap();
        for part in 1..20 {
            table.row(time + f64::from(part) * 0.05, &[time, 1e5]).unwrap();
        }
        write_text_atomically(folder.join("summary.json"), &format!("[{step}]")).unwrap();
        step += 1;
    }
}

fn start(folder: &Path) -> Child {
    Command::new(env::current_exe().unwrap())
        .args(["victim", "--exact", "--ignored"])
        .env(FOLDER, folder)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

fn assert_whole_vtu(path: &Path) {
    let grid = Vtk::import(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let DataSet::UnstructuredGrid { pieces, .. } = grid.data else {
        panic!("{} is no grid", path.display())
    };
    let [piece] = pieces.try_into().unwrap();
    let piece = piece.into_loaded_piece_data(None).unwrap();
    assert_eq!(piece.points.len() as u64, 3 * PARTICLES);
    assert_eq!(piece.cells.types.len() as u64, PARTICLES);
    let [Attribute::DataArray(id)] = &piece.data.point[..] else { panic!("not one column") };
    assert_eq!(id.data, (0..PARTICLES).collect::<IOBuffer>());
}

/// Reads everything in the folder; returns the step of the newest checkpoint.
fn assert_whole(folder: &Path) -> Option<u64> {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        if name.starts_with('.') {
            assert!(name.ends_with(".tmp"), "{name}");
            continue;
        }
        match path.extension().unwrap().to_str().unwrap() {
            "vtu" => assert_whole_vtu(&path),
            "vtkhdf" => {
                let state = read_checkpoint::<3>(&path).unwrap();
                assert_eq!(state.len() as u64, PARTICLES);
                assert!(state.positions.iter().all(|x| x[1] == state.time));
            }
            "pvd" => {
                let index = PvdIndex::open(&path).unwrap();
                assert!(index.entries().iter().all(|e| folder.join(&e.file).exists()));
                assert!(index.entries().windows(2).all(|w| w[0].time < w[1].time));
            }
            "csv" => {
                let text = fs::read_to_string(&path).unwrap();
                assert!(text.ends_with('\n'));
                let times = read_table(&path).unwrap().column("time").unwrap();
                assert!(times.windows(2).all(|w| w[0] < w[1]), "rows out of order");
            }
            "json" => {
                let text = fs::read_to_string(&path).unwrap();
                assert!(text.starts_with('[') && text.ends_with(']'), "{text}");
            }
            other => panic!("unexpected {other}"),
        }
    }
    latest_checkpoint(folder).unwrap().map(|latest| latest.info.step)
}

#[test]
fn killed_runs_leave_whole_files_and_resume() {
    let folder = tempfile::tempdir().unwrap();
    let mut reached = None;
    for kill in 0..KILLS {
        let mut victim = start(folder.path());
        if kill % 2 == 1 {
            // In every second round the run gets on, however slow the disk is.
            let patience = Instant::now() + Duration::from_secs(10);
            // An error here is a file that the victim pruned while it was looked at.
            let newest = || latest_checkpoint(folder.path()).ok().flatten().map(|l| l.info.step);
            while newest() <= reached {
                assert!(Instant::now() < patience, "the victim writes nothing");
                sleep(Duration::from_millis(1));
            }
        }
        sleep(Duration::from_micros(kill * 7919 % 20_000));
        victim.kill().unwrap();
        victim.wait().unwrap();
        let step = assert_whole(folder.path());
        assert!(step >= reached, "a whole checkpoint was lost");
        reached = step;
    }
    assert!(reached >= Some(KILLS / 2 - 1), "{reached:?}");
    remove_stale_temporaries(folder.path()).unwrap();
    let temporaries = fs::read_dir(folder.path())
        .unwrap()
        .filter(|entry| entry.as_ref().unwrap().file_name().to_str().unwrap().starts_with('.'));
    assert_eq!(temporaries.count(), 0);
}
