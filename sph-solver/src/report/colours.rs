//! Colours of fields and lines that everybody can tell apart, on paper too.

/// A colour in sRGB.
pub type Rgb = [u8; 3];

/// A scale from low to high with even steps of lightness. Values between the points are
/// interpolated.
pub type Scale = [Rgb; 9];

/// Blues of water from deep to foam, about eight steps of lightness (CIE L*) apart: slow water is dark, and the
/// fastest still stands out from paper and from walls.
pub const SPEED: Scale = [
    [14, 52, 108],
    [16, 72, 140],
    [20, 94, 168],
    [30, 118, 192],
    [50, 143, 208],
    [82, 169, 220],
    [118, 194, 230],
    [156, 217, 239],
    [196, 239, 248],
];

/// Plasma (van der Walt & Smith 2015, for matplotlib), at every eighth.
pub const PRESSURE: Scale = [
    [13, 8, 135],
    [84, 2, 163],
    [139, 10, 165],
    [185, 50, 137],
    [219, 92, 104],
    [244, 136, 73],
    [254, 188, 43],
    [249, 220, 36],
    [240, 249, 33],
];

/// Colours of lines that the colour-blind can tell apart (Okabe & Ito 2008), the darker ones first.
pub const LINES: [&str; 7] =
    ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#000000", "#e69f00", "#56b4e9"];

/// Dashes of the same lines, so that they differ in print without colours.
pub const DASHES: [&str; 7] = ["", "6 3", "2 2", "8 3 2 3", "1 3", "10 4", "4 2 1 2"];

/// The colour at a share of a scale, clamped to its ends.
pub fn at(scale: &Scale, share: f64) -> Rgb {
    // What is no number is at the low end.
    let share = if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) };
    let place = share * (scale.len() - 1) as f64;
    let low = (place as usize).min(scale.len() - 2);
    let part = place - low as f64;
    std::array::from_fn(|k| {
        let (a, b) = (f64::from(scale[low][k]), f64::from(scale[low + 1][k]));
        (a + part * (b - a)).round() as u8
    })
}

/// A colour in this much light, from 0 to 1.
pub fn lit(colour: Rgb, light: f64) -> Rgb {
    colour.map(|c| (f64::from(c) * light.clamp(0.0, 1.0)).round() as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_are_met_at_their_points_and_grow_lighter() {
        for scale in [SPEED, PRESSURE] {
            assert_eq!(at(&scale, -1.0), scale[0]);
            assert_eq!(at(&scale, 2.0), scale[8]);
            assert_eq!(at(&scale, 0.5), scale[4]);
            let light = |c: Rgb| {
                0.2126 * f64::from(c[0]) + 0.7152 * f64::from(c[1]) + 0.0722 * f64::from(c[2])
            };
            assert!(scale.windows(2).all(|pair| light(pair[0]) < light(pair[1])));
        }
        assert_eq!(at(&SPEED, f64::NAN), SPEED[0]);
    }
}
