//! Round numbers for axes.

/// Places of ticks on an axis and how they are written.
#[derive(Debug, Clone, PartialEq)]
pub struct Ticks {
    /// Values in the unit of the data.
    pub values: Vec<f64>,
    /// The distance between two of them.
    pub step: f64,
    /// Labels show the values divided by 10 to this power, a multiple of 3.
    pub power: i32,
}

impl Ticks {
    /// About `wanted` ticks within `low..=high` at multiples of 1, 2 or 5 times a power of ten.
    pub fn new(low: f64, high: f64, wanted: usize) -> Self {
        let step = round_step((high - low) / wanted.max(1) as f64);
        let first = (low / step - 1e-9).ceil() as i64;
        let last = (high / step + 1e-9).floor() as i64;
        let values = (0..100_i64)
            .map(|k| first.saturating_add(k))
            .take_while(|k| *k <= last)
            .map(|k| k as f64 * step)
            .collect();
        let largest = low.abs().max(high.abs());
        let power = if largest >= 1e4 || (largest < 1e-2 && largest > 0.0) {
            3 * (largest.log10() / 3.0).floor().clamp(-103.0, 103.0) as i32
        } else {
            0
        };
        Self { values, step, power }
    }

    /// The label of a value.
    pub fn label(&self, value: f64) -> String {
        let scale = 10.0_f64.powi(self.power);
        let decimals = (-(self.step / scale).log10() - 1e-9).ceil().clamp(0.0, 9.0) as usize;
        let text = format!("{:.decimals$}", value / scale);
        // A minus before zero is rounding.
        let text = if text.trim_matches(['-', '0', '.']).is_empty() {
            text.trim_start_matches('-').to_owned()
        } else {
            text
        };
        text.replace('-', "\u{2212}")
    }

    /// A unit with the power of ten of the labels.
    pub fn unit(&self, unit: &str) -> String {
        let unit = if unit == "1" { "" } else { unit };
        match self.power {
            0 => unit.to_owned(),
            power => format!("10{} {unit}", superscript(power)).trim_end().to_owned(),
        }
    }
}

/// The smallest of 1, 2, 5 times a power of ten that is not below `least`.
fn round_step(least: f64) -> f64 {
    round_up(least, &[1.0, 2.0, 5.0])
}

/// The smallest round number that is not below a positive `value`; 1 when there is none.
pub fn round_above(value: f64) -> f64 {
    round_up(value, &[1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0])
}

fn round_up(least: f64, mantissas: &[f64]) -> f64 {
    if !(least > 0.0 && least.is_finite()) {
        return 1.0;
    }
    let decade = 10.0_f64.powf(least.log10().floor());
    let fits = |m: &&f64| **m * decade >= least * (1.0 - 1e-9);
    mantissas.iter().find(fits).map_or(10.0 * decade, |m| m * decade)
}

fn superscript(power: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let raise = |c: char| c.to_digit(10).map_or('⁻', |digit| DIGITS[digit as usize]);
    power.to_string().chars().map(raise).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_at_round_numbers() {
        let ticks = Ticks::new(-0.13, 1.21, 6);
        assert_eq!(ticks.step, 0.5);
        let labels: Vec<_> = ticks.values.iter().map(|v| ticks.label(*v)).collect();
        assert_eq!(labels, ["0.0", "0.5", "1.0"]);
        let ticks = Ticks::new(-25_000.0, 40_000.0, 5);
        let labels: Vec<_> = ticks.values.iter().map(|v| ticks.label(*v)).collect();
        assert_eq!(labels, ["\u{2212}20", "0", "20", "40"]);
        assert_eq!(ticks.unit("N/m"), "10³ N/m");
        let ticks = Ticks::new(0.0, 0.004, 4);
        assert_eq!(ticks.unit("1"), "10⁻³");
        assert_eq!(ticks.label(0.002), "2");
    }

    #[test]
    fn strange_ranges_end() {
        for (low, high) in [(0.0, 0.0), (1.0, 1.0), (f64::NAN, 1.0), (0.0, f64::INFINITY)] {
            assert!(Ticks::new(low, high, 5).values.len() <= 100);
        }
    }

    #[test]
    fn ends_of_scales_are_round() {
        for (value, round) in [(0.93, 1.0), (1.3, 1.5), (7.0, 8.0), (8100.0, 10_000.0), (0.0, 1.0)]
        {
            assert!((round_above(value) / round - 1.0_f64).abs() < 1e-12, "{value}");
        }
    }
}
