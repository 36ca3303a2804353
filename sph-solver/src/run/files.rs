//! The files of a run. Only rank 0 writes; every file appears whole or not at all.

use super::energy_log::EnergyRow;
use super::load_log::LoadRow;
use super::plan::RunPlan;
use super::samples::Budget;
use super::snapshot_choice::SnapshotChoice;
use crate::bodies::Kinematics;
use crate::energy::Sink;
use crate::error::RunError;
use crate::loads::NUMBERS;
use crate::model::Model;
use crate::scene::SnapshotField;
use crate::simulation::{FullStep, Lost};
use crate::walls::WallElements;
use sph_io::{IoError, ParticleFrame, SnapshotSeries, TableWriter};
use std::ops::Range;

/// Kind of the fluid particles in files; solid k of the scene has kind 1 + k.
const FLUID: u16 = 0;

/// Open outputs of rank 0.
#[derive(Debug)]
pub struct Files {
    series: SnapshotSeries,
    energies: TableWriter,
    probes: Vec<TableWriter>,
    solids: Vec<TableWriter>,
    reference: Option<TableWriter>,
    lost: TableWriter,
    snapshots: u64,
    choice: SnapshotChoice,
}

impl Files {
    /// Opens the outputs of a run with solids of these names, which move or not; with `resumed_at`, continues those that end at that time (s).
    pub fn open<const D: usize>(
        plan: &RunPlan<D>,
        solids: &[(&str, bool)],
        resumed_at: Option<f64>,
    ) -> Result<Self, RunError> {
        let table = |name: &str, columns: &[(&str, &str)]| {
            let path = plan.out.join(format!("{name}.csv"));
            let table: Result<TableWriter, IoError> = match resumed_at {
                Some(time) => TableWriter::resume(path, columns, time),
                None => TableWriter::create(path, columns),
            };
            table
        };
        let table_or_aside = |name: &str, columns: &[(&str, &str)]| {
            match (table(name, columns), resumed_at) {
                // The scene asks for other columns now.
                (Err(IoError::Text { line: 1, path, .. }), Some(time)) => {
                    let aside = plan.out.join(format!("{name}-until-{time}.csv"));
                    plan.notes.add(format!(
                        "{} has other columns than {name} now: it becomes {}",
                        path.display(),
                        aside.display()
                    ));
                    std::fs::rename(&path, &aside)
                        .map_err(|source| RunError::Folder { path: aside, source })?;
                    table(name, columns)
                }
                (table, _) => table,
            }
            .map_err(RunError::from)
        };
        let probes = plan
            .probes
            .iter()
            .map(|(name, probe)| table_or_aside(&format!("probe-{name}"), &probe.columns()));
        Ok(Self {
            series: match resumed_at {
                Some(time) => SnapshotSeries::resume(&plan.out, &plan.name, time)?,
                None => SnapshotSeries::create(&plan.out, &plan.name)?,
            },
            energies: table_or_aside("energies", &energy_columns(D, plan.energy_budget))?,
            probes: probes.collect::<Result<_, _>>()?,
            solids: solids
                .iter()
                .map(|(name, moves)| table(&format!("solid-{name}"), &solid_columns(D, *moves)))
                .collect::<Result<_, _>>()?,
            reference: match &plan.reference {
                Some(reference) => Some(table("reference", &reference.columns())?),
                None => None,
            },
            lost: table("lost", &lost_columns(D))?,
            snapshots: 0,
            choice: plan.snapshot_choice.clone(),
        })
    }

    /// Writes the particles that do not move, once for the whole series.
    pub fn walls<const D: usize>(
        &mut self,
        walls: &WallElements<D>,
        density0: f64,
    ) -> Result<(), RunError> {
        let frame = wall_frame(&self.choice, 0.0, walls, density0);
        let rows = self.choice.rows(None, &walls.position);
        let frame = within(frame, rows.as_deref());
        Ok(self.series.fixed_part("walls", &self.choice.packed(frame))?)
    }

    /// Writes a snapshot of the fluid, and of the walls that move if there are any.
    pub fn snapshot<const D: usize>(
        &mut self,
        model: &Model<D>,
        full: &FullStep<D>,
        moving: &WallElements<D>,
    ) -> Result<(), RunError> {
        let eos = &model.equation_of_state;
        let pressure =
            || full.density.iter().map(|d| eos.pressure(*d) as f32).collect::<Vec<f32>>();
        let mut frame = ParticleFrame::new(full.time, &full.position);
        for field in SnapshotField::ALL {
            frame = match field {
                field if !self.choice.has(field) => frame,
                SnapshotField::Velocity => frame.with("velocity", single(&full.velocity)),
                SnapshotField::Pressure => frame.with("pressure", pressure()),
                SnapshotField::Density => frame.with("density", single_scalars(&full.density)),
                SnapshotField::Kind => frame.with("kind", vec![FLUID; full.id.len()]),
                SnapshotField::Id => frame.with("id", &full.id),
            };
        }
        let rows = self.choice.rows(Some(&full.id), &full.position);
        let frame = self.choice.packed(within(frame, rows.as_deref()));
        let rows = self.choice.rows(None, &moving.position);
        let walls = wall_frame(&self.choice, full.time, moving, eos.density0());
        let walls = self.choice.packed(within(walls, rows.as_deref()));
        let parts = [("moving", &walls)];
        self.series.write_parts(&frame, if moving.is_empty() { &[] } else { &parts })?;
        self.snapshots += 1;
        Ok(())
    }

    /// Appends a row to each table.
    pub fn samples<const D: usize>(
        &mut self,
        time: f64,
        budget: &Budget<D>,
        energy: Option<&EnergyRow>,
        readings: &[Vec<f64>],
    ) -> Result<(), RunError> {
        let mut row = vec![budget.kinetic, budget.potential, budget.elastic];
        row.extend(budget.momentum);
        row.extend([budget.compression, budget.speed]);
        if let Some(energy) = energy {
            row.extend(energy.taken);
            row.push(energy.residual);
        }
        self.energies.row(time, &row)?;
        for (table, reading) in self.probes.iter_mut().zip(readings) {
            table.row(time, reading)?;
        }
        Ok(())
    }

    /// Appends a row to the table of errors against the reference.
    pub fn errors(&mut self, time: f64, errors: &[f64]) -> Result<(), RunError> {
        match &mut self.reference {
            Some(table) => Ok(table.row(time, errors)?),
            None => Ok(()),
        }
    }

    /// Appends a row to the table of each solid.
    pub fn loads<const D: usize>(
        &mut self,
        time: f64,
        rows: &[LoadRow],
        moving: &[(u16, Kinematics)],
    ) -> Result<(), RunError> {
        for ((table, row), solid) in self.solids.iter_mut().zip(rows).zip(0..) {
            let total = |load: &[f64; NUMBERS], k: usize| load[k] + load[6 + k];
            let (forces, moments) = load_axes(D);
            let mut numbers = Vec::new();
            for load in [&row.now, &row.mean] {
                numbers.extend(forces.clone().chain(moments.clone()).map(|k| total(load, k)));
            }
            numbers.extend(forces.map(|k| row.now[6 + k]));
            numbers.push(row.largest);
            if let Some((_, kinematics)) = moving.iter().find(|(number, _)| *number == solid) {
                numbers.extend(motion_row(D, kinematics));
            }
            table.row(time, &numbers)?;
        }
        Ok(())
    }

    /// Reports particles that were taken out.
    pub fn lost<const D: usize>(&mut self, lost: &[Lost<D>]) -> Result<(), RunError> {
        for one in lost {
            let mut row = vec![one.id as f64];
            row.extend(one.position);
            self.lost.row(one.time, &row)?;
        }
        Ok(())
    }

    /// Snapshots written by this process.
    pub fn snapshots(&self) -> u64 {
        self.snapshots
    }
}

/// The frame of these rows, or of all.
fn within<'a, const D: usize>(
    frame: ParticleFrame<'a, D>,
    rows: Option<&'a [u32]>,
) -> ParticleFrame<'a, D> {
    match rows {
        Some(rows) => frame.select(rows),
        None => frame,
    }
}

/// Elements of walls as a part of a snapshot.
fn wall_frame<'a, const D: usize>(
    choice: &SnapshotChoice,
    time: f64,
    walls: &'a WallElements<D>,
    density0: f64,
) -> ParticleFrame<'a, D> {
    // The pressure of a wall is a matter of each pair; 0 keeps the array in every file.
    let kind = || walls.solid.iter().map(|solid| FLUID + 1 + solid).collect::<Vec<u16>>();
    let mut frame = ParticleFrame::new(time, &walls.position);
    for field in SnapshotField::ALL {
        frame = match field {
            field if !choice.has(field) => frame,
            SnapshotField::Velocity => frame.with("velocity", vec![[0.0_f32; D]; walls.len()]),
            SnapshotField::Pressure => frame.with("pressure", vec![0.0_f32; walls.len()]),
            SnapshotField::Density => frame.with("density", vec![density0 as f32; walls.len()]),
            SnapshotField::Kind => frame.with("kind", kind()),
            SnapshotField::Id => frame.with("id", &walls.id),
        };
    }
    frame.with("normal", single(&walls.normal))
}

/// Columns of the table of a solid that moves or rests, without the time.
pub(super) fn solid_columns(dimension: usize, moves: bool) -> Vec<(&'static str, &'static str)> {
    let mut columns = load_columns(dimension);
    if moves {
        columns.extend(motion_columns(dimension));
    }
    columns
}

/// What the table of a solid that moves says of its motion, besides the load on it.
fn motion_columns(dimension: usize) -> Vec<(&'static str, &'static str)> {
    let vectors = [
        (["x", "y", "z"], "m"),
        (["velocity_x", "velocity_y", "velocity_z"], "m/s"),
        (["acceleration_x", "acceleration_y", "acceleration_z"], "m/s2"),
    ];
    let of = |(names, unit): ([&'static str; 3], &'static str)| {
        names.into_iter().take(dimension).map(move |name| (name, unit))
    };
    let mut columns: Vec<_> = vectors.into_iter().flat_map(of).collect();
    let turns = [
        (["rotation_x", "rotation_y", "rotation_z"], "rad"),
        (["spin_x", "spin_y", "spin_z"], "rad/s"),
    ];
    for (names, unit) in turns {
        let skipped = if dimension == 2 { 2 } else { 0 };
        columns.extend(names.into_iter().skip(skipped).map(|name| (name, unit)));
    }
    columns
}

/// The numbers under [`motion_columns`]. The rotation is a vector along the axis, as long as the angle.
fn motion_row(dimension: usize, kinematics: &Kinematics) -> Vec<f64> {
    let Kinematics { rigid, acceleration } = kinematics;
    let mut row = Vec::new();
    for vector in [&rigid.position, &rigid.velocity, acceleration] {
        row.extend(vector.iter().take(dimension));
    }
    for vector in [rigid.orientation.scaled_axis(), rigid.spin] {
        row.extend(vector.iter().skip(if dimension == 2 { 2 } else { 0 }));
    }
    row
}

/// Snapshots are for the eye: single precision halves them.
fn single<const D: usize>(vectors: &[[f64; D]]) -> Vec<[f32; D]> {
    vectors.iter().map(|v| v.map(|c| c as f32)).collect()
}

fn single_scalars(scalars: &[f64]) -> Vec<f32> {
    scalars.iter().map(|&s| s as f32).collect()
}

const AXES: [(&str, &str); 3] =
    [("momentum_x", "kg m/s"), ("momentum_y", "kg m/s"), ("momentum_z", "kg m/s")];

pub(super) fn energy_columns(dimension: usize, budget: bool) -> Vec<(&'static str, &'static str)> {
    let mut columns = vec![("kinetic", "J"), ("potential", "J"), ("elastic", "J")];
    columns.extend(&AXES[..dimension]);
    columns.extend([("compression", "1"), ("speed", "m/s")]);
    if budget {
        columns.extend(Sink::ALL.map(|sink| (sink.column(), "J")));
        columns.push(("residual", "J"));
    }
    columns
}

/// Components of force and moment in so many dimensions, as numbers of a load.
fn load_axes(dimension: usize) -> (Range<usize>, Range<usize>) {
    if dimension == 2 { (0..2, 5..6) } else { (0..3, 3..6) }
}

fn load_columns(dimension: usize) -> Vec<(&'static str, &'static str)> {
    // In two dimensions a load is that on a metre of depth.
    let (force, moment) = if dimension == 2 { ("N/m", "N") } else { ("N", "N m") };
    let (forces, moments) = load_axes(dimension);
    let names = |names: [&'static str; 6]| {
        let of = |k: usize| (names[k], if k < 3 { force } else { moment });
        forces.clone().chain(moments.clone()).map(of).collect::<Vec<_>>()
    };
    let mut columns = names(["force_x", "force_y", "force_z", "moment_x", "moment_y", "moment_z"]);
    columns.extend(names([
        "mean_force_x",
        "mean_force_y",
        "mean_force_z",
        "mean_moment_x",
        "mean_moment_y",
        "mean_moment_z",
    ]));
    let friction = ["friction_force_x", "friction_force_y", "friction_force_z"];
    columns.extend(friction[..dimension].iter().map(|name| (*name, force)));
    columns.push(("largest_force", force));
    columns
}

fn lost_columns(dimension: usize) -> Vec<(&'static str, &'static str)> {
    let mut columns = vec![("id", "1")];
    columns.extend(&[("x", "m"), ("y", "m"), ("z", "m")][..dimension]);
    columns
}
