//! Checks of `[[probe]]` and `[output]`.

use super::has_gravity;
use super::values::Values;
use crate::scene::error::SceneError;
use crate::scene::located::At;
use crate::scene::probe::{Probe, ProbeKind};

pub fn probes(values: &Values<'_>) -> Result<(), SceneError> {
    let mut names = Vec::new();
    for (index, probe) in values.scene.probe.iter().enumerate() {
        let path = format!("probe.{index}");
        values.file_name(&format!("{path}.name"), &probe.name)?;
        values.unique("probe", &probe.name, &mut names)?;
        match probe.kind {
            ProbeKind::Point => {
                at(values, &path, probe)?;
                fields(values, probe)?;
                not_for(values, probe, &["axis", "radius", "normal"])?;
            }
            ProbeKind::Patch => {
                at(values, &path, probe)?;
                fields(values, probe)?;
                radius(values, &path, probe)?;
                if probe.normal.is_some() {
                    normal(values, &path, probe)?;
                }
                not_for(values, probe, &["axis"])?;
            }
            ProbeKind::Level => {
                at(values, &path, probe)?;
                not_for(values, probe, &["axis", "radius", "normal", "fields"])?;
                if !has_gravity(values.scene) {
                    let what = format!("probe `{}` looks for a level without gravity", *probe.name);
                    return Err(values.invalid(probe.place, what, "add `gravity` to the scene"));
                }
            }
            ProbeKind::Flow => {
                at(values, &path, probe)?;
                normal(values, &path, probe)?;
                not_for(values, probe, &["axis", "radius", "fields"])?;
            }
            ProbeKind::Front => front(values, probe)?,
        }
    }
    Ok(())
}

fn at(values: &Values<'_>, path: &str, probe: &At<Probe>) -> Result<(), SceneError> {
    let at = needed(values, probe, "at", probe.at.as_ref(), "for example at = [0.8, 0.1]")?;
    values.components(&format!("{path}.at"), at)
}

/// More spacings than this from the middle of a patch to its rim are too many points to read.
const LARGEST_PATCH: f64 = 50.0;

fn radius(values: &Values<'_>, path: &str, probe: &At<Probe>) -> Result<(), SceneError> {
    let help = "in metres, half the diameter of the sensor";
    let radius = needed(values, probe, "radius", probe.radius.as_ref(), help)?;
    let key = format!("{path}.radius");
    values.positive(&key, radius, help)?;
    if **radius > LARGEST_PATCH * *values.scene.numerics.spacing {
        let range = "at most 50 times numerics.spacing";
        return Err(values.out_of_range(radius.place, &key, range, **radius, help));
    }
    Ok(())
}

fn normal(values: &Values<'_>, path: &str, probe: &At<Probe>) -> Result<(), SceneError> {
    let help = "for example normal = [1, 0]";
    let normal = needed(values, probe, "normal", probe.normal.as_ref(), help)?;
    values.components(&format!("{path}.normal"), normal)?;
    if normal.iter().all(|n| *n == 0.0) {
        let what = format!("`{path}.normal` has no direction");
        return Err(values.invalid(normal.place, what, help));
    }
    Ok(())
}

fn fields(values: &Values<'_>, probe: &At<Probe>) -> Result<(), SceneError> {
    let name = &*probe.name;
    let help = "for example fields = [\"pressure\"]";
    let fields = needed(values, probe, "fields", probe.fields.as_ref(), help)?;
    if fields.is_empty() {
        return Err(values.invalid(fields.place, format!("probe `{name}` has no fields"), help));
    }
    for (index, field) in fields.iter().enumerate() {
        if fields[..index].contains(field) {
            let what = format!("probe `{name}` names a field twice");
            return Err(values.invalid(fields.place, what, "name each field once"));
        }
    }
    Ok(())
}

fn front(values: &Values<'_>, probe: &At<Probe>) -> Result<(), SceneError> {
    let axis = needed(values, probe, "axis", probe.axis.as_ref(), "for example axis = \"x\"")?;
    if axis.index() >= values.scene.dimension() {
        let what = format!("probe `{}` looks along z in a scene with dimension = 2", *probe.name);
        return Err(values.invalid(axis.place, what, "use \"x\" or \"y\""));
    }
    not_for(values, probe, &["at", "fields", "radius", "normal"])
}

fn needed<'a, T>(
    values: &Values<'_>,
    probe: &At<Probe>,
    key: &str,
    value: Option<&'a At<T>>,
    help: &str,
) -> Result<&'a At<T>, SceneError> {
    value.ok_or_else(|| {
        let what = format!("probe `{}` lacks the key `{key}`", *probe.name);
        values.invalid(probe.place, what, help)
    })
}

/// Refuses keys that mean nothing to this kind of probe.
fn not_for(values: &Values<'_>, probe: &At<Probe>, keys: &[&str]) -> Result<(), SceneError> {
    let given = [
        ("at", probe.at.as_ref().map(|at| at.place)),
        ("fields", probe.fields.as_ref().map(|fields| fields.place)),
        ("axis", probe.axis.as_ref().map(|axis| axis.place)),
        ("radius", probe.radius.as_ref().map(|radius| radius.place)),
        ("normal", probe.normal.as_ref().map(|normal| normal.place)),
    ];
    for (key, place) in given {
        if let Some(place) = place.filter(|_| keys.contains(&key)) {
            let kind = probe.kind.name();
            let what = format!("probe `{}` is a {kind} probe, which has no `{key}`", *probe.name);
            return Err(values.invalid(place, what, "remove the key or change `kind`"));
        }
    }
    Ok(())
}

pub fn intervals(values: &Values<'_>) -> Result<(), SceneError> {
    let output = &values.scene.output;
    for (key, interval) in [
        ("output.snapshots", &output.snapshots),
        ("output.energies", &output.energies),
        ("output.checkpoint_every", &output.checkpoint_every),
    ] {
        if let Some(interval) = interval {
            let help = "an interval in seconds; leave the key out for none";
            values.positive(key, interval, help)?;
        }
    }
    snapshots(values)
}

fn snapshots(values: &Values<'_>) -> Result<(), SceneError> {
    let output = &values.scene.output;
    if let Some(fields) = &output.fields {
        let twice = |(index, field)| fields[..index].contains(field);
        if fields.iter().enumerate().any(twice) {
            let what = "`output.fields` names a field twice".into();
            return Err(values.invalid(fields.place, what, "name each field once"));
        }
    }
    if let Some(region) = &output.region {
        values.corners("output.region", &region.min, &region.max)?;
    }
    match &output.every_nth {
        Some(every) if **every == 0 => Err(values.out_of_range(
            every.place,
            "output.every_nth",
            "1 or more",
            **every,
            "10 keeps a tenth of the particles; leave the key out for all of them",
        )),
        _ => Ok(()),
    }
}
