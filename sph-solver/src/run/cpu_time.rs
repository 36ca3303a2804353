//! CPU time of this process.

/// User and system seconds of all threads of this process, or `None` where the system does not
/// tell. Resolution 10 ms.
pub fn cpu_seconds() -> Option<f64> {
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    // The name in parentheses may hold spaces; fields 14 and 15 count from the start of the line.
    let (_, rest) = stat.rsplit_once(") ")?;
    let mut fields = rest.split(' ').skip(11);
    let user: f64 = fields.next()?.parse().ok()?;
    let system: f64 = fields.next()?.parse().ok()?;
    // The kernel reports in units of USER_HZ, which is 100 on every Linux platform.
    Some((user + system) / 100.0)
}
