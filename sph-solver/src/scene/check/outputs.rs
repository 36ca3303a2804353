//! Checks of `[[probe]]` and `[output]`.

use super::values::Values;
use crate::scene::document::Place;
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
            ProbeKind::Point => point(values, &path, probe)?,
            ProbeKind::Front => front(values, probe)?,
        }
    }
    Ok(())
}

fn point(values: &Values<'_>, path: &str, probe: &At<Probe>) -> Result<(), SceneError> {
    let name = &*probe.name;
    let at = needed(values, probe, "at", probe.at.as_ref(), "for example at = [0.8, 0.1]")?;
    values.components(&format!("{path}.at"), at)?;
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
    not_for(values, probe, "axis", probe.axis.as_ref().map(|axis| axis.place))
}

fn front(values: &Values<'_>, probe: &At<Probe>) -> Result<(), SceneError> {
    let axis = needed(values, probe, "axis", probe.axis.as_ref(), "for example axis = \"x\"")?;
    if axis.index() >= values.scene.dimension() {
        let what = format!("probe `{}` looks along z in a scene with dimension = 2", *probe.name);
        return Err(values.invalid(axis.place, what, "use \"x\" or \"y\""));
    }
    not_for(values, probe, "at", probe.at.as_ref().map(|at| at.place))?;
    not_for(values, probe, "fields", probe.fields.as_ref().map(|fields| fields.place))
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

fn not_for(
    values: &Values<'_>,
    probe: &At<Probe>,
    key: &str,
    place: Option<Place>,
) -> Result<(), SceneError> {
    let Some(place) = place else { return Ok(()) };
    let kind = match probe.kind {
        ProbeKind::Point => "point",
        ProbeKind::Front => "front",
    };
    let what = format!("probe `{}` is a {kind} probe, which has no `{key}`", *probe.name);
    Err(values.invalid(place, what, "remove the key or change `kind`"))
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
    Ok(())
}
