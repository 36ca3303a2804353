//! A total order of floating-point numbers, so that a maximum does not depend on the order in
//! which ranks are visited, not even with NaN.

/// Maps a number to an integer of the same order. NaN of any kind is above everything.
pub(crate) fn to_ordered(x: f64) -> u64 {
    if x.is_nan() {
        return u64::MAX;
    }
    let bits = x.to_bits();
    if bits >> 63 == 1 { !bits } else { bits | 1 << 63 }
}

/// The inverse of [`to_ordered`].
pub(crate) fn from_ordered(key: u64) -> f64 {
    if key == u64::MAX {
        return f64::NAN;
    }
    f64::from_bits(if key >> 63 == 1 { key & !(1 << 63) } else { !key })
}

/// The larger of two numbers in that order.
pub(crate) fn max_ordered(a: f64, b: f64) -> f64 {
    from_ordered(to_ordered(a).max(to_ordered(b)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keeps_the_order_and_comes_back() {
        let ascending =
            [f64::NEG_INFINITY, -1.5, -f64::MIN_POSITIVE, -0.0, 0.0, 2.0, f64::INFINITY];
        for pair in ascending.windows(2) {
            assert!(to_ordered(pair[0]) < to_ordered(pair[1]), "{pair:?}");
        }
        for x in ascending {
            assert_eq!(from_ordered(to_ordered(x)).to_bits(), x.to_bits());
        }
    }

    #[test]
    fn nan_wins_whatever_its_sign() {
        for nan in [f64::NAN, -f64::NAN] {
            assert!(max_ordered(nan, f64::INFINITY).is_nan());
            assert!(max_ordered(1.0, nan).is_nan());
        }
        assert_eq!(max_ordered(-1.0, -2.0), -1.0);
    }
}
