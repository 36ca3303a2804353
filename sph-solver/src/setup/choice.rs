//! `scheme = "auto"`: the scheme and the artificial viscosity that suit what a scene holds.
//!
//! Which suits what was measured: `docs/results/defaults.md`.

use crate::scene::{Scene, Scheme};
use serde::Serialize;
use sph_geometry::{Aabb, Solid, depth_in_solids};
use std::collections::HashSet;

/// What kind of flow a scene begins with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// No free surface.
    Closed,
    /// A free surface, and the fluid rests on something.
    Gentle,
    /// A free surface, and the fluid collapses, falls or hits.
    Violent,
}

/// The scheme of a run, and why.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SchemeChoice {
    /// The scheme.
    pub scheme: Scheme,
    /// Artificial viscosity α; 0 for none.
    pub artificial_viscosity: f64,
    /// What kind of flow it was chosen for, if the scene left the choice open.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub kind: Option<Kind>,
    /// Why, in words, if the scene left the choice open.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

/// The fluid at the start, as far as the choice depends on it.
#[derive(Debug, Clone, Copy)]
pub struct Beginning<'a, const D: usize> {
    /// Whether it fills all the space that it can be in.
    pub closed: bool,
    /// Largest speed of fluid and solids, m/s.
    pub speed: f64,
    /// Gravity, m/s².
    pub gravity: &'a [f64; D],
    /// Extent along gravity, m.
    pub height: f64,
    /// Positions of the particles, m.
    pub position: &'a [[f64; D]],
    /// Distance of the particles, m.
    pub spacing: f64,
    /// All solids.
    pub solids: &'a [Solid<D>],
    /// Axes that repeat.
    pub periodic: [bool; D],
}

/// From this Froude number U/√(g H) on, fluid or a solid hits rather than flows.
const VIOLENT: f64 = 1.0;

/// A side of fluid is held by nothing if this many particles lie above it.
const DEEP: i32 = 3;

/// Nothing holds the fluid if such sides are larger than this share of its cross-section.
const EXPOSED: f64 = 0.1;

impl SchemeChoice {
    /// What the scene says.
    pub fn given(scene: &Scene) -> Self {
        let (scheme, artificial_viscosity) = (scene.numerics.scheme, scene.artificial_viscosity());
        Self { scheme, artificial_viscosity, kind: None, reason: None }
    }

    /// What suits the scene. An artificial viscosity that the scene gives stays.
    pub fn made<const D: usize>(scene: &Scene, beginning: &Beginning<'_, D>) -> Self {
        let (kind, reason) = beginning.kind();
        let (scheme, alpha) = match kind {
            Kind::Closed => (Scheme::DeltaPlus, 0.0),
            Kind::Gentle => (Scheme::Delta, 0.005),
            Kind::Violent => (Scheme::Delta, 0.0),
        };
        let given = scene.numerics.artificial_viscosity.as_deref().copied();
        let usual = if scene.viscosity().is_some() { 0.0 } else { alpha };
        Self {
            scheme,
            artificial_viscosity: given.unwrap_or(usual),
            kind: Some(kind),
            reason: Some(reason),
        }
    }

    /// The choice in one sentence, if there was one.
    pub fn note(&self) -> Option<String> {
        let reason = self.reason.as_ref()?;
        let scheme = match self.scheme {
            Scheme::DeltaPlus => "delta-plus",
            _ => "delta",
        };
        let alpha = self.artificial_viscosity;
        Some(format!(
            "scheme \"auto\" is \"{scheme}\" with artificial_viscosity = {alpha}: {reason}"
        ))
    }
}

impl<const D: usize> Beginning<'_, D> {
    fn kind(&self) -> (Kind, String) {
        if self.closed {
            return (Kind::Closed, "the fluid fills all its space and has no free surface".into());
        }
        let gravity = self.gravity.iter().map(|g| g * g).sum::<f64>().sqrt();
        if gravity == 0.0 {
            return (Kind::Violent, "the fluid has a free surface and nothing holds it".into());
        }
        let froude = self.speed / (gravity * self.height).sqrt();
        if froude >= VIOLENT {
            let reason = format!(
                "the fluid has a free surface and {:.3} m/s at the start, a Froude number of {froude:.2}",
                self.speed
            );
            return (Kind::Violent, reason);
        }
        let exposed = self.exposed_share();
        if exposed > EXPOSED {
            let reason = format!(
                "the fluid has a free surface and sides that nothing holds, {:.0} % of its cross-section",
                100.0 * exposed
            );
            return (Kind::Violent, reason);
        }
        (Kind::Gentle, "the fluid has a free surface and rests on its ground at the start".into())
    }

    /// Area of the sides across gravity that meet neither fluid nor solid, with fluid above them, relative
    /// to a cross-section of the fluid along gravity.
    fn exposed_share(&self) -> f64 {
        let (spacing, gravity) = (self.spacing, self.gravity);
        let cell = |x: &[f64; D]| x.map(|c| (c / spacing).floor() as i64);
        let fluid: HashSet<[i64; D]> = self.position.iter().map(cell).collect();
        let strongest = (0..D).max_by(|a, b| gravity[*a].abs().total_cmp(&gravity[*b].abs()));
        let vertical = strongest.unwrap_or(D - 1);
        let shifted = |x: &[f64; D], axis: usize, by: f64| {
            let mut x = *x;
            x[axis] += by;
            x
        };
        let upwards = -f64::from(DEEP) * spacing * gravity[vertical].signum();
        let mut exposed = 0.0;
        for x in self.position {
            if !fluid.contains(&cell(&shifted(x, vertical, upwards))) {
                continue;
            }
            for axis in (0..D).filter(|axis| *axis != vertical && !self.periodic[*axis]) {
                for way in [-spacing, spacing] {
                    let beside = shifted(x, axis, way);
                    let free = !fluid.contains(&cell(&beside))
                        && depth_in_solids(self.solids, &beside) <= 0.0;
                    exposed += f64::from(u8::from(free));
                }
            }
        }
        let bounds = Aabb::around(self.position);
        let side = |axis: usize| (bounds.max[axis] - bounds.min[axis]) / spacing + 1.0;
        // The largest of the cross-sections along gravity.
        let across = (0..D).filter(|axis| *axis != vertical);
        let section = match D {
            2 => side(vertical),
            _ => side(vertical) * across.map(side).fold(1.0, f64::max),
        };
        exposed / section
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::setup::Setup;

    fn chosen(text: &str, changes: &[&str]) -> SchemeChoice {
        let changes: Vec<String> = changes.iter().map(ToString::to_string).collect();
        let scene = Scene::parse("a.toml", text.into(), &changes).unwrap();
        Setup::<2>::new(&scene).unwrap().choice
    }

    const TANK: &str = "dimension = 2\nend_time = 1\ngravity = [0, -9.81]\n\
        [numerics]\nspacing = 0.05\nscheme = \"auto\"\n\
        [fluid.water]\ndensity = 1000\npressure = \"hydrostatic\"\n\
        regions = [{ box = { min = [0, 0], max = [1, 0.5] } }]\n\
        [[solid]]\nname = \"tank\"\nbox = { min = [0, 0], max = [1, 1] }\nfluid_side = \"inside\"\n";

    #[test]
    fn a_tank_is_gentle_until_its_wall_is_away() {
        let rest = chosen(TANK, &[]);
        assert_eq!((rest.kind, rest.scheme), (Some(Kind::Gentle), Scheme::Delta));
        assert!(rest.artificial_viscosity > 0.0);
        let dam = TANK.replace("max = [1, 1]", "max = [2, 1]");
        let dam = chosen(&dam, &[]);
        assert_eq!((dam.kind, dam.artificial_viscosity), (Some(Kind::Violent), 0.0));
        assert!(dam.note().unwrap().contains("sides that nothing holds"), "{dam:?}");
    }

    #[test]
    fn speed_makes_it_violent_and_a_lid_closes_it() {
        let fast = chosen(TANK, &["fluid.water.velocity=[\"0\", \"-3\"]"]);
        assert_eq!(fast.kind, Some(Kind::Violent));
        let closed = chosen(&TANK.replace("max = [1, 1]", "max = [1, 0.5]"), &[]);
        assert_eq!((closed.kind, closed.scheme), (Some(Kind::Closed), Scheme::DeltaPlus));
    }

    #[test]
    fn what_the_scene_says_stays() {
        let given = chosen(TANK, &["numerics.artificial_viscosity=0.1"]);
        assert_eq!(given.artificial_viscosity, 0.1);
        let viscous = chosen(TANK, &["fluid.water.viscosity=1"]);
        assert_eq!(viscous.artificial_viscosity, 0.0);
        let delta = chosen(TANK, &["numerics.scheme=delta"]);
        assert_eq!((delta.kind, delta.artificial_viscosity), (None, 0.02));
        assert_eq!(delta.note(), None);
    }

    #[test]
    fn without_gravity_nothing_holds_a_drop() {
        let drop = TANK.replace("gravity = [0, -9.81]\n", "").replace("\"hydrostatic\"", "0");
        let drop = chosen(&drop, &["numerics.sound_speed=10"]);
        assert_eq!(drop.kind, Some(Kind::Violent));
    }
}
