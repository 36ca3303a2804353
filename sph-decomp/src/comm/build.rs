//! The handshake at the start of a run.

use super::{CommError, Communicator};

/// Checks that all ranks run the same build.
///
/// `tag` holds everything that must agree for the ranks to compute the same bits: version of the
/// program, width of the vector unit, precision, digest of the scene. The error names the first
/// rank that differs from the majority, and is the same on all ranks.
///
/// ```
/// use sph_decomp::{ThreadRanks, check_same_build, Communicator};
///
/// let result = ThreadRanks::run(3, |comm| {
///     let tag = if comm.rank() == 1 { "1.0 sse2" } else { "1.0 avx2" };
///     check_same_build(&comm, tag.as_bytes())
/// });
/// assert!(result.unwrap_err().to_string().contains("rank 1 runs a different build"));
/// ```
pub fn check_same_build<C: Communicator>(comm: &C, tag: &[u8]) -> Result<(), CommError> {
    let tags = comm.all_gather(tag)?;
    let votes = |tag: &[u8]| tags.iter().filter(|other| *other == tag).count();
    // The first of the most frequent tags, so that a tie has the same answer everywhere. The scan
    // is quadratic only when many ranks differ.
    let mut expected = &tags[0];
    let mut most = votes(expected);
    if most < tags.len() {
        for tag in &tags {
            if tag != expected && votes(tag) > most {
                (expected, most) = (tag, votes(tag));
            }
        }
    }
    match tags.iter().position(|tag| tag != expected) {
        None => Ok(()),
        Some(rank) => Err(CommError::DifferentBuild {
            rank,
            theirs: String::from_utf8_lossy(&tags[rank]).into_owned(),
            expected: String::from_utf8_lossy(expected).into_owned(),
        }),
    }
}
