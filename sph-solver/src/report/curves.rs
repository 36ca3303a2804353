//! Which columns of which tables are drawn together.

use super::plot::{Line, Plot};
use super::results::Results;
use sph_io::Table;
use std::collections::BTreeSet;

/// Columns of a table that share an axis.
struct Group {
    title: String,
    unit: String,
    /// Name in the legend and values over time.
    columns: Vec<(String, Vec<f64>)>,
}

/// The curves of one run, or of several, one over the other. With several, each quantity has a plot
/// of its own, and colours tell the runs apart.
pub fn plots(runs: &[Results]) -> Vec<Plot> {
    let names: BTreeSet<(u8, &str)> = runs
        .iter()
        .flat_map(|run| run.tables.iter().map(|(name, _)| (rank(name), name.as_str())))
        .collect();
    names.into_iter().flat_map(|(_, name)| of_table(runs, name)).collect()
}

/// Probes that met no fluid, so that they have no curve: name and run.
pub fn dry_probes<'a>(runs: &'a [Results]) -> Vec<(&'a str, &'a Results)> {
    let of_run = |run: &'a Results| {
        run.tables.iter().filter_map(move |(name, table)| {
            let probe = name.strip_prefix("probe-")?;
            (!table.rows.is_empty() && groups(name, table).is_empty()).then_some((probe, run))
        })
    };
    runs.iter().flat_map(of_run).collect()
}

/// Loads come first, energies last.
fn rank(name: &str) -> u8 {
    match name {
        name if name.starts_with("solid-") => 0,
        name if name.starts_with("probe-") => 1,
        _ => 2,
    }
}

fn of_table(runs: &[Results], name: &str) -> Vec<Plot> {
    if let [run] = runs {
        let table = run.tables.iter().find(|(known, _)| known == name);
        let Some((_, table)) = table else { return Vec::new() };
        let time = table.column("time").unwrap_or_default();
        let plot = |group: Group| {
            let line = |(name, values)| Line { name, time: time.clone(), values };
            Plot {
                title: group.title,
                unit: group.unit,
                lines: group.columns.into_iter().map(line).collect(),
            }
        };
        return groups(name, table).into_iter().map(plot).collect();
    }
    let mut plots: Vec<Plot> = Vec::new();
    for run in runs {
        let Some((_, table)) = run.tables.iter().find(|(known, _)| known == name) else { continue };
        let time = table.column("time").unwrap_or_default();
        for group in groups(name, table) {
            for (column, values) in group.columns {
                let title = if column == group.title {
                    column
                } else {
                    format!("{}: {column}", group.title)
                };
                let line = Line { name: run.label.clone(), time: time.clone(), values };
                match plots.iter_mut().find(|plot| plot.title == title && plot.unit == group.unit) {
                    Some(plot) => plot.lines.push(line),
                    None => plots.push(Plot { title, unit: group.unit.clone(), lines: vec![line] }),
                }
            }
        }
    }
    plots
}

fn groups(name: &str, table: &Table) -> Vec<Group> {
    let groups = if name == "energies" {
        energies(table)
    } else if let Some(solid) = name.strip_prefix("solid-") {
        loads(solid, table)
    } else if let Some(probe) = name.strip_prefix("probe-") {
        readings(probe, table)
    } else {
        Vec::new()
    };
    let has_numbers = |(_, values): &(String, Vec<f64>)| values.iter().any(|v| v.is_finite());
    groups
        .into_iter()
        .map(|group| Group {
            columns: group.columns.into_iter().filter(has_numbers).collect(),
            ..group
        })
        .filter(|group| !group.columns.is_empty())
        .collect()
}

/// The columns of these names, as far as they are there; the legend leaves out `prefix`.
fn group(table: &Table, title: String, prefix: &str, names: &[&str]) -> Group {
    let there = |name: &&&str| table.names.iter().any(|known| known == **name);
    let names: Vec<&str> = names.iter().filter(there).copied().collect();
    let unit = names.first().map_or_else(String::new, |name| unit(table, name));
    let columns = names.iter().map(|name| {
        let words = name.strip_prefix(prefix).unwrap_or(name).replace('_', " ");
        (words, table.column(name).unwrap_or_default())
    });
    Group { title, unit, columns: columns.collect() }
}

fn unit(table: &Table, name: &str) -> String {
    let place = table.names.iter().position(|known| known == name);
    place.and_then(|place| table.units.get(place)).cloned().unwrap_or_default()
}

const MEAN_FORCES: [&str; 3] = ["mean_force_x", "mean_force_y", "mean_force_z"];
const MEAN_MOMENTS: [&str; 3] = ["mean_moment_x", "mean_moment_y", "mean_moment_z"];
/// What the tables of solids that move have besides: title, what the legend leaves out, columns.
const MOTION: [(&str, &str, [&str; 3]); 5] = [
    ("Place", "", ["x", "y", "z"]),
    ("Velocity", "velocity_", ["velocity_x", "velocity_y", "velocity_z"]),
    ("Acceleration", "acceleration_", ["acceleration_x", "acceleration_y", "acceleration_z"]),
    ("Rotation", "rotation_", ["rotation_x", "rotation_y", "rotation_z"]),
    ("Spin", "spin_", ["spin_x", "spin_y", "spin_z"]),
];
const FRICTION: [&str; 3] = ["friction_force_x", "friction_force_y", "friction_force_z"];

fn loads(solid: &str, table: &Table) -> Vec<Group> {
    let mut groups = vec![
        group(table, format!("Force on {solid}, mean between rows"), "mean_force_", &MEAN_FORCES),
        group(table, format!("Largest force on {solid} between rows"), "", &["largest_force"]),
        group(
            table,
            format!("Moment on {solid}, mean between rows"),
            "mean_moment_",
            &MEAN_MOMENTS,
        ),
    ];
    let friction = group(table, format!("Friction on {solid}"), "friction_force_", &FRICTION);
    // Slip walls have none.
    if friction.columns.iter().any(|(_, values)| values.iter().any(|v| *v != 0.0)) {
        groups.push(friction);
    }
    let motion = |(title, prefix, names): (&str, &str, [&str; 3])| {
        group(table, format!("{title} of {solid}"), prefix, &names)
    };
    groups.extend(MOTION.map(motion));
    groups
}

fn readings(probe: &str, table: &Table) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    for (name, unit) in table.names.iter().zip(&table.units).skip(1) {
        // Where there is no fluid there is no reading, and a gap in the curve.
        if name == "wet" {
            continue;
        }
        let column = (name.replace('_', " "), table.column(name).unwrap_or_default());
        match groups.iter_mut().find(|group| group.unit == *unit) {
            Some(group) => group.columns.push(column),
            None => groups.push(Group {
                title: format!("Probe {probe}"),
                unit: unit.clone(),
                columns: vec![column],
            }),
        }
    }
    for group in &mut groups {
        if let [(name, _)] = &group.columns[..] {
            group.title = format!("{}: {name}", group.title);
            group.columns[0].0.clone_from(&group.title);
        }
    }
    groups
}

/// What terms took, as far as they took anything, and what no term explains.
fn budget(table: &Table) -> Group {
    let sinks = table.names.iter().filter(|name| name.starts_with("to_"));
    let names: Vec<&str> = sinks.map(String::as_str).chain(["residual"]).collect();
    let mut group = group(table, "Where energy went since the start".into(), "to_", &names);
    group.columns.retain(|(name, values)| name == "residual" || values.iter().any(|v| *v != 0.0));
    group
}

fn energies(table: &Table) -> Vec<Group> {
    let since_start = |name: &str| {
        let values = table.column(name).unwrap_or_default();
        let first = values.first().copied().unwrap_or(0.0);
        values.into_iter().map(|value| value - first).collect::<Vec<f64>>()
    };
    let names = ["kinetic", "potential", "elastic"];
    let mut columns: Vec<(String, Vec<f64>)> =
        names.iter().map(|name| ((*name).to_owned(), since_start(name))).collect();
    let rows = table.rows.len();
    columns.retain(|(_, values)| values.len() == rows);
    let sum = (0..rows).map(|row| columns.iter().map(|(_, values)| values[row]).sum()).collect();
    columns.push(("sum".into(), sum));
    let momentum = ["momentum_x", "momentum_y", "momentum_z"];
    let title = "Energies, change since the start".into();
    vec![
        Group { title, unit: unit(table, "kinetic"), columns },
        budget(table),
        group(table, "Momentum".into(), "momentum_", &momentum),
        group(table, "Largest compression".into(), "", &["compression"]),
        group(table, "Largest speed".into(), "", &["speed"]),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(titles: &[(&str, &str)], rows: &[&[f64]]) -> Table {
        let (names, units) =
            titles.iter().map(|(name, unit)| ((*name).to_owned(), (*unit).to_owned())).unzip();
        Table { names, units, rows: rows.iter().map(|row| row.to_vec()).collect() }
    }

    #[test]
    fn columns_of_one_unit_share_an_axis() {
        let titles =
            [("time", "s"), ("pressure", "Pa"), ("vx", "m/s"), ("vy", "m/s"), ("wet", "1")];
        let table = table(&titles, &[&[0.0, 1.0, 2.0, 3.0, 1.0], &[0.1, f64::NAN, 2.0, 3.0, 0.0]]);
        let groups = groups("probe-P", &table);
        let units: Vec<_> = groups.iter().map(|g| (g.unit.as_str(), g.columns.len())).collect();
        assert_eq!(units, [("Pa", 1), ("m/s", 2)]);
        assert_eq!(groups[0].title, "Probe P: pressure");
    }

    #[test]
    fn a_solid_that_moves_has_curves_of_its_motion() {
        let titles = [("time", "s"), ("x", "m"), ("y", "m"), ("spin_z", "rad/s")];
        let table = table(&titles, &[&[0.0, 1.0, 2.0, 3.0]]);
        let groups = groups("solid-box", &table);
        let titles: Vec<_> = groups.iter().map(|g| (g.title.as_str(), g.columns.len())).collect();
        assert_eq!(titles, [("Place of box", 2), ("Spin of box", 1)]);
    }

    #[test]
    fn energies_are_counted_from_the_start_and_add_up() {
        let titles = [("time", "s"), ("kinetic", "J"), ("potential", "J"), ("elastic", "J")];
        let table = table(&titles, &[&[0.0, 0.0, 100.0, 1.0], &[0.1, 8.0, 90.0, 1.5]]);
        let energies = &groups("energies", &table)[0];
        let last: Vec<_> = energies.columns.iter().map(|(n, v)| (n.as_str(), v[1])).collect();
        assert_eq!(last, [("kinetic", 8.0), ("potential", -10.0), ("elastic", 0.5), ("sum", -1.5)]);
    }

    #[test]
    fn a_budget_shows_the_terms_that_took_something() {
        let titles = [("time", "s"), ("to_viscosity", "J"), ("to_spray", "J"), ("residual", "J")];
        let with = table(&titles, &[&[0.0, 0.0, 0.0, 0.0], &[0.1, 8.0, 0.0, 0.0]]);
        let groups = groups("energies", &with);
        let budget = groups.iter().find(|g| g.title.starts_with("Where")).unwrap();
        let names: Vec<_> = budget.columns.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!((names, budget.unit.as_str()), (vec!["viscosity", "residual"], "J"));
        let without = table(&[("time", "s"), ("kinetic", "J")], &[&[0.0, 1.0]]);
        assert!(super::groups("energies", &without).iter().all(|g| !g.title.starts_with("Where")));
    }

    #[test]
    fn a_probe_that_was_always_dry_has_no_curve() {
        let table = table(&[("time", "s"), ("pressure", "Pa")], &[&[0.0, f64::NAN]]);
        assert!(groups("probe-P", &table).is_empty());
    }
}
