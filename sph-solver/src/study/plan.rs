//! The runs of a study: every combination of the values that it varies.

use super::axis::Axis;
use super::error::StudyError;
use super::identity;
use crate::scene::{ErrorKind, Place, Reference, Scene};
use std::path::{Path, PathBuf};

/// What a study is asked for.
#[derive(Debug, Clone, Default)]
pub struct Request {
    /// Scene file.
    pub scene: PathBuf,
    /// `--set` arguments, for all runs.
    pub overrides: Vec<String>,
    /// What is varied. An axis replaces that of the scene with the same key.
    pub over: Vec<Axis>,
    /// Seeds instead of the scene's; none for those of the scene.
    pub seeds: Vec<u64>,
}

/// One run of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Names the folder of the run.
    pub name: String,
    /// Values of the axes, in their order; without spacing and seed.
    pub settings: Vec<(String, String)>,
    /// Initial particle distance, m.
    pub spacing: f64,
    /// Seed of the jitter, if seeds are varied.
    pub seed: Option<u64>,
    /// All `--set` arguments.
    pub overrides: Vec<String>,
    /// All that determines the result, a line each.
    pub identity: String,
}

/// A scene and the runs of its study.
#[derive(Debug, Clone)]
pub struct Plan {
    /// The scene with the overrides of all runs.
    pub scene: Scene,
    /// What it is compared with.
    pub reference: Reference,
    /// Scene file.
    pub path: PathBuf,
    /// What is varied, without the seeds.
    pub axes: Vec<Axis>,
    /// The runs.
    pub cases: Vec<Case>,
}

/// The key of the axis along which errors should fall.
const SPACING: &str = "numerics.spacing";

/// More runs than this are a mistake.
const MOST_RUNS: usize = 10_000;

impl Plan {
    /// Reads the scene with every combination of values, so that no run can fail for a value that is
    /// wrong.
    ///
    /// # Errors
    ///
    /// A scene without reference, or that is wrong with one of the values; seeds that change nothing.
    pub fn new(request: &Request) -> Result<Self, StudyError> {
        let scene = Scene::read(&request.scene, &request.overrides)?;
        let Some(reference) = scene.reference.clone() else {
            let kind = ErrorKind::Invalid {
                what: "the scene has no [reference] to measure errors by".into(),
                help: "add a table [reference] with velocity, pressure, formula, file or finest"
                    .into(),
            };
            return Err(scene.error(Place::default(), kind).into());
        };
        let axes = axes(&scene, &request.over)?;
        let seeds = if request.seeds.is_empty() {
            scene.study.seeds.iter().map(|seed| seed.value).collect()
        } else {
            request.seeds.clone()
        };
        let fluid = scene.fluid()?;
        if let (false, None) = (seeds.is_empty(), fluid.1.jitter.filter(|jitter| **jitter > 0.0)) {
            let what = "seeds change nothing without a jitter of the fluid".to_owned();
            let help = format!("give fluid.{}.jitter, for example 0.1", fluid.0);
            return Err(StudyError::Request { what, help });
        }
        let seed_key = format!("fluid.{}.seed", fluid.0);
        let count = axes.iter().map(|axis| axis.values.len()).product::<usize>();
        if count.saturating_mul(seeds.len().max(1)) > MOST_RUNS {
            let what = format!("these are more than {MOST_RUNS} runs");
            return Err(StudyError::Request { what, help: "give fewer values".into() });
        }
        let mut cases = Vec::new();
        for number in 0..count {
            let chosen = combination(&axes, number);
            let all_seeds: Vec<Option<u64>> = if seeds.is_empty() {
                vec![None]
            } else {
                seeds.iter().copied().map(Some).collect()
            };
            for seed in all_seeds {
                cases.push(case(request, &axes, &chosen, seed, &seed_key)?);
            }
        }
        tell_apart(&mut cases);
        Ok(Self { scene, reference: reference.value, path: request.scene.clone(), axes, cases })
    }
}

/// The axes of the scene and of the command line, which has the last word.
fn axes(scene: &Scene, given: &[Axis]) -> Result<Vec<Axis>, StudyError> {
    let mut axes: Vec<Axis> = Vec::new();
    for text in &scene.study.over {
        let axis: Axis = text.parse().map_err(|reason| {
            let kind = ErrorKind::Invalid {
                what: format!("\"{}\" cannot be varied", **text),
                help: reason,
            };
            scene.error(text.place, kind)
        })?;
        axes.push(axis);
    }
    for axis in given {
        match axes.iter_mut().find(|other| other.key == axis.key) {
            Some(other) => *other = axis.clone(),
            None => axes.push(axis.clone()),
        }
    }
    Ok(axes)
}

/// Combination `number` of the values, the last axis running fastest.
fn combination(axes: &[Axis], number: usize) -> Vec<String> {
    let mut rest = number;
    let mut chosen: Vec<String> = Vec::with_capacity(axes.len());
    for axis in axes.iter().rev() {
        chosen.push(axis.values[rest % axis.values.len()].clone());
        rest /= axis.values.len();
    }
    chosen.reverse();
    chosen
}

fn case(
    request: &Request,
    axes: &[Axis],
    chosen: &[String],
    seed: Option<u64>,
    seed_key: &str,
) -> Result<Case, StudyError> {
    let mut overrides = request.overrides.clone();
    let mut settings = Vec::new();
    let mut names = Vec::new();
    for (axis, value) in axes.iter().zip(chosen) {
        overrides.push(format!("{}={value}", axis.key));
        let alone = axes.iter().filter(|other| other.short() == axis.short()).count() == 1;
        let title = if alone { axis.short() } else { &axis.key };
        names.push(format!("{title}-{value}"));
        if axis.key != SPACING {
            settings.push((title.to_owned(), value.clone()));
        }
    }
    if let Some(seed) = seed {
        overrides.push(format!("{seed_key}={seed}"));
        names.push(format!("seed-{seed}"));
    }
    let scene = Scene::read(&request.scene, &overrides)?;
    Ok(Case {
        name: file_name(&names),
        settings,
        spacing: *scene.numerics.spacing,
        seed,
        identity: identity::of(&scene),
        overrides,
    })
}

/// Numbers names that are alike: letters that no file system takes may be all that differs.
fn tell_apart(cases: &mut [Case]) {
    for i in 1..cases.len() {
        let (before, rest) = cases.split_at_mut(i);
        let taken = |name: &str| before.iter().any(|case| case.name == name);
        let name = rest[0].name.clone();
        let mut number = 2;
        while taken(&rest[0].name) {
            rest[0].name = format!("{name}-{number}");
            number += 1;
        }
    }
}

/// Longest name of a folder; file systems take 255 bytes, and files beside it are named after it.
const LONGEST_NAME: usize = 100;

/// A name for the folder of a run, of letters that every file system takes.
fn file_name(parts: &[String]) -> String {
    if parts.is_empty() {
        return "run".into();
    }
    let fits = |c: char| if c.is_alphanumeric() || "-.+".contains(c) { c } else { '_' };
    parts.join("_").chars().map(fits).take(LONGEST_NAME).collect()
}

impl Case {
    /// Folder of the results of the run in that of the study.
    pub fn folder(&self, study: &Path) -> PathBuf {
        study.join("runs").join(&self.name)
    }

    /// The values of the axes without spacing and seed, in words.
    pub fn label(&self) -> String {
        let words = self.settings.iter().map(|(key, value)| format!("{key} = {value}"));
        words.collect::<Vec<_>>().join(", ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_combinations_are_made() {
        let axes: Vec<Axis> =
            ["a=1,2", "b=x,y,z"].iter().map(|text| text.parse().unwrap()).collect();
        let all: Vec<String> = (0..6).map(|n| combination(&axes, n).concat()).collect();
        assert_eq!(all, ["1x", "1y", "1z", "2x", "2y", "2z"]);
        assert_eq!(combination(&[], 0), Vec::<String>::new());
    }

    #[test]
    fn names_that_are_alike_are_numbered() {
        let case = |name: &str| Case {
            name: name.into(),
            settings: vec![],
            spacing: 1.0,
            seed: None,
            overrides: vec![],
            identity: String::new(),
        };
        let mut cases = ["a", "b", "a", "a-2", "a"].map(case);
        tell_apart(&mut cases);
        let names = cases.map(|case| case.name);
        assert_eq!(names, ["a", "b", "a-2", "a-2-2", "a-3"]);
    }

    #[test]
    fn names_are_names_of_files() {
        let name = file_name(&["spacing-0.02".into(), "v-[\"x/2\", 1]".into()]);
        assert_eq!(name, "spacing-0.02_v-__x_2___1_");
    }
}
