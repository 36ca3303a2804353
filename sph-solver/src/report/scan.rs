//! What there is to see in a run: which moments, where, and in which range of values.

use super::results::Results;
use super::ticks::round_above;
use super::view::{Extent, View};
use sph_io::{PvdEntry, Snapshot, read_vtu};

/// The field of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Field {
    /// Length of the velocity.
    Speed,
    /// Pressure.
    Pressure,
}

impl Field {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Speed, Self::Pressure];

    /// Name in snapshots.
    pub fn column(self) -> &'static str {
        match self {
            Self::Speed => "velocity",
            Self::Pressure => "pressure",
        }
    }
}

/// What has been seen of a run.
#[derive(Debug)]
pub struct Scan {
    /// The moments to show, in the order of time.
    pub moments: Vec<PvdEntry>,
    /// Where nearly all of the fluid was in them.
    pub fluid: Extent,
    /// Where all of it was, and where in the first of them.
    all: Extent,
    first: Extent,
    /// Where the walls are.
    pub walls: Extent,
    /// Samples of each field, sorted.
    samples: [Vec<f64>; 2],
    /// Particles of the first moment that was read.
    particles: usize,
    /// Whether there is no third dimension.
    pub flat: bool,
    /// Distance of the particles, m.
    pub spacing: f64,
}

/// So many numbers tell the range of a field.
const SAMPLES_PER_MOMENT: usize = 20_000;

impl Scan {
    /// Looks at `count` moments of a run, evenly spread over what there is. Files that cannot be read
    /// are left out and added to the problems.
    pub fn new(results: &Results, count: usize, problems: &mut Vec<String>) -> Self {
        let mut scan = Self {
            moments: Vec::new(),
            fluid: Extent::EMPTY,
            all: Extent::EMPTY,
            first: Extent::EMPTY,
            walls: Extent::EMPTY,
            samples: [Vec::new(), Vec::new()],
            particles: 0,
            flat: results.dimension() == Some(2),
            spacing: results.record.spacing,
        };
        for moment in spread(&results.snapshots, count) {
            match read_vtu(results.folder.join(&moment.file)) {
                Ok(snapshot) => {
                    scan.add(&snapshot);
                    scan.moments.push(moment.clone());
                }
                Err(error) => problems.push(format!("{error}; the picture is left out")),
            }
        }
        let mut parts = walls(results, problems);
        for moment in &scan.moments {
            parts.extend(moving(results, moment.time, problems));
        }
        parts.iter().flat_map(|part| &part.positions).for_each(|point| scan.walls.add(point));
        scan.samples.iter_mut().for_each(|samples| samples.sort_by(f64::total_cmp));
        if results.dimension().is_none() {
            scan.flat = !scan.fluid.is_empty() && scan.fluid.min[2] == scan.fluid.max[2];
        }
        if !(scan.spacing > 0.0 && scan.spacing.is_finite()) {
            scan.spacing = guessed_spacing(&scan.fluid, scan.particles, scan.flat);
        }
        scan
    }

    fn add(&mut self, snapshot: &Snapshot) {
        let stride = snapshot.positions.len() / SAMPLES_PER_MOMENT + 1;
        let mut all = Extent::EMPTY;
        snapshot.positions.iter().for_each(|point| all.add(point));
        self.all.join(&all);
        self.fluid.join(&bulk(&snapshot.positions, stride));
        if self.particles == 0 {
            self.particles = snapshot.positions.len();
            self.first = all;
            self.fluid.join(&all);
        }
        for (samples, field) in self.samples.iter_mut().zip(Field::ALL) {
            let values = snapshot.magnitudes(field.column()).unwrap_or_default();
            samples.extend(values.into_iter().step_by(stride).filter(|value| value.is_finite()));
        }
    }

    /// Whether the snapshots have the field.
    pub fn has(&self, field: Field) -> bool {
        !self.samples[field as usize].is_empty()
    }

    /// What pictures show: where the fluid has been, with the walls nearby.
    pub fn extent(&self) -> Extent {
        let room = 3.5 * self.spacing;
        // Walls around the fluid say what is of interest. In the open, a few drops that fly far away
        // do not.
        let enclosed = !self.walls.is_empty()
            && self.walls.contains(&self.first.min)
            && self.walls.contains(&self.first.max);
        let near = if enclosed {
            self.all.grown(room).within(&self.walls)
        } else {
            self.fluid.grown(room)
        };
        if self.flat {
            let Extent { mut min, mut max } = near;
            (min[2], max[2]) = (0.0, 0.0);
            return Extent { min, max };
        }
        near
    }

    /// The view that suits this run; `gravity` tells where up is.
    pub fn view(&self, gravity: &[f64]) -> View {
        if self.flat {
            return View::flat();
        }
        let strongest =
            (0..gravity.len()).max_by(|a, b| gravity[*a].abs().total_cmp(&gravity[*b].abs()));
        View::of_space(strongest.filter(|axis| gravity[*axis] != 0.0).unwrap_or(2))
    }
}

/// The range of a field in several runs, with round ends: nearly all values are within.
pub fn range(scans: &[Scan], field: Field) -> (f64, f64) {
    let quantile = |share: f64| {
        let of = |scan: &Scan| {
            let samples = &scan.samples[field as usize];
            samples.get(((samples.len().max(1) - 1) as f64 * share).round() as usize).copied()
        };
        scans.iter().filter_map(of).collect::<Vec<_>>()
    };
    let high = round_above(quantile(0.995).into_iter().fold(0.0, f64::max));
    let low = quantile(0.02).into_iter().fold(0.0, f64::min);
    // A little tension is no reason for a scale of its own.
    (if low < -0.1 * high { -round_above(-low) } else { 0.0 }, high)
}

/// The walls of a run that rest.
pub fn walls(results: &Results, problems: &mut Vec<String>) -> Vec<Snapshot> {
    read_walls(results, results.walls.iter(), problems)
}

/// The walls of a run that move, in the snapshot of a time (s).
pub fn moving(results: &Results, time: f64, problems: &mut Vec<String>) -> Vec<Snapshot> {
    let then = results.moving.iter().filter(|one| one.time == time);
    read_walls(results, then.map(|one| &one.file), problems)
}

fn read_walls<'a>(
    results: &Results,
    files: impl Iterator<Item = &'a String>,
    problems: &mut Vec<String>,
) -> Vec<Snapshot> {
    let mut walls = Vec::new();
    for file in files {
        match read_vtu(results.folder.join(file)) {
            Ok(part) => walls.push(part),
            Err(error) => {
                let problem = format!("{error}; walls are not drawn");
                if !problems.contains(&problem) {
                    problems.push(problem);
                }
            }
        }
    }
    walls
}

/// `count` of the moments, first and last among them, as evenly in time as they allow.
fn spread(moments: &[PvdEntry], count: usize) -> Vec<&PvdEntry> {
    let (Some(first), Some(last)) = (moments.first(), moments.last()) else { return Vec::new() };
    if moments.len() <= count || count < 2 {
        return moments.iter().take(count).collect();
    }
    let mut chosen: Vec<usize> = Vec::new();
    for k in 0..count {
        let wanted = first.time + (last.time - first.time) * k as f64 / (count - 1) as f64;
        let nearest = (0..moments.len()).min_by(|a, b| {
            let far = |index: &usize| (moments[*index].time - wanted).abs();
            far(a).total_cmp(&far(b))
        });
        chosen.extend(nearest.filter(|index| !chosen.contains(index)));
    }
    chosen.into_iter().map(|index| &moments[index]).collect()
}

/// Where all but a few in a thousand of the particles are, along each axis.
fn bulk(positions: &[[f64; 3]], stride: usize) -> Extent {
    let mut extent = Extent { min: [0.0; 3], max: [0.0; 3] };
    for axis in 0..3 {
        let mut places: Vec<f64> =
            positions.iter().step_by(stride).map(|x| x[axis]).filter(|x| x.is_finite()).collect();
        places.sort_by(f64::total_cmp);
        let few = places.len() / 200;
        let (Some(low), Some(high)) = (places.get(few), places.iter().nth_back(few)) else {
            return Extent::EMPTY;
        };
        (extent.min[axis], extent.max[axis]) = (*low, *high);
    }
    extent
}

/// The distance at which so many particles fill about a box.
fn guessed_spacing(fluid: &Extent, particles: usize, flat: bool) -> f64 {
    if fluid.is_empty() || particles == 0 {
        return 1.0;
    }
    let sizes = (0..if flat { 2 } else { 3 }).map(|axis| fluid.max[axis] - fluid.min[axis]);
    let dimensions = if flat { 2.0 } else { 3.0 };
    let guess = (sizes.product::<f64>() / particles as f64).powf(1.0 / dimensions);
    if guess > 0.0 { guess } else { 1e-3 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moments(times: &[f64]) -> Vec<PvdEntry> {
        times.iter().map(|t| PvdEntry { time: *t, part: 0, file: format!("{t}.vtu") }).collect()
    }

    #[test]
    fn drops_that_fly_away_do_not_count() {
        let mut positions: Vec<[f64; 3]> = (0..1000).map(|k| [f64::from(k), 1.0, 2.0]).collect();
        positions.push([1e6, -1e6, 2.0]);
        let extent = bulk(&positions, 1);
        assert_eq!(extent, Extent { min: [5.0, 1.0, 2.0], max: [995.0, 1.0, 2.0] });
        assert!(bulk(&[], 1).is_empty());
    }

    #[test]
    fn moments_are_spread_over_time() {
        let all = moments(&[0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0]);
        let times = |count| spread(&all, count).iter().map(|one| one.time).collect::<Vec<_>>();
        assert_eq!(times(3), [0.0, 0.5, 1.0]);
        assert_eq!(times(20).len(), 11);
        assert_eq!(times(6), [0.0, 0.2, 0.4, 0.6, 0.8, 1.0]);
        assert!(spread(&[], 6).is_empty());
        // A run that wrote often at first only.
        let uneven = moments(&[0.0, 0.01, 0.02, 0.03, 1.0]);
        assert_eq!(spread(&uneven, 4).len(), 3);
    }
}
