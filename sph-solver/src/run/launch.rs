//! From a scene to ranks that run it.

use super::digest::Digest;
use super::driver::Status;
use super::folder::{Existing, RunFolder};
use super::gauges::patch;
use super::identity::Identity;
use super::notes::Notes;
use super::plan::RunPlan;
use super::record::Record;
use super::reference::FieldReference;
use super::samples::{Probe, Quantity};
use super::shares::Shares;
use super::snapshot_choice::SnapshotChoice;
use super::stop::Stop;
use super::summary::{Meta, Summary};
use super::table::{Features, Job, Precision, Viscosity, run_job};
use super::world::World;
use crate::bodies::Bodies;
use crate::error::RunError;
use crate::model::{Model, OnLost, SolidModel};
use crate::scene::{self, At, Field, ProbeKind, Scene};
use crate::setup::{Constants, Particles, SchemeChoice, Setup};
use crate::team::Team;
use sph_decomp::{Blocking, Communicator, RanksError, Solo, ThreadRanks, check_same_build};
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// What the command line adds to a scene.
#[derive(Debug, Clone, Default)]
pub struct RunOptions {
    /// Folder for all files.
    pub out: PathBuf,
    /// Ends the run at another time, s.
    pub end_time: Option<f64>,
    /// Ranks as threads of this process.
    pub ranks: Option<usize>,
    /// Threads of each rank; all cores are shared out when absent.
    pub threads: Option<usize>,
    /// Seconds of simulated time between checkpoints, instead of the scene's.
    pub checkpoint_every: Option<f64>,
    /// What happens with results that lie in `out`.
    pub existing: Existing,
    /// Whether to wait for all messages of a pass before the local particles are computed. The same
    /// bits, only slower: it shows what the overlap is worth.
    pub blocking: bool,
    /// Ends the run with a checkpoint after so much wall-clock time.
    pub max_wall: Option<Duration>,
    /// Ends the run with a checkpoint when it is asked to.
    pub stop: Stop,
    /// Where remarks about the run go.
    pub notes: Notes,
    /// The command that asked for the run, for its record.
    pub command: Option<String>,
}

/// Runs a scene and returns its summary, the same on all processes. `watch` is called after each
/// step on the process that speaks.
pub fn run(
    world: &World,
    scene: &Scene,
    options: &RunOptions,
    watch: &(dyn Fn(Status) + Sync),
) -> Result<Summary, RunError> {
    let deadline = options.max_wall.and_then(|limit| Instant::now().checked_add(limit));
    let stop = options.stop.clone().with_deadline(deadline);
    world.once(|| RunFolder::look(&options.out, options.existing))?;
    match scene.dimension() {
        2 => run_in::<2>(world, scene, options, stop, watch),
        _ => run_in::<3>(world, scene, options, stop, watch),
    }
}

fn run_in<const D: usize>(
    world: &World,
    scene: &Scene,
    options: &RunOptions,
    stop: Stop,
    watch: &(dyn Fn(Status) + Sync),
) -> Result<Summary, RunError> {
    let launch = world.agree(Launch::<D>::new(scene, options, stop))?;
    launch.check_ranks(world)?;
    // Locked until the run is over.
    let folder = world.once(|| RunFolder::claim(&options.out, options.existing))?;
    if let Some(note) = folder.as_ref().and_then(RunFolder::note) {
        options.notes.add(note);
    }
    launch.notes.iter().for_each(|note| options.notes.add(note.as_str()));
    launch.run(world, watch)
}

struct Launch<const D: usize> {
    /// About the scene.
    notes: Vec<String>,
    shares: Shares<D>,
    bodies: Bodies<D>,
    model: Model<D>,
    features: Features,
    choice: SchemeChoice,
    /// Everything that determines the bits of the result: all ranks must have the same.
    fingerprint: String,
    plan: RunPlan<D>,
    ranks: Option<usize>,
    threads: Option<usize>,
    blocking: bool,
}

impl<const D: usize> Launch<D> {
    fn new(scene: &Scene, options: &RunOptions, stop: Stop) -> Result<Self, RunError> {
        let setup = Setup::<D>::new(scene)?;
        let notes = setup.notes();
        let Setup { particles, constants, solids, bodies, at_rest, choice, .. } = setup;
        let moving = bodies.iter().map(|body| body.solid).collect();
        let features = features(scene, choice.scheme, &constants, &particles);
        let model = model(&constants, solids);
        let fingerprint = fingerprint(&model, &features, &particles);
        let output = &scene.output;
        let end_time = options.end_time.unwrap_or(*scene.end_time);
        let checkpoints = options.checkpoint_every.or(output.checkpoint_every.as_deref().copied());
        let plan = RunPlan {
            name: scene.name().to_owned(),
            scene_text: scene.text().to_owned(),
            identity: Identity::new(scene, &particles, end_time, checkpoints),
            record: Record::new(scene, end_time, options.command.as_deref()),
            out: options.out.clone(),
            end_time,
            snapshots: output.snapshots.as_deref().copied(),
            snapshot_choice: SnapshotChoice::new(output),
            samples: output.energies.as_deref().copied(),
            checkpoints,
            energy_budget: output.energy_budget,
            probes: scene
                .probe
                .iter()
                .map(|one| (one.name.to_string(), probe(one, constants.spacing)))
                .collect(),
            reference: scene.reference.as_deref().and_then(FieldReference::of),
            resume: options.existing == Existing::Resume,
            keeps_state: checkpoints.is_some() || options.max_wall.is_some(),
            stop,
            notes: options.notes.clone(),
        };
        let (ranks, threads) = (options.ranks, options.threads);
        let blocking = options.blocking;
        let shares = Shares::new(particles, moving, ranks.unwrap_or(1));
        let bodies = Bodies::new(bodies, at_rest, model.domain.0, model.periods);
        Ok(Self {
            notes,
            bodies,
            fingerprint,
            shares,
            model,
            features,
            choice,
            plan,
            ranks,
            threads,
            blocking,
        })
    }

    /// Refuses ranks that cannot be, before anything is written.
    fn check_ranks(&self, world: &World) -> Result<(), RunError> {
        #[cfg(feature = "mpi")]
        if matches!((world, self.ranks), (World::Mpi(_), Some(_))) {
            return Err(RunError::RanksUnderMpi);
        }
        let (ranks, particles) = (self.ranks.unwrap_or(world.size()), self.shares.particles());
        if ranks > particles {
            return Err(RunError::TooManyRanks { ranks, particles });
        }
        Ok(())
    }

    fn run(self, world: &World, watch: &(dyn Fn(Status) + Sync)) -> Result<Summary, RunError> {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        match (world, self.ranks) {
            (World::Process, None | Some(1)) => {
                self.rank(&Solo, "solo", self.threads.unwrap_or(cores), watch)
            }
            (World::Process, Some(ranks)) => {
                let threads = self.threads.unwrap_or((cores / ranks).max(1));
                let summaries =
                    ThreadRanks::run(ranks, |comm| self.rank(&comm, "threads", threads, watch));
                let summaries = summaries.map_err(|error| match error {
                    RanksError::Failed { error, .. } => error,
                    other => RunError::Ranks(other.to_string()),
                })?;
                summaries.into_iter().next().ok_or(RunError::Ranks("no rank ran".into()))
            }
            #[cfg(feature = "mpi")]
            (World::Mpi(mpi), _) => {
                let result = self.rank(mpi, "mpi", self.threads.unwrap_or(1), watch);
                match result {
                    // Only this rank knows, and the others wait for it.
                    Err(error) if !error.is_on_all_ranks() => mpi.abort(&error.to_string()),
                    result => result,
                }
            }
        }
    }

    /// One rank of the run. Collective.
    fn rank(
        &self,
        comm: &dyn Communicator,
        communicator: &'static str,
        threads: usize,
        watch: &(dyn Fn(Status) + Sync),
    ) -> Result<Summary, RunError> {
        let without_overlap = Blocking::new(comm);
        let comm: &dyn Communicator = if self.blocking { &without_overlap } else { comm };
        let tag = format!(
            "sph {} {} {}",
            env!("CARGO_PKG_VERSION"),
            sph_kernels::simd_level(),
            self.fingerprint
        );
        check_same_build(&comm, tag.as_bytes())?;
        let silent = |_: Status| ();
        let (state, elements) = self.shares.take(comm);
        let mut summary = run_job(
            Job {
                comm,
                team: Team::new(threads)?,
                model: self.model.clone(),
                plan: &self.plan,
                state,
                elements,
                bodies: self.bodies.clone(),
                watch: if comm.rank() == 0 { watch } else { &silent },
                meta: Meta {
                    name: self.plan.name.clone(),
                    precision: match self.features.precision {
                        Precision::Mixed => "mixed",
                        Precision::Double => "double",
                    },
                    scheme: self.choice.clone(),
                    communicator,
                    overlapped: !self.blocking,
                    one_process: communicator != "mpi",
                },
            },
            self.features,
        )?;
        summary.notes = self.plan.notes.all();
        Ok(summary)
    }
}

fn model<const D: usize>(constants: &Constants<D>, solids: Vec<SolidModel<D>>) -> Model<D> {
    Model {
        spacing: constants.spacing,
        support_radius: constants.support_radius,
        grading: constants.grading,
        skin: constants.skin,
        gravity: constants.gravity,
        equation_of_state: constants.equation_of_state,
        limits: constants.step_limits(),
        domain: constants.domain,
        periods: constants.periods,
        closed: constants.closed,
        lowest_pressure: constants.cavitation_pressure.unwrap_or(f64::NEG_INFINITY),
        solids,
        on_lost: match constants.on_lost {
            scene::OnLost::Stop => OnLost::Stop,
            scene::OnLost::Remove => OnLost::Remove,
        },
    }
}

fn features<const D: usize>(
    scene: &Scene,
    scheme: scene::Scheme,
    constants: &Constants<D>,
    particles: &Particles<D>,
) -> Features {
    Features {
        precision: match scene.numerics.precision {
            scene::Precision::Mixed => Precision::Mixed,
            scene::Precision::Double => Precision::Double,
        },
        density_diffusion: constants.density_diffusion,
        viscosity: match (constants.viscosity, constants.artificial_viscosity) {
            (Some(mu), _) if mu > 0.0 => Viscosity::Laminar(mu),
            (_, alpha) if alpha > 0.0 => Viscosity::Artificial(alpha),
            _ => Viscosity::None,
        },
        shifting: scheme == scene::Scheme::DeltaPlus,
        energy_budget: scene.output.energy_budget,
        walls: particles.kind.last().is_some_and(|&kind| kind > 0),
    }
}

/// Everything that determines the bits of the result, as a text.
fn fingerprint<const D: usize>(
    model: &Model<D>,
    features: &Features,
    particles: &Particles<D>,
) -> String {
    let mut digest = Digest::default();
    for (i, x) in particles.position.iter().enumerate() {
        let scalars = [particles.density[i], particles.mass[i], f64::from(particles.kind[i])];
        let words = x.iter().copied().chain(particles.velocity[i]).chain(scalars);
        digest.add(i as u64, words);
    }
    format!("{D}-D {model:?} {features:?} particles {digest}")
}

pub(super) fn probe<const D: usize>(probe: &scene::Probe, spacing: f64) -> Probe<D> {
    // The scene has checked that what a kind needs is there and fits the dimension.
    let array = |numbers: Option<&At<Vec<f64>>>| numbers.map(|numbers| scene::vector(numbers));
    let at: [f64; D] = array(probe.at.as_ref()).unwrap_or([0.0; D]);
    let normal: Option<[f64; D]> = array(probe.normal.as_ref());
    let fields = probe.fields.as_deref().map_or(&[][..], Vec::as_slice);
    let quantities = fields.iter().flat_map(|field| quantities::<D>(*field)).collect();
    match probe.kind {
        ProbeKind::Front => {
            Probe::Front { axis: probe.axis.as_ref().map_or(0, |axis| axis.index()) }
        }
        ProbeKind::Point => Probe::Point { at, quantities },
        ProbeKind::Patch => {
            let radius = probe.radius.as_deref().copied().unwrap_or(0.0);
            Probe::Patch { points: patch(&at, radius, normal.as_ref(), spacing), quantities }
        }
        ProbeKind::Level => Probe::Level { at },
        ProbeKind::Flow => Probe::Flow { at, normal: normal.unwrap_or([0.0; D]) },
    }
}

fn quantities<const D: usize>(field: Field) -> Vec<Quantity> {
    match field {
        Field::Pressure => vec![Quantity::Pressure],
        Field::Density => vec![Quantity::Density],
        Field::Velocity => (0..D).map(Quantity::Velocity).collect(),
    }
}
