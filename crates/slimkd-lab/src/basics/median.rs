//! Medians, and ratios that are taken within a round before they are summed up.

/// The middle value; the mean of the middle two for an even count; `None` for no value or a NaN.
pub fn median(values: &[f64]) -> Option<f64> {
    if values.is_empty() || values.iter().any(|x| x.is_nan()) {
        return None;
    }
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted.len() / 2;
    Some(if sorted.len() % 2 == 1 { sorted[middle] } else { (sorted[middle - 1] + sorted[middle]) / 2.0 })
}

/// Round by round, how many times as fast as `base` a contender was: a machine that is busy in one round slows both.
/// Both slices are seconds for the same rays.
pub fn speed_ratios(base_seconds: &[f64], seconds: &[f64]) -> Vec<f64> {
    base_seconds.iter().zip(seconds).map(|(base, own)| base / own).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians() {
        assert_eq!(median(&[]), None);
        assert_eq!(median(&[1.0, f64::NAN]), None);
        assert_eq!(median(&[3.0]), Some(3.0));
        assert_eq!(median(&[9.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(&[4.0, 1.0, 2.0, 100.0]), Some(3.0));
    }

    #[test]
    fn a_slow_round_does_not_move_the_ratio() {
        // The second round ran at half speed for both.
        let (base, own) = ([1.0, 2.0, 1.0], [0.5, 1.0, 0.5]);
        assert_eq!(speed_ratios(&base, &own), [2.0, 2.0, 2.0]);
        assert_eq!(median(&speed_ratios(&base, &own)), Some(2.0));
    }
}
