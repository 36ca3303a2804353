//! Eight distance tests at a time, and the positions of the hits without a branch.

use wide::{f32x8, u16x8};

/// Lanes of a test.
pub const LANES: usize = 8;

/// For each pattern of hits among eight candidates, the lanes that hit, first to last.
pub static LANES_OF: [[u16; LANES]; 256] = {
    let mut table = [[0; LANES]; 256];
    let mut pattern = 0;
    while pattern < 256 {
        let (mut lane, mut hits) = (0, 0);
        while lane < LANES {
            if pattern >> lane & 1 == 1 {
                table[pattern][hits] = lane as u16;
                hits += 1;
            }
            lane += 1;
        }
        pattern += 1;
    }
    table
};

/// Number of hits in each pattern: plain x86-64 has no instruction for it.
static COUNT_OF: [u8; 256] = {
    let mut table = [0; 256];
    let mut pattern = 0;
    while pattern < 256 {
        table[pattern] = (pattern as u8).count_ones() as u8;
        pattern += 1;
    }
    table
};

/// Bit pattern of the lanes with `a < b`.
#[inline(always)]
pub fn less(a: f32x8, b: f32x8) -> u8 {
    a.simd_lt(b).to_bitmask() as u8
}

/// Writes `first + lane` of every hit of `pattern` at the start of `hits`, and rubbish after them
/// up to eight elements; returns the number of hits.
#[inline(always)]
pub fn compress(pattern: u8, first: u16, hits: &mut [u16; LANES]) -> usize {
    let lanes = u16x8::from(LANES_OF[usize::from(pattern)]);
    *hits = (lanes + u16x8::splat(first)).to_array();
    usize::from(COUNT_OF[usize::from(pattern)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pattern_gives_its_lanes() {
        for pattern in 0..=255_u8 {
            let mut hits = [0; LANES];
            let n = compress(pattern, 100, &mut hits);
            let expected: Vec<u16> =
                (0..8).filter(|l| pattern >> l & 1 == 1).map(|l| 100 + l).collect();
            assert_eq!(hits[..n], expected);
        }
    }

    #[test]
    fn a_bit_per_lane() {
        let a = f32x8::from([0.0, 1.0, 2.0, 3.0, f32::INFINITY, -1.0, f32::NAN, 2.5]);
        assert_eq!(less(a, f32x8::splat(2.5)), 0b0010_0111);
    }
}
