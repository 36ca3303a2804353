//! The scene as a whole.

use super::check;
use super::document::{self, Place, Source, Sources};
use super::domain::Domain;
use super::error::{ErrorKind, SceneError};
use super::fluid::Fluid;
use super::located::At;
use super::numerics::Numerics;
use super::output::Output;
use super::overrides;
use super::probe::{Axis, Probe};
use super::reader;
use super::reference::{Reference, StudyKeys};
use super::refine::Refine;
use super::solid::Solid;
use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

/// A scene: what is simulated, how, and what is written. SI units throughout.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Scene")]
pub struct Scene {
    /// Name of the scene and of its snapshots. The file's name when absent.
    pub name: Option<At<String>>,
    /// Number of space dimensions: 2 or 3.
    #[schemars(range(min = 2, max = 3))]
    pub dimension: At<usize>,
    /// Simulated time at which the run ends, s.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub end_time: At<f64>,
    /// Gravity, m/s², one number per dimension. None when absent.
    pub gravity: Option<At<Vec<f64>>>,
    /// The box that particles may be in.
    pub domain: Option<At<Domain>>,
    /// Axes along which the domain repeats: what leaves it on one side comes in on the other. Needs a
    /// `[domain]` that is a whole number of spacings long along them.
    #[serde(default)]
    pub periodic: At<Vec<At<Axis>>>,
    /// Resolution, scheme and its constants.
    pub numerics: Numerics,
    /// Where particles are finer than `numerics.spacing`.
    #[serde(default)]
    pub refine: Vec<At<Refine>>,
    /// Fluids by name; exactly one for now.
    #[serde(default)]
    pub fluid: BTreeMap<String, At<Fluid>>,
    /// Walls, at rest or moving.
    #[serde(default)]
    pub solid: Vec<At<Solid>>,
    /// Numbers written down while the run goes on.
    #[serde(default)]
    pub probe: Vec<At<Probe>>,
    /// What is written how often.
    #[serde(default)]
    pub output: Output,
    /// What is known about the flow, and how the error of a run is measured by it.
    pub reference: Option<At<Reference>>,
    /// What `sph study` varies.
    #[serde(default)]
    pub study: StudyKeys,
    /// The texts that the scene was read from.
    #[serde(skip)]
    sources: Sources,
    /// Folder that mesh paths are relative to.
    #[serde(skip)]
    folder: PathBuf,
    #[serde(skip)]
    fallback_name: String,
}

impl Scene {
    /// Reads a scene file. `overrides` are `key.path=value` texts, applied in order; meshes are looked
    /// for relative to the folder of the file.
    pub fn read(path: &Path, overrides: &[String]) -> Result<Self, SceneError> {
        let unreadable = |reason: String| {
            let kind = ErrorKind::Unreadable { path: path.into(), reason };
            SceneError::new(kind, None, Sources::default())
        };
        let bytes = std::fs::read(path).map_err(|error| unreadable(error.to_string()))?;
        let text = String::from_utf8(bytes).map_err(|error| {
            let byte = error.utf8_error().valid_up_to();
            unreadable(format!("it is not text: byte {byte} is no UTF-8"))
        })?;
        let name = path.display().to_string();
        let mut scene = Self::parse(&name, text, overrides)?;
        scene.folder = path.parent().unwrap_or(Path::new("")).into();
        scene.fallback_name =
            path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into());
        Ok(scene)
    }

    /// Reads a scene from a text, which errors call `name`. Meshes are looked for relative to the
    /// current folder.
    pub fn parse(name: &str, text: String, overrides: &[String]) -> Result<Self, SceneError> {
        let file = Source { name: name.into(), text };
        let arguments =
            overrides.iter().map(|text| Source { name: "--set".into(), text: text.clone() });
        let sources = Sources::new(std::iter::once(file).chain(arguments).collect());
        let text = sources.get(Place::default()).map_or("", |source| source.text.as_str());
        let mut root = document::parse_file(&sources, text)?;
        for (index, argument) in overrides.iter().enumerate() {
            overrides::apply(&mut root, &sources, 1 + index, argument)?;
        }
        let mut scene: Self = reader::read(&root)
            .map_err(|error| SceneError::new(*error.kind, error.place, sources.clone()))?;
        scene.sources = sources;
        check::check(&scene)?;
        Ok(scene)
    }

    /// The name of the scene.
    pub fn name(&self) -> &str {
        self.name.as_ref().map_or(&self.fallback_name, |name| name)
    }

    /// Number of space dimensions, 2 or 3.
    pub fn dimension(&self) -> usize {
        *self.dimension
    }

    /// The text of the scene file, without overrides.
    pub fn text(&self) -> &str {
        self.sources.get(Place::default()).map_or("", |source| &source.text)
    }

    /// The scene file as the user named it.
    pub fn file_name(&self) -> &str {
        self.sources.get(Place::default()).map_or("", |source| &source.name)
    }

    /// Folder of the scene file; empty for the current one.
    pub(super) fn folder(&self) -> &Path {
        &self.folder
    }

    /// The `--set` arguments in order.
    pub fn overrides(&self) -> impl Iterator<Item = &str> {
        self.sources.arguments()
    }

    /// A path of the scene as seen from the current folder. Where the system finds nothing, `a/..` is
    /// taken for nothing at all, so that `a` need not be there.
    pub fn resolve(&self, path: &Path) -> PathBuf {
        let whole = self.folder.join(path);
        if whole.exists() {
            return whole;
        }
        let short = without_detours(&whole);
        if short.exists() { short } else { whole }
    }

    /// The only fluid and its name.
    pub fn fluid(&self) -> Result<(&str, &At<Fluid>), SceneError> {
        let mut fluids = self.fluid.iter();
        match (fluids.next(), fluids.next()) {
            (Some((name, fluid)), None) => Ok((name, fluid)),
            (None, _) => {
                let kind = ErrorKind::Nothing {
                    why: "the scene has no fluid".into(),
                    help: "add a table such as [fluid.water] with density and regions".into(),
                };
                Err(self.error(Place::default(), kind))
            }
            (Some((one, first)), Some((two, second))) => {
                let later = if first.place.start > second.place.start { first } else { second };
                let kind = ErrorKind::Invalid {
                    what: format!("the scene has more than one fluid: `{one}` and `{two}`"),
                    help: "keep one: flows of several fluids are not part of this version".into(),
                };
                Err(self.error(later.place, kind))
            }
        }
    }

    /// Gravity, m/s²; zero when the scene has none.
    pub fn gravity<const D: usize>(&self) -> [f64; D] {
        vector(self.gravity.as_ref().map_or(&[], |gravity| gravity.as_slice()))
    }

    /// Whether the domain repeats along each axis.
    pub fn periodic_axes<const D: usize>(&self) -> [bool; D] {
        std::array::from_fn(|axis| self.periodic.iter().any(|name| name.index() == axis))
    }

    /// Dynamic viscosity of the fluid, Pa s, if it has one.
    pub fn viscosity(&self) -> Option<f64> {
        let fluid = self.fluid.values().next()?;
        fluid.viscosity.map(|viscosity| *viscosity).filter(|viscosity| *viscosity > 0.0)
    }

    /// Artificial viscosity α: what the scene says, else 0.02 unless the fluid has a physical one.
    pub fn artificial_viscosity(&self) -> f64 {
        let usual = if self.viscosity().is_some() { 0.0 } else { 0.02 };
        self.numerics.artificial_viscosity.map_or(usual, |alpha| *alpha)
    }

    /// The error of `kind` at `place`.
    pub fn error(&self, place: Place, kind: ErrorKind) -> SceneError {
        self.sources.error(place, kind)
    }

    /// The error of `kind` that is not the fault of a text.
    pub fn error_without_place(&self, kind: ErrorKind) -> SceneError {
        SceneError::new(kind, None, self.sources.clone())
    }
}

/// A path without `.` and without folders that `..` leaves again.
fn without_detours(path: &Path) -> PathBuf {
    let mut short = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => (),
            Component::ParentDir
                if matches!(short.components().next_back(), Some(Component::Normal(_))) =>
            {
                short.pop();
            }
            part => short.push(part),
        }
    }
    short
}

/// A checked vector of the scene as an array; missing components are 0.
pub(crate) fn vector<const D: usize>(numbers: &[f64]) -> [f64; D] {
    std::array::from_fn(|axis| numbers.get(axis).copied().unwrap_or(0.0))
}
