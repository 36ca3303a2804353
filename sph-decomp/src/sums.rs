//! Global sums that do not depend on the order or on the division of the data.

use crate::{CommError, Communicator};

/// Digits of 32 bits that cover all finite numbers of 64 bits, 2⁻¹⁰⁷⁴ to 2¹⁰²⁴, and carries.
const DIGITS: usize = 68;
/// So many additions fit before the digits must be carried.
const MANY: u32 = 1 << 30;

/// An exact sum of floating-point numbers.
///
/// The sum is kept as a fixed-point number wide enough for every `f64`, so that nothing is ever
/// rounded away: its [`value`](ExactSum::value) is the rounded exact sum, whatever the order of
/// the additions and however they were divided among threads and ranks (Kulisch, *Computer
/// Arithmetic and Validity*, 2008). One addition costs a few nanoseconds.
///
/// ```
/// use sph_decomp::ExactSum;
///
/// let sum: ExactSum = [1e100, 1.0, -1e100].into_iter().collect();
/// assert_eq!(sum.value(), 1.0);
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ExactSum {
    /// Digit `k` counts units of 2^(32 k − 1074). Carried digits are in 0..2³², but the last one
    /// may be negative.
    digits: [i64; DIGITS],
    /// Additions since the digits were carried.
    pending: u32,
    /// How many of the terms were NaN, +∞ and −∞.
    special: [u64; 3],
}

impl Default for ExactSum {
    fn default() -> Self {
        Self { digits: [0; DIGITS], pending: 0, special: [0; 3] }
    }
}

impl ExactSum {
    /// Zero.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds one number.
    pub fn add(&mut self, x: f64) {
        let bits = x.to_bits();
        let exponent = (bits >> 52 & 0x7ff) as usize;
        if exponent == 0x7ff {
            self.special[if x.is_nan() { 0 } else { 1 + usize::from(x < 0.0) }] += 1;
            return;
        }
        let hidden = u64::from(exponent > 0) << 52;
        let mantissa = bits & ((1 << 52) - 1) | hidden;
        // x = mantissa · 2^(position − 1074)
        let position = exponent.max(1) - 1;
        let wide = u128::from(mantissa) << (position % 32);
        let digits = &mut self.digits[position / 32..position / 32 + 3];
        for (k, digit) in digits.iter_mut().enumerate() {
            let part = (wide >> (32 * k)) as u32;
            *digit += if x < 0.0 { -i64::from(part) } else { i64::from(part) };
        }
        self.pending += 1;
        if self.pending == MANY {
            self.carry();
        }
    }

    /// Adds another sum.
    pub fn merge(&mut self, other: &Self) {
        let mut other = other.clone();
        other.carry();
        self.carry();
        for (digit, more) in self.digits.iter_mut().zip(other.digits) {
            *digit += more;
        }
        for (count, more) in self.special.iter_mut().zip(other.special) {
            *count += more;
        }
        self.carry();
    }

    /// The exact sum, rounded to the nearest number, ties to even. NaN if a NaN or both infinities
    /// were added.
    pub fn value(&self) -> f64 {
        match self.special {
            [0, 0, 0] => (),
            [0, _, 0] => return f64::INFINITY,
            [0, 0, _] => return f64::NEG_INFINITY,
            _ => return f64::NAN,
        }
        let mut sum = self.clone();
        sum.carry();
        let negative = sum.digits[DIGITS - 1] < 0;
        if negative {
            sum.digits.iter_mut().for_each(|digit| *digit = -*digit);
            sum.carry();
        }
        let magnitude = sum.magnitude();
        if negative { -magnitude } else { magnitude }
    }

    /// Brings the digits back into their range.
    fn carry(&mut self) {
        for k in 0..DIGITS - 1 {
            let carry = self.digits[k] >> 32;
            self.digits[k] -= carry << 32;
            self.digits[k + 1] += carry;
        }
        self.pending = 0;
    }

    /// The value of carried digits that are not negative.
    fn magnitude(&self) -> f64 {
        let Some(top) = self.digits.iter().rposition(|&digit| digit != 0) else { return 0.0 };
        let highest = 32 * top + 63 - self.digits[top].leading_zeros() as usize;
        let bit = |position: usize| self.digits[position / 32] >> (position % 32) & 1;
        if highest <= 52 {
            // Up to 53 bits above 2^-1074 are the bits of the number itself.
            return f64::from_bits((self.digits[1] as u64) << 32 | self.digits[0] as u64);
        }
        let lowest = highest - 52;
        let mantissa =
            (lowest..=highest).rev().fold(0, |m, position| m << 1 | bit(position) as u64);
        let half = bit(lowest - 1) == 1;
        let more = (0..lowest - 1).any(|position| bit(position) == 1);
        let up = u64::from(half && (more || mantissa & 1 == 1));
        let exponent = lowest as u64 + 1;
        if exponent >= 0x7ff {
            return f64::INFINITY;
        }
        // A mantissa that overflows carries into the exponent, which is right.
        f64::from_bits((exponent << 52) + (mantissa - (1 << 52)) + up)
    }
}

impl Extend<f64> for ExactSum {
    fn extend<I: IntoIterator<Item = f64>>(&mut self, terms: I) {
        terms.into_iter().for_each(|x| self.add(x));
    }
}

impl FromIterator<f64> for ExactSum {
    fn from_iter<I: IntoIterator<Item = f64>>(terms: I) -> Self {
        let mut sum = Self::new();
        sum.extend(terms);
        sum
    }
}

/// Sums over all ranks: each the same bits as if one rank had added everything. Collective.
///
/// ```
/// use sph_decomp::{CommError, Communicator, ExactSum, ThreadRanks, global_sums};
///
/// let totals = ThreadRanks::run(3, |comm| {
///     let mine: ExactSum = [0.1, 0.2, 0.3].into_iter().skip(comm.rank()).take(1).collect();
///     Ok::<_, CommError>(global_sums(&comm, &[mine])?[0])
/// });
/// let alone: ExactSum = [0.3, 0.1, 0.2].into_iter().collect();
/// assert_eq!(totals.unwrap(), [alone.value(); 3]);
/// ```
pub fn global_sums<C: Communicator>(comm: &C, sums: &[ExactSum]) -> Result<Vec<f64>, CommError> {
    const WORDS: usize = DIGITS + 3;
    let mut words = Vec::with_capacity(WORDS * sums.len());
    for sum in sums {
        let mut sum = sum.clone();
        sum.carry();
        words.extend(sum.digits.map(i64::cast_unsigned));
        words.extend(sum.special);
    }
    comm.sum_u64(&mut words)?;
    let total = |words: &[u64]| {
        let mut sum = ExactSum::new();
        for (digit, word) in sum.digits.iter_mut().zip(words) {
            *digit = word.cast_signed();
        }
        sum.special.copy_from_slice(&words[DIGITS..]);
        sum.value()
    };
    Ok(words.chunks_exact(WORDS).map(total).collect())
}

/// The smallest and the largest value over all ranks, element by element. A NaN on any rank gives
/// NaN. Collective.
pub fn global_ranges<C: Communicator>(
    comm: &C,
    ranges: &[(f64, f64)],
) -> Result<Vec<(f64, f64)>, CommError> {
    let mut ends: Vec<f64> = ranges.iter().flat_map(|&(low, high)| [-low, high]).collect();
    comm.max_f64(&mut ends)?;
    Ok(ends.chunks_exact(2).map(|ends| (-ends[0], ends[1])).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ThreadRanks;
    use proptest::prelude::*;

    #[test]
    fn extremes_are_exact() {
        let sum = |terms: &[f64]| terms.iter().copied().collect::<ExactSum>().value();
        let tiny = f64::from_bits(1);
        assert_eq!(sum(&[]), 0.0);
        assert_eq!(sum(&[tiny, tiny, tiny]), 3.0 * tiny);
        assert_eq!(sum(&[f64::MAX, tiny, -f64::MAX]), tiny);
        assert_eq!(sum(&[f64::MAX, f64::MAX]), f64::INFINITY);
        assert_eq!(sum(&[f64::MAX, f64::MAX, -f64::MAX]), f64::MAX);
        assert_eq!(sum(&[f64::MIN_POSITIVE, -tiny]), f64::MIN_POSITIVE.next_down());
        // Ties go to the even neighbour, anything more goes up.
        let half = f64::EPSILON / 2.0;
        assert_eq!(sum(&[1.0, half]), 1.0);
        assert_eq!(sum(&[1.0, half, tiny]), 1.0_f64.next_up());
        assert_eq!(sum(&[1.0_f64.next_up(), half]), 1.0_f64.next_up().next_up());
        assert_eq!(sum(&[2.0_f64.next_down(), half]), 2.0);
    }

    #[test]
    fn infinities_and_nan_are_kept() {
        let sum = |terms: &[f64]| terms.iter().copied().collect::<ExactSum>().value();
        assert_eq!(sum(&[1.0, f64::INFINITY]), f64::INFINITY);
        assert_eq!(sum(&[f64::NEG_INFINITY, 1.0]), f64::NEG_INFINITY);
        assert!(sum(&[f64::NEG_INFINITY, f64::INFINITY]).is_nan());
        assert!(sum(&[1.0, f64::NAN]).is_nan());
    }

    proptest! {
        #[test]
        fn one_sum_of_two_terms_is_the_hardware_sum(a: f64, b: f64) {
            let sum: ExactSum = [a, b].into_iter().collect();
            prop_assert!(sum.value() == a + b || (sum.value().is_nan() && (a + b).is_nan()));
        }

        #[test]
        fn the_division_among_ranks_does_not_matter(
            terms in prop::collection::vec((-1e3_f64..1e3, -60_i32..60), 0..50), ranks in 1_usize..5,
        ) {
            let terms: Vec<f64> = terms.iter().map(|&(x, e)| x * 2.0_f64.powi(e)).collect();
            let alone: ExactSum = terms.iter().rev().copied().collect();
            let shared = ThreadRanks::run(ranks, |comm| {
                let mine: ExactSum = terms.iter().skip(comm.rank()).step_by(ranks).copied().collect();
                global_sums(&comm, &[mine])
            });
            for value in shared.unwrap() {
                prop_assert_eq!(value[0].to_bits(), alone.value().to_bits());
            }
            let (low, high) = terms.split_at(terms.len() / 2);
            let mut merged: ExactSum = low.iter().copied().collect();
            merged.merge(&high.iter().copied().collect());
            prop_assert_eq!(merged.value().to_bits(), alone.value().to_bits());
        }
    }
}
