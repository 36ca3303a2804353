//! `sph report`: what runs did, as one HTML page that needs nothing else.
//!
//! A page has pictures of the flow, curves, key figures, what the run said, and how to repeat it. It
//! loads nothing: styles are inside, curves are inline SVG, pictures are PNGs inside of it. Runs that
//! go on still or were killed have a page too, of what they have left.

mod colours;
mod curves;
mod error;
mod facts;
mod frame;
pub(crate) mod html;
mod page;
mod picture;
mod pictures;
mod plot;
mod results;
mod scan;
mod surface;
mod ticks;
mod view;

pub use error::ReportError;

use page::Budget;
use results::Results;
use scan::Scan;
use std::path::Path;

/// No page is longer, so that it can be mailed.
pub const MOST_BYTES: usize = 5_000_000;

/// The page of the runs whose results lie in these folders, as HTML.
///
/// # Errors
///
/// [`ReportError`] when a folder holds no results, or there are too many runs for a page.
pub fn report<P: AsRef<Path>>(folders: &[P]) -> Result<String, ReportError> {
    let mut runs =
        folders.iter().map(|f| Results::read(f.as_ref())).collect::<Result<Vec<_>, _>>()?;
    if runs.is_empty() {
        return Err(ReportError::NoFolder);
    }
    results::tell_apart(&mut runs);
    let mut problems = Vec::new();
    let moments = pictures::moments_for(runs.len());
    let seen = &runs[..runs.len().min(pictures::MOST_RUNS)];
    let scans: Vec<Scan> = seen.iter().map(|run| Scan::new(run, moments, &mut problems)).collect();
    let mut bytes = 0;
    // A picture of noise takes a byte per pixel, and a third more as text.
    for budget in [
        Budget { pixels: 3.4e6, bins: 400, plots: 60, scene: 100_000 },
        Budget { pixels: 1.5e6, bins: 200, plots: 40, scene: 50_000 },
        Budget { pixels: 0.5e6, bins: 100, plots: 20, scene: 10_000 },
        Budget { pixels: 0.1e6, bins: 50, plots: 10, scene: 1000 },
    ] {
        let page = page::page(&runs, &scans, &problems, budget);
        bytes = page.len();
        if bytes < MOST_BYTES {
            return Ok(page);
        }
    }
    Err(ReportError::TooLong { bytes })
}
