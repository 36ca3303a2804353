//! The files of a run. Only rank 0 writes; every file appears whole or not at all.

use super::plan::RunPlan;
use super::samples::Budget;
use crate::error::RunError;
use crate::model::Model;
use crate::simulation::{FullStep, Lost};
use crate::state::{FLUID, State};
use sph_io::{IoError, ParticleFrame, SnapshotSeries, TableWriter};

/// Open outputs of rank 0.
#[derive(Debug)]
pub struct Files {
    series: SnapshotSeries,
    energies: TableWriter,
    probes: Vec<TableWriter>,
    lost: TableWriter,
    snapshots: u64,
}

impl Files {
    /// Opens the outputs of a run; with `resumed_at`, continues those that end at that time (s).
    pub fn open<const D: usize>(
        plan: &RunPlan<D>,
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
        let probes = plan.probes.iter().map(|(name, probe)| {
            let (name, columns) = (format!("probe-{name}"), probe.columns());
            match (table(&name, &columns), resumed_at) {
                // The probe reads other things now.
                (Err(IoError::Text { line: 1, path, .. }), Some(time)) => {
                    let aside = plan.out.join(format!("{name}-until-{time}.csv"));
                    plan.notes.add(format!(
                        "{} has other columns than probe {name} now: it becomes {}",
                        path.display(),
                        aside.display()
                    ));
                    std::fs::rename(&path, &aside)
                        .map_err(|source| RunError::Folder { path: aside, source })?;
                    table(&name, &columns)
                }
                (table, _) => table,
            }
            .map_err(RunError::from)
        });
        Ok(Self {
            series: match resumed_at {
                Some(time) => SnapshotSeries::resume(&plan.out, &plan.name, time)?,
                None => SnapshotSeries::create(&plan.out, &plan.name)?,
            },
            energies: table("energies", &energy_columns(D))?,
            probes: probes.collect::<Result<_, _>>()?,
            lost: table("lost", &lost_columns(D))?,
            snapshots: 0,
        })
    }

    /// Writes the particles that do not move, once for the whole series.
    pub fn walls<const D: usize>(&mut self, walls: &State<D>) -> Result<(), RunError> {
        // The pressure of a wall is a matter of each pair; 0 keeps the array in every file.
        let frame = ParticleFrame::new(0.0, &walls.position)
            .with("velocity", single(&walls.velocity))
            .with("pressure", vec![0.0_f32; walls.len()])
            .with("density", single_scalars(&walls.density))
            .with("kind", &walls.kind)
            .with("id", &walls.id);
        Ok(self.series.fixed_part("walls", &frame)?)
    }

    /// Writes a snapshot of the fluid.
    pub fn snapshot<const D: usize>(
        &mut self,
        model: &Model<D>,
        full: &FullStep<D>,
    ) -> Result<(), RunError> {
        let eos = &model.equation_of_state;
        let pressure: Vec<f32> = full.density.iter().map(|d| eos.pressure(*d) as f32).collect();
        let kind = vec![FLUID; full.id.len()];
        let frame = ParticleFrame::new(full.time, &full.position)
            .with("velocity", single(&full.velocity))
            .with("pressure", pressure)
            .with("density", single_scalars(&full.density))
            .with("kind", kind)
            .with("id", &full.id);
        self.series.write(&frame)?;
        self.snapshots += 1;
        Ok(())
    }

    /// Appends a row to each table.
    pub fn samples<const D: usize>(
        &mut self,
        time: f64,
        budget: &Budget<D>,
        readings: &[Vec<f64>],
    ) -> Result<(), RunError> {
        let mut row = vec![budget.kinetic, budget.potential, budget.elastic];
        row.extend(budget.momentum);
        row.extend([budget.compression, budget.speed]);
        self.energies.row(time, &row)?;
        for (table, reading) in self.probes.iter_mut().zip(readings) {
            table.row(time, reading)?;
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

/// Snapshots are for the eye: single precision halves them.
fn single<const D: usize>(vectors: &[[f64; D]]) -> Vec<[f32; D]> {
    vectors.iter().map(|v| v.map(|c| c as f32)).collect()
}

fn single_scalars(scalars: &[f64]) -> Vec<f32> {
    scalars.iter().map(|&s| s as f32).collect()
}

const AXES: [(&str, &str); 3] =
    [("momentum_x", "kg m/s"), ("momentum_y", "kg m/s"), ("momentum_z", "kg m/s")];

fn energy_columns(dimension: usize) -> Vec<(&'static str, &'static str)> {
    let mut columns = vec![("kinetic", "J"), ("potential", "J"), ("elastic", "J")];
    columns.extend(&AXES[..dimension]);
    columns.extend([("compression", "1"), ("speed", "m/s")]);
    columns
}

fn lost_columns(dimension: usize) -> Vec<(&'static str, &'static str)> {
    let mut columns = vec![("id", "1")];
    columns.extend(&[("x", "m"), ("y", "m"), ("z", "m")][..dimension]);
    columns
}
