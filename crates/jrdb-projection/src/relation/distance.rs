//! Distance in words.

use jrdb_types::DistanceWord;

/// The word for a distance in metres; `None` when it is not a number.
///
/// Right-closed bins: at most 0.5 very close, 1.5 close, 5 moderate, 10 far, else very far
/// (JRDB-Reasoning `discretize_distances2`).
///
/// ```
/// use jrdb_projection::relation::distance;
/// assert_eq!(distance::word(1.5).unwrap().word(), "close");
/// ```
#[must_use]
pub fn word(distance_m: f64) -> Option<DistanceWord> {
    DistanceWord::of_metres(distance_m)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bins_are_closed_on_the_right() {
        let words: Vec<_> = [0.0, 0.5, 0.500_001, 1.5, 5.0, 10.0, 10.1, f64::INFINITY]
            .map(|d| word(d).unwrap().word())
            .to_vec();
        let expected = [
            "very close",
            "very close",
            "close",
            "close",
            "moderate",
            "far",
            "very far",
            "very far",
        ];
        assert_eq!(words, expected);
        assert_eq!(word(f64::NAN), None);
    }
}
