//! The tables of a report: key figures, where the time went, who owned what.

use super::html::escape;
use super::pictures::rounded;
use super::results::Results;
use serde_json::Value;

/// Key figures, one column per run.
pub fn key_figures(runs: &[Results]) -> String {
    let mut rows: Vec<(String, Vec<String>)> = Vec::new();
    let mut row = |name: &str, cell: &dyn Fn(&Results) -> Option<String>| {
        let cells: Vec<String> = runs.iter().map(|run| cell(run).unwrap_or_default()).collect();
        if cells.iter().any(|cell| !cell.is_empty()) {
            rows.push((name.to_owned(), cells));
        }
    };
    row("Spacing of the particles", &|run| {
        (run.record.spacing > 0.0).then(|| format!("{} m", rounded(run.record.spacing)))
    });
    row("Dimensions", &|run| run.dimension().map(|dimension| dimension.to_string()));
    row("Particles of fluid", &|run| run.number("/particles/fluid").map(grouped));
    row("Particles of walls", &|run| run.number("/particles/wall").map(grouped));
    row("Simulated time", &|run| {
        let time = run.number("/simulated_time").or_else(|| run.last_row())?;
        Some(format!("{} s", rounded(time)))
    });
    row("Steps", &|run| run.number("/steps").map(grouped));
    row("Wall-clock time", &|run| run.number("/wall_seconds").map(duration));
    row("Processor time", &|run| run.number("/cpu_seconds").map(duration));
    row("Ranks × threads", &|run| {
        let (ranks, threads) = (run.number("/ranks")?, run.number("/threads")?);
        let how = run.summary["communicator"].as_str().unwrap_or_default();
        Some(format!("{ranks} × {threads} ({how})"))
    });
    for name in solids(runs) {
        row(&format!("Largest force on {name}"), &|run| {
            let solid =
                run.summary["solids"].as_array()?.iter().find(|one| one["name"] == *name)?;
            let unit = if run.dimension() == Some(2) { "N/m" } else { "N" };
            Some(format!("{} {unit}", rounded(solid["largest_force"].as_f64()?)))
        });
    }
    row("Energy at the end: kinetic", &|run| energy(run, "kinetic"));
    row("Energy at the end: potential", &|run| energy(run, "potential"));
    row("Largest share of the energy that no term explains", &|run| {
        let share = run.number("/energy_budget/largest_residual_share")?;
        Some(format!("{} %", rounded(100.0 * share)))
    });
    row("Largest compression at the end", &|run| {
        Some(format!("{} %", rounded(100.0 * run.number("/compression")?)))
    });
    row("Particles that left the domain", &|run| run.number("/lost_particles").map(grouped));
    row("Neighbours per particle", &|run| run.number("/neighbours_per_particle").map(rounded));
    row("Particle updates", &|run| {
        Some(format!("{} million/s", rounded(run.number("/particle_updates_per_second")? / 1e6)))
    });
    row("Pair interactions", &|run| {
        Some(format!("{} million/s", rounded(run.number("/pair_interactions_per_second")? / 1e6)))
    });
    row("Precision", &|run| run.summary["precision"].as_str().map(Into::into));
    row("Digest of the final state", &|run| run.summary["state_digest"].as_str().map(Into::into));
    table(runs, &rows)
}

/// Seconds by phase, and what communication cost.
pub fn phases(runs: &[Results]) -> String {
    const PHASES: [(&str, &str, &str); 4] = [
        ("density", "Density passes", "#0072b2"),
        ("force", "Force passes", "#d55e00"),
        ("rebuild", "Rebuilds of lists", "#009e73"),
        ("output", "Output", "#e69f00"),
    ];
    let mut html = String::new();
    let ended: Vec<&Results> = runs.iter().filter(|run| run.summary.is_object()).collect();
    for run in &ended {
        let seconds =
            PHASES.map(|(key, ..)| run.number(&format!("/phases/{key}")).unwrap_or(0.0).max(0.0));
        let all = seconds.iter().sum::<f64>().max(f64::MIN_POSITIVE);
        html += "<figure class=\"phases\">";
        if runs.len() > 1 {
            html += &format!("<figcaption>{}</figcaption>", escape(&run.label));
        }
        html += "<svg viewBox=\"0 0 440 22\" role=\"img\" aria-label=\"Seconds by phase\">";
        let mut x = 0.0;
        for ((_, _, colour), seconds) in PHASES.iter().zip(seconds) {
            let width = 440.0 * seconds / all;
            html += &format!(
                "<rect x=\"{x:.1}\" y=\"0\" width=\"{width:.1}\" height=\"22\" fill=\"{colour}\"/>"
            );
            x += width;
        }
        html += "</svg><ul class=\"legend\">";
        for ((_, name, colour), seconds) in PHASES.iter().zip(seconds) {
            html += &format!(
                "<li><svg viewBox=\"0 0 28 8\"><rect width=\"28\" height=\"8\" fill=\"{colour}\"/>\
                 </svg>{name}: {} ({:.0} %)</li>",
                duration(seconds),
                100.0 * seconds / all
            );
        }
        html += "</ul></figure>\n";
    }
    if ended.iter().any(|run| run.number("/ranks").is_some_and(|ranks| ranks > 1.0)) {
        let share = |run: &Results, key: &str| {
            Some(format!("{:.1} %", 100.0 * run.number(&format!("/{key}"))?))
        };
        let mut rows: Vec<(String, Vec<String>)> = Vec::new();
        for (name, key) in [
            ("Waiting for messages in passes, of the steps", "exposed_share"),
            ("Blocking operations of rebuilds, of the steps", "collective_share"),
            ("Copies received per owned particle", "halo_redundancy"),
        ] {
            let cells = runs.iter().map(|run| share(run, key).unwrap_or_default()).collect();
            rows.push((name.into(), cells));
        }
        let imbalance = |run: &Results| run.number("/imbalance").map(rounded).unwrap_or_default();
        rows.push(("Largest over mean load".into(), runs.iter().map(imbalance).collect()));
        html += &table(runs, &rows);
    }
    html
}

/// Ranks whose parts are listed one by one.
const MOST_RANKS: usize = 32;

/// Local, inner and outer particles of each rank.
pub fn parts(runs: &[Results]) -> String {
    let mut html = String::new();
    for run in runs {
        let Some(ranks) = run.summary["local_inner_outer"].as_array() else { continue };
        if runs.len() > 1 {
            html += &format!("<h3>{}</h3>\n", escape(&run.label));
        }
        let counts: Vec<[f64; 3]> = ranks
            .iter()
            .map(|rank| [0, 1, 2].map(|part| rank[part].as_f64().unwrap_or(0.0)))
            .collect();
        html += "<div class=\"wide\"><table><tr><th>Rank</th><th>Local</th><th>Inner</th>\
                 <th>Outer</th></tr>\n";
        for (rank, parts) in counts.iter().take(MOST_RANKS).enumerate() {
            html += &line(&rank.to_string(), &parts.map(grouped));
        }
        if counts.len() > 1 {
            let column = |part: usize| counts.iter().map(move |parts| parts[part]);
            let all = [0, 1, 2].map(|part| grouped(column(part).sum()));
            if counts.len() > MOST_RANKS {
                let most = [0, 1, 2].map(|part| grouped(column(part).fold(0.0, f64::max)));
                html += &line(&format!("largest of {}", counts.len()), &most);
            }
            html += &line("all", &all);
        }
        html += "</table></div>\n";
    }
    html
}

fn table(runs: &[Results], rows: &[(String, Vec<String>)]) -> String {
    let mut html = String::from("<div class=\"wide\"><table>\n");
    if runs.len() > 1 {
        let heads = runs.iter().map(|run| format!("<th>{}</th>", escape(&run.label)));
        html += &format!("<tr><th></th>{}</tr>\n", heads.collect::<String>());
    }
    rows.iter().for_each(|(name, cells)| html += &line(name, cells));
    html + "</table></div>\n"
}

fn line(name: &str, cells: &[String]) -> String {
    let cells: String = cells.iter().map(|cell| format!("<td>{}</td>", escape(cell))).collect();
    format!("<tr><th scope=\"row\">{}</th>{cells}</tr>\n", escape(name))
}

fn solids(runs: &[Results]) -> Vec<&str> {
    let mut names = Vec::new();
    for run in runs {
        let solids = run.summary["solids"].as_array().into_iter().flatten();
        for name in solids.filter_map(|solid| solid["name"].as_str()) {
            if !names.contains(&name) {
                names.push(name);
            }
        }
    }
    names
}

fn energy(run: &Results, kind: &str) -> Option<String> {
    let joule = run.summary.pointer(&format!("/energies/end/{kind}")).and_then(Value::as_f64)?;
    let unit = if run.dimension() == Some(2) { "J/m" } else { "J" };
    Some(format!("{} {unit}", rounded(joule)))
}

/// A count with its digits in groups of three.
fn grouped(count: f64) -> String {
    let digits = format!("{count:.0}");
    let mut text = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place) % 3 == 0 {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}

/// A time in the units of clocks.
fn duration(seconds: f64) -> String {
    if seconds < 60.0 {
        return format!("{seconds:.1} s");
    }
    let whole = seconds.round() as u64;
    let (hours, minutes, rest) = (whole / 3600, whole / 60 % 60, whole % 60);
    if hours > 0 { format!("{hours} h {minutes} min") } else { format!("{minutes} min {rest} s") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_and_times_read_well() {
        for (count, text) in [(0.0, "0"), (999.0, "999"), (1_234_567.0, "1\u{202f}234\u{202f}567")]
        {
            assert_eq!(grouped(count), text);
        }
        for (seconds, text) in [(2.04, "2.0 s"), (61.0, "1 min 1 s"), (7260.0, "2 h 1 min")] {
            assert_eq!(duration(seconds), text);
        }
    }
}
