//! Time on a machine that others use too.

use std::time::Instant;

/// Time that something took.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spent {
    /// Seconds on the clock on the wall.
    pub wall: f64,
    /// Seconds in which threads of this process had a core, added up; the wall clock where the
    /// system does not tell. Other programs make the wall clock longer, but hardly this.
    pub core: f64,
}

/// Measures this process.
#[derive(Debug)]
pub struct Clock {
    wall: Instant,
    core: Option<f64>,
}

impl Clock {
    /// Starts.
    #[must_use]
    pub fn start() -> Self {
        Self { core: core_seconds(), wall: Instant::now() }
    }

    /// Time since the start.
    pub fn spent(&self) -> Spent {
        let wall = self.wall.elapsed().as_secs_f64();
        let core = match (self.core, core_seconds()) {
            (Some(before), Some(now)) if now > before => now - before,
            _ => wall,
        };
        Spent { wall, core }
    }

    /// Runs `work` at least `least` times and for at least `seconds`; returns the time of one run.
    pub fn repeat(least: u32, seconds: f64, mut work: impl FnMut()) -> Spent {
        let clock = Self::start();
        let mut runs = 0;
        while runs < least || clock.wall.elapsed().as_secs_f64() < seconds {
            work();
            runs += 1;
        }
        let spent = clock.spent();
        Spent { wall: spent.wall / f64::from(runs), core: spent.core / f64::from(runs) }
    }
}

/// Seconds that the threads of this process have run. The system brings the number up to date at
/// its clock ticks, so measure a tenth of a second or more.
fn core_seconds() -> Option<f64> {
    let mut nanoseconds = 0;
    for task in std::fs::read_dir("/proc/self/task").ok()? {
        // A thread may end while its folder is read.
        let Ok(text) = std::fs::read_to_string(task.ok()?.path().join("schedstat")) else {
            continue;
        };
        nanoseconds += text.split(' ').next()?.parse::<u64>().ok()?;
    }
    (nanoseconds > 0).then_some(nanoseconds as f64 * 1e-9)
}

/// The middle value, NaN of none.
pub fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_ignores_an_outlier() {
        assert_eq!(median([3.0, 1e9, 1.0, 2.0, 2.5]), 2.5);
        assert!(median([]).is_nan());
    }

    #[test]
    fn work_is_repeated_and_takes_time() {
        let mut runs = 0;
        let spent = Clock::repeat(3, 0.02, || {
            runs += 1;
            std::thread::sleep(std::time::Duration::from_millis(1));
        });
        assert!(runs >= 3);
        assert!(spent.wall >= 1e-3 && spent.core > 0.0);
    }
}
