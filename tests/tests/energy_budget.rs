//! The energy budget: it closes, it changes nothing, and it is the same on any ranks and after a resume.

use serde_json::Value;
use sph_tests::{Results, Run, SMALL, Table, scene, write_scene};

const ON: &str = "output.energy_budget=true";

fn impact() -> Run {
    Run::new(scene("block-impact-2d")).set("numerics.spacing=0.04").threads(1)
}

fn dam_break() -> Run {
    Run::new(scene("dam-break-2d")).set("numerics.spacing=0.05").threads(1)
}

/// What was taken by the column `to_NAME` in the end, as a share of the energy at the start.
fn took(table: &Table, name: &str) -> f64 {
    table.column(&format!("to_{name}")).last().unwrap() / energy(table)[0]
}

/// Kinetic, potential and elastic energy of each row.
fn energy(table: &Table) -> Vec<f64> {
    let kinds = ["kinetic", "potential", "elastic"].map(|kind| table.column(kind));
    (0..table.rows.len()).map(|row| kinds.iter().map(|kind| kind[row]).sum()).collect()
}

/// All columns that begin with `to_`, added up row by row.
fn all_taken(table: &Table) -> Vec<f64> {
    let is_sink = |k: &usize| table.titles[*k].starts_with("to_");
    let sinks: Vec<usize> = (0..table.titles.len()).filter(is_sink).collect();
    assert_eq!(sinks.len(), 11, "{:?}", table.titles);
    table.rows.iter().map(|row| sinks.iter().map(|&k| row[k]).sum()).collect()
}

/// Asserts that what was taken accounts for the energy, row by row to 1 % of that at the start.
#[track_caller]
fn assert_closed(results: &Results) -> Table {
    let table = results.table("energies");
    let (energy, taken, residual) = (energy(&table), all_taken(&table), table.column("residual"));
    let mut largest = 0.0_f64;
    for row in 0..table.rows.len() {
        let missing = energy[row] + taken[row] - energy[0] - taken[0];
        assert!((missing - residual[row]).abs() < 1e-9 * energy[0], "row {row}");
        largest = largest.max(residual[row].abs());
    }
    assert!(largest < 0.01 * energy[0], "{largest} J of {} J", energy[0]);
    let told = results.summary()["energy_budget"]["largest_residual_share"].as_f64().unwrap();
    assert!((told.abs() / (largest / energy[0]) - 1.0).abs() < 0.05, "{told} {largest}");
    table
}

#[test]
fn it_closes_in_the_impact_of_two_blocks() {
    let table = assert_closed(&Results::of(impact().set(ON)));
    // The blow takes 27 % by theory; nothing but the two dissipative terms can have done so.
    let (viscosity, diffusion) =
        (took(&table, "artificial_viscosity"), took(&table, "density_diffusion"));
    assert!(viscosity > 0.1 && diffusion > 0.1, "{viscosity} {diffusion}");
    assert!(viscosity + diffusion > 0.26, "{viscosity} {diffusion}");
    for nothing in ["wall_pressure", "wall_damping", "wall_friction", "solids", "driving"] {
        assert_eq!(took(&table, nothing), 0.0, "{nothing}");
    }
}

#[test]
fn it_closes_in_the_dam_break_and_changes_nothing() {
    let results = Results::of(dam_break().set(ON));
    let table = assert_closed(&results);
    let damping = took(&table, "wall_damping");
    assert!(damping > 1e-3, "{damping}");
    assert!(took(&table, "artificial_viscosity") > 0.01);
    assert_eq!(results.digest(), Results::of(dam_break()).digest());
}

#[test]
fn it_closes_when_gravity_drives_and_walls_rub() {
    let results = Results::of(Run::new(scene("poiseuille-2d")).set(ON).threads(1));
    let table = results.table("energies");
    let last = |name: &str| *table.column(name).last().unwrap();
    let given = -last("to_driving");
    assert!(given > 0.0 && last("to_viscosity") > 0.3 * given && last("to_wall_friction") > 0.0);
    assert!(last("residual").abs() < 1e-4 * given, "{} of {given}", last("residual"));
    assert_eq!(last("potential"), 0.0);
}

/// Water in a tank that is pushed, so that some of it splashes out of the domain.
fn driven(folder: &std::path::Path) -> Run {
    let scene = SMALL
        .replace("max = [0.3, 0.4]", "max = [1.0, 0.3]")
        .replace("[numerics]", "domain = { min = [-0.1, -0.1], max = [1.5, 0.36] }\n[numerics]")
        .replace("end_time = 0.2", "end_time = 0.3")
        .replace("spacing = 0.02", "spacing = 0.02\non_lost = \"remove\"")
        .replace("fluid_side", "motion = { velocity = [1.0, 0.0] }\nfluid_side");
    Run::new(write_scene(folder, &scene)).threads(1).set(ON)
}

#[test]
fn moving_solids_give_and_lost_particles_take() {
    let folder = tempfile::tempdir().unwrap();
    let results = Results::of(driven(folder.path()));
    let (summary, table) = (results.summary(), results.table("energies"));
    let taken = |name: &str| summary["energy_budget"]["taken"][name].as_f64().unwrap();
    // What the tank gives is its speed of 1 m/s times the mean force on it, row by row.
    let (force, time) = (results.table("solid-tank").column("mean_force_x"), table.times());
    let work: f64 = (1..time.len()).map(|k| force[k] * (time[k] - time[k - 1])).sum();
    let given = table.column("to_solids");
    let given = given[given.len() - 1] - given[0];
    assert!(work < -1.0 && (given / work - 1.0).abs() < 1e-6, "{given} {work}");
    assert!(summary["lost_particles"].as_u64().unwrap() > 0, "{summary:#}");
    assert!(taken("to_lost_particles") > 0.0, "{summary:#}");
    let share = summary["energy_budget"]["largest_residual_share"].as_f64().unwrap();
    assert!(share.abs() < 0.01, "{summary:#}");
}

/// A box through still water: around its edges too, walls only take from what moves along their normals.
#[test]
fn damping_by_walls_never_gives() {
    let folder = tempfile::tempdir().unwrap();
    let body = "[[solid]]\nname = \"box\"\nbox = { min = [0.2, 0.1], max = [0.4, 0.2] }\n\
        fluid_side = \"outside\"\nmotion = { velocity = [0.8, 0.0] }\n\n[[probe]]";
    let text = SMALL.replace("max = [0.3, 0.4]", "max = [1.0, 0.3]").replace("[[probe]]", body);
    let results = Results::of(Run::new(write_scene(folder.path(), &text)).threads(1).set(ON));
    let table = results.table("energies");
    let taken = table.column("to_wall_damping");
    assert!(taken.windows(2).all(|pair| pair[1] >= pair[0]) && taken[taken.len() - 1] > 1.0);
    let speed = table.column("speed").into_iter().fold(0.0, f64::max);
    assert!(speed < 2.0, "{speed} m/s around a box of 0.8 m/s");
}

#[test]
fn it_is_the_same_on_any_ranks_and_after_a_resume() {
    let folder = tempfile::tempdir().unwrap();
    let run = |end: f64| driven(folder.path()).end_time(end).checkpoint_every(0.05);
    let budget = |results: &Results| -> Value { results.summary()["energy_budget"].clone() };
    let expected = Results::of(run(0.3));
    let results = Results::new();
    results.add(run(0.3).ranks(3));
    assert_eq!(results.table("energies"), expected.table("energies"), "on three ranks");
    assert_eq!(budget(&results), budget(&expected), "on three ranks");
    let results = Results::new();
    results.add(run(0.17));
    results.add(run(0.3).ranks(2).resume());
    assert_eq!(results.table("energies"), expected.table("energies"), "after a resume");
    assert_eq!(budget(&results), budget(&expected), "after a resume");
}

#[test]
fn it_can_begin_at_a_resume() {
    let folder = tempfile::tempdir().unwrap();
    let scene = write_scene(folder.path(), SMALL);
    let run = || Run::new(&scene).threads(1).checkpoint_every(0.05);
    let results = Results::new();
    results.add(run().end_time(0.1));
    results.add(run().set(ON).resume());
    let (table, summary) = (results.table("energies"), results.summary());
    let resumed_at = summary["resumed_at"].as_f64().unwrap();
    assert!(table.times()[0] >= resumed_at && table.column("residual")[0].abs() < 0.1);
    let notes = summary["notes"].to_string();
    for words in ["has no energy budget", "other columns than energies now"] {
        assert!(notes.contains(words), "{notes}");
    }
    let aside = results.files(".csv");
    assert!(aside.iter().any(|path| path.to_string_lossy().contains("energies-until-")));
}

#[test]
fn a_run_without_it_says_nothing_of_it() {
    let folder = tempfile::tempdir().unwrap();
    let results =
        Results::of(Run::new(write_scene(folder.path(), SMALL)).threads(1).end_time(0.02));
    assert!(results.summary().get("energy_budget").is_none());
    assert!(results.table("energies").titles.iter().all(|title| !title.starts_with("to_")));
}
