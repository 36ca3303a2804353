//! Output times.

/// Every so many seconds: due at the first step at or after each multiple of the interval. Steps
/// are never shortened to meet a time, so that outputs do not change the result.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Schedule {
    interval: f64,
    next: u64,
}

impl Schedule {
    /// Every `interval` seconds from 0 on; never when it is `None`.
    pub fn new(interval: Option<f64>) -> Self {
        Self { interval: interval.unwrap_or(f64::INFINITY), next: 0 }
    }

    /// Number of the next output, for a checkpoint.
    pub fn next(&self) -> u64 {
        self.next
    }

    /// The same schedule, going on with output number `next`.
    #[must_use]
    pub fn from(self, next: u64) -> Self {
        Self { next, ..self }
    }

    /// The same schedule, going on at `time` (s): with the first output that is not before it.
    #[must_use]
    pub fn from_time(self, time: f64) -> Self {
        // Casts saturate, and an interval of infinity leaves 0.
        self.from((time / self.interval).ceil().max(0.0) as u64)
    }

    /// The interval, s; infinity for never.
    pub fn interval(&self) -> f64 {
        self.interval
    }

    /// Whether an output is due at `time` (s).
    pub fn due(&self, time: f64) -> bool {
        // Infinity times zero is NaN, which compares as not due.
        time >= self.next as f64 * self.interval
    }

    /// Notes that the output due at `time` was made; outputs missed by a long step are skipped.
    pub fn done(&mut self, time: f64) {
        // At once to the last multiple, then past rounding; beyond 2^53 numbers have no successor.
        self.next = self.next.max((time / self.interval) as u64);
        while self.due(time) && self.next < 1 << 53 {
            self.next += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_multiple_once_even_when_a_step_skips_some() {
        let mut schedule = Schedule::new(Some(0.1));
        let mut made = Vec::new();
        for time in [0.0, 0.04, 0.1, 0.15, 0.42, 0.45, 0.5] {
            if schedule.due(time) {
                schedule.done(time);
                made.push(time);
            }
        }
        assert_eq!(made, [0.0, 0.1, 0.42, 0.5]);
        assert_eq!(schedule.next(), 6);
    }

    #[test]
    fn another_interval_goes_on_from_a_time() {
        let schedule = Schedule::new(Some(0.25));
        for (time, next) in [(0.0, 0), (0.1, 1), (0.25, 1), (0.3, 2)] {
            assert_eq!(schedule.from_time(time).next(), next, "{time}");
        }
        assert_eq!(Schedule::new(None).from_time(3.0).next(), 0);
    }

    #[test]
    fn an_absurdly_short_interval_ends() {
        let mut schedule = Schedule::new(Some(1e-300));
        schedule.done(1.0);
        assert!(schedule.next() >= 1 << 53);
    }

    #[test]
    fn never_is_never() {
        assert!(!Schedule::new(None).due(0.0));
        assert!(!Schedule::new(None).due(1e9));
    }
}
