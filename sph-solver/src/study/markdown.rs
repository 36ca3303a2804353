//! Studies as one table of a document.

use super::cost::Cost;
use super::curve::Curve;
use super::outcome::Outcome;
use super::report::Report;
use std::fmt::Write;

/// A Markdown document with a row per scheme of each study, at its finest spacing. `command` made it;
/// `plots` are paths of the plots of the studies, relative to the document.
pub fn markdown(reports: &[Report], plots: &[String], command: &str) -> String {
    let mut text = format!(
        "# Accuracy\n\n\
         Errors against what is known of a flow, and what they cost. Made with\n\n\
         ```sh\n{command}\n```\n\n\
         by sph {}. Each row is the finest spacing that was run; errors are medians over the seeds of the \
         jitter, if there are any, with their range. Core-seconds are CPU seconds of all threads in the \
         steps, on whatever machine made this table. The order is fitted to all spacings. An error above \
         its bar is marked with ✗.\n\n\
         | case | error | runs | spacing / m | ours | bar | order | core-s | core-s at the bar |\n\
         |---|---|---|---|---|---|---|---|---|\n",
        env!("CARGO_PKG_VERSION"),
    );
    for (report, plot) in reports.iter().zip(plots) {
        for (number, curve) in report.curves.iter().enumerate() {
            let case =
                if number == 0 { format!("[{}]({plot})", report.scene) } else { String::new() };
            let title = if number == 0 { report.title.as_str() } else { "" };
            row(&mut text, report, curve, &case, title);
        }
    }
    let remarks = reports.iter().filter_map(|report| Some((report, report.remark.as_ref()?)));
    let remarks: Vec<String> =
        remarks.map(|(report, remark)| format!("* **{}**: {remark}\n", report.scene)).collect();
    if !remarks.is_empty() {
        text += "\n## Remarks\n\n";
        text += &remarks.concat();
    }
    let failed = reports.iter().flat_map(|report| {
        let rows = report.rows.iter().filter(|row| row.outcome != Outcome::Finished);
        rows.map(|row| {
            let remark = row.remark.as_deref().unwrap_or("");
            format!("* {} {}: {remark}\n", report.scene, row.name)
        })
    });
    let failed: Vec<String> = failed.collect();
    if !failed.is_empty() {
        text += "\n## Runs that did not reach their end\n\n";
        text += &failed.concat();
    }
    text
}

fn row(text: &mut String, report: &Report, curve: &Curve, case: &str, title: &str) {
    let finest = curve.points.iter().rev().find(|point| point.error.is_some());
    let label = if curve.label.is_empty() { "as the scene says" } else { &curve.label };
    let mark = match (finest.and_then(|point| point.error), report.bar) {
        (Some(error), Some(bar)) if error > bar => " ✗",
        (None, _) => " ✗",
        _ => "",
    };
    let error = finest.map_or("none".into(), |point| {
        let range = match point.error_range {
            Some((low, high)) if point.runs.0 > 1 => format!(" ({}–{})", short(low), short(high)),
            _ => String::new(),
        };
        format!("{}{range}", short(point.error.unwrap_or(f64::NAN)))
    });
    let at_bar = report.bar.and_then(|bar| curve.costs.iter().find(|cost| cost.error == bar));
    let at_bar = at_bar.map_or("–".into(), |at| match at.cost {
        Cost::Yes(seconds) => format!("{seconds:.2}"),
        Cost::AtMost(seconds) => format!("< {seconds:.2}"),
        Cost::No => "not reached".into(),
    });
    let _ = writeln!(
        text,
        "| {case} | {title} | {label} | {} | {error}{mark} | {} | {} | {} | {at_bar} |",
        finest.map_or("–".into(), |point| point.spacing.to_string()),
        report.bar.map_or("–".into(), short),
        curve.order.map_or("–".into(), |order| format!("{order:.1}")),
        finest.and_then(|p| p.core_seconds).map_or("–".into(), |cost| format!("{cost:.2}")),
    );
}

/// A number with three digits.
fn short(number: f64) -> String {
    if !(1e-3..1e4).contains(&number.abs()) {
        return format!("{number:.2e}");
    }
    let digits = 2 - number.abs().log10().floor() as i32;
    format!("{number:.*}", digits.max(0) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits() {
        for (number, text) in
            [(0.01234, "0.0123"), (1.5, "1.50"), (123.4, "123"), (1e-5, "1.00e-5"), (0.1, "0.100")]
        {
            assert_eq!(short(number), text);
        }
    }
}
