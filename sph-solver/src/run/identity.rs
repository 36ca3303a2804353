//! What a run is, in the words of its scene: what a resumed run must share with the run that it
//! continues, and what it may change.

use super::digest::Digest;
use crate::scene::{Pressure, Probe, Scene, Scheme};
use crate::setup::Particles;

/// Keys of a scene with their values, one a line.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Values(Vec<(String, String)>);

/// A run in two lists of values, both kept in its checkpoints.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Identity {
    /// What determines the particles and their state. A checkpoint is continued only by a run with the
    /// same.
    pub particles: Values,
    /// What leaves the particles alone, so that it may change when a run goes on.
    pub settings: Values,
}

impl Values {
    fn set(&mut self, key: impl Into<String>, value: &impl ToString) {
        // A line each, whatever the scene holds.
        let value = value.to_string().split_whitespace().collect::<Vec<_>>().join(" ");
        self.0.push((key.into(), value));
    }

    /// As text, a line for each.
    pub fn to_text(&self) -> String {
        self.0.iter().map(|(key, value)| format!("{key} = {value}\n")).collect()
    }

    /// Back from [`to_text`](Self::to_text).
    pub fn from_text(text: &str) -> Self {
        let pair = |line: &str| line.split_once(" = ").map(|(k, v)| (k.into(), v.into()));
        Self(text.lines().filter_map(pair).collect())
    }

    /// Where these differ from `before`, in words.
    pub fn changes_from(&self, before: &Self) -> Vec<String> {
        let find = |values: &Self, key: &str| {
            values.0.iter().find(|(other, _)| other == key).map(|(_, value)| value.clone())
        };
        let gone = before.0.iter().filter(|(key, _)| find(self, key).is_none());
        let keys = self.0.iter().chain(gone).map(|(key, _)| key);
        let change = |key: &String| match (find(self, key), find(before, key)) {
            (now, then) if now == then => None,
            (Some(_), Some(_)) if key.starts_with("places") => Some(format!("{key} differ")),
            (now, then) => {
                let word = |value: Option<String>| value.unwrap_or_else(|| "not set".into());
                Some(format!("{key} is {} and was {}", word(now), word(then)))
            }
        };
        keys.filter_map(change).collect()
    }
}

impl Identity {
    /// Of a run of `scene` that ends at `end_time` (s) with `checkpoints` so often (s).
    ///
    /// The particles are known by their places. Their first densities and velocities follow from the
    /// scene by functions whose last bits differ between machines, and count as the scene has them.
    pub fn new<const D: usize>(
        scene: &Scene,
        all: &Particles<D>,
        end_time: f64,
        checkpoints: Option<f64>,
    ) -> Self {
        Self { particles: particles(scene, all), settings: settings(scene, end_time, checkpoints) }
    }
}

fn particles<const D: usize>(scene: &Scene, all: &Particles<D>) -> Values {
    let numerics = &scene.numerics;
    let mut values = Values::default();
    values.set("dimension", &D);
    values.set("gravity", &format!("{:?}", scene.gravity::<D>()));
    if let Some(domain) = &scene.domain {
        values.set("domain", &format!("{:?} to {:?}", *domain.min, *domain.max));
    }
    values.set("periodic", &format!("{:?}", scene.periodic_axes::<D>()));
    values.set("numerics.spacing", &*numerics.spacing);
    values.set("numerics.support", &*numerics.support);
    values.set("numerics.scheme", &word(&numerics.scheme));
    values.set("numerics.kernel", &word(&numerics.kernel));
    values.set("numerics.precision", &word(&numerics.precision));
    values.set("numerics.sound_speed", &word(&numerics.sound_speed.value));
    values.set("numerics.equation_of_state", &word(&numerics.equation_of_state));
    for (name, fluid) in &scene.fluid {
        let path = format!("fluid.{name}");
        values.set(format!("{path}.density"), &*fluid.density);
        let mut fields = |path: &str, velocity: Option<String>, pressure: Option<&Pressure>| {
            if let Some(velocity) = velocity {
                values.set(format!("{path}.velocity"), &velocity);
            }
            match pressure {
                Some(Pressure::Hydrostatic) => {
                    values.set(format!("{path}.pressure"), &"hydrostatic");
                }
                Some(Pressure::Formula(formula)) => {
                    values.set(format!("{path}.pressure"), &formula.text());
                }
                None => (),
            }
        };
        let texts = |velocity: &[crate::scene::At<crate::scene::Formula>]| {
            velocity.iter().map(|formula| formula.text().to_owned()).collect::<Vec<_>>().join(", ")
        };
        let velocity = fluid.velocity.as_ref().map(|velocity| texts(velocity));
        fields(&path, velocity, Some(&fluid.pressure.value));
        for (index, region) in fluid.regions.iter().enumerate() {
            let velocity = region.velocity.as_ref().map(|velocity| texts(velocity));
            let pressure = region.pressure.as_ref().map(|pressure| &pressure.value);
            fields(&format!("{path}.regions.{index}"), velocity, pressure);
        }
    }
    for solid in &scene.solid {
        let path = format!("solid {}", *solid.name);
        if let Some(motion) = &solid.motion {
            values.set(format!("{path}.motion"), &word(&motion.value));
        }
        if let Some(body) = &solid.body {
            values.set(format!("{path}.body"), &word(&body.value));
        }
    }
    values.set("number of particles of the fluid", &all.of_kind(0).len());
    for (solid, kind) in scene.solid.iter().zip(1..) {
        values
            .set(format!("number of particles of solid {}", *solid.name), &all.of_kind(kind).len());
    }
    let mut digest = Digest::default();
    for (i, x) in all.position.iter().enumerate() {
        digest.add(i as u64, x.iter().copied().chain([f64::from(all.kind[i])]));
    }
    values.set("places of the particles", &digest);
    values
}

fn settings(scene: &Scene, end_time: f64, checkpoints: Option<f64>) -> Values {
    let numerics = &scene.numerics;
    let mut values = Values::default();
    values.set("end_time", &end_time);
    values.set("numerics.cfl", &*numerics.cfl);
    let alpha = scene.artificial_viscosity();
    match (numerics.scheme, &numerics.artificial_viscosity) {
        (Scheme::Auto, None) => values.set("numerics.artificial_viscosity", &"auto"),
        _ => values.set("numerics.artificial_viscosity", &alpha),
    }
    values.set("numerics.density_diffusion", &*numerics.density_diffusion);
    values.set("numerics.skin", &*numerics.skin);
    values.set("numerics.on_lost", &word(&numerics.on_lost));
    for (name, fluid) in &scene.fluid {
        values.set(
            format!("fluid.{name}.viscosity"),
            &fluid.viscosity.as_deref().copied().unwrap_or(0.0),
        );
        let lowest = fluid.cavitation_pressure.as_deref().copied().unwrap_or(f64::NEG_INFINITY);
        values.set(format!("fluid.{name}.cavitation_pressure"), &lowest);
    }
    for solid in &scene.solid {
        let friction = solid.wall_friction.as_ref().map(|friction| word(&friction.value));
        let path = format!("solid {}.wall_friction", *solid.name);
        values.set(path, &friction.unwrap_or_else(|| "as the fluid".into()));
    }
    let output = &scene.output;
    let mut interval = |key: &str, seconds: Option<f64>| {
        if let Some(seconds) = seconds {
            values.set(key, &seconds);
        }
    };
    interval("output.snapshots", output.snapshots.as_deref().copied());
    interval("output.energies", output.energies.as_deref().copied());
    interval("output.checkpoint_every", checkpoints);
    if output.energy_budget {
        values.set("output.energy_budget", &true);
    }
    if let Some(fields) = &output.fields {
        values.set("output.fields", &fields.iter().map(word).collect::<Vec<_>>().join(", "));
    }
    if let Some(region) = &output.region {
        values.set("output.region", &format!("{:?} to {:?}", *region.min, *region.max));
    }
    if let Some(every) = &output.every_nth {
        values.set("output.every_nth", &**every);
    }
    values.set("output.positions", &word(&output.positions));
    values.set("output.compression", &word(&output.compression));
    for probe in &scene.probe {
        values.set(format!("probe {}", *probe.name), &describe(probe));
    }
    values
}

fn describe(probe: &Probe) -> String {
    let mut text = format!("a {}", probe.kind.name());
    let mut add = |name: &str, value: Option<String>| {
        if let Some(value) = value {
            text += &format!(", {name} {value}");
        }
    };
    add("at", probe.at.as_deref().map(|at| format!("{at:?}")));
    add("fields", probe.fields.as_deref().map(|fields| format!("{fields:?}")));
    add("axis", probe.axis.as_deref().map(|axis| format!("{axis:?}")));
    add("radius", probe.radius.as_deref().map(|radius| format!("{radius}")));
    add("normal", probe.normal.as_deref().map(|normal| format!("{normal:?}")));
    text
}

/// A choice as the scene writes it.
fn word(choice: &impl serde::Serialize) -> String {
    let text = serde_json::to_string(choice).unwrap_or_default();
    text.trim_matches('"').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::setup::Setup;

    const SCENE: &str = "dimension = 2\nend_time = 1\ngravity = [0, -9.81]\n\
        [numerics]\nspacing = 0.1\n\
        [fluid.water]\ndensity = 1000\npressure = \"hydrostatic\"\n\
        regions = [{ box = { min = [0, 0], max = [1, 1] } }]\n";

    fn identity(changes: &[&str]) -> Identity {
        let changes: Vec<String> = changes.iter().map(ToString::to_string).collect();
        let scene = Scene::parse("a.toml", SCENE.into(), &changes).unwrap();
        let setup = Setup::<2>::new(&scene).unwrap();
        Identity::new(&scene, &setup.particles, *scene.end_time, None)
    }

    #[test]
    fn values_survive_a_checkpoint() {
        let Identity { particles, settings } =
            identity(&["fluid.water.velocity=[\"x  *  y\", \"0\"]"]);
        for values in [particles, settings] {
            assert_eq!(Values::from_text(&values.to_text()), values);
        }
    }

    #[test]
    fn changes_are_named_by_their_keys() {
        let before = identity(&[]);
        for (change, words) in [
            ("numerics.spacing=0.05", "numerics.spacing is 0.05 and was 0.1"),
            ("gravity=[0, -1]", "gravity is [0.0, -1.0] and was [0.0, -9.81]"),
            ("numerics.precision=double", "numerics.precision is double and was mixed"),
            ("fluid.water.pressure=0", "fluid.water.pressure is 0 and was hydrostatic"),
            ("fluid.water.regions.0.box.min=[0.5, 0.5]", "places of the particles differ"),
        ] {
            let now = identity(&[change]);
            let changes = now.particles.changes_from(&before.particles);
            assert!(changes.iter().any(|change| change == words), "{change}: {changes:?}");
        }
        for (change, words) in [
            ("numerics.cfl=0.5", "numerics.cfl is 0.5 and was 1"),
            ("numerics.on_lost=remove", "numerics.on_lost is remove and was stop"),
            ("output.energies=0.5", "output.energies is 0.5 and was not set"),
            ("fluid.water.viscosity=1", "fluid.water.viscosity is 1 and was 0"),
        ] {
            let now = identity(&[change]);
            assert_eq!(now.particles, before.particles, "{change}");
            let changes = now.settings.changes_from(&before.settings);
            assert!(changes.iter().any(|change| change == words), "{change}: {changes:?}");
            assert!(before.settings.changes_from(&now.settings).len() == changes.len());
        }
    }
}
