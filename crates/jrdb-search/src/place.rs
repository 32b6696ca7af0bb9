//! Whether something is where it is asked to be.

use jrdb_types::answer::{Measured, Unit};
use jrdb_types::query::{Interval, Place};
use jrdb_types::vocab::{Elevation, LEVEL_RISE_MAX_M, Sector};
use jrdb_types::{LateralConvention, SpatialRelation};

use crate::geometry::near_deg;
use crate::observer::Observer;
use crate::probability;
use crate::value::Truth;

/// Whether a place is as asked: words by words, numbers by numbers.
pub(crate) fn truth(place: &Place, found: &SpatialRelation) -> Truth {
    Truth::of_known(match place {
        Place::Distance(word) => found.distance.map(|distance| distance == *word),
        Place::Direction(word) => found.direction.map(|direction| direction == *word),
        Place::Metres(interval) => found.distance_m.map(|metres| interval.contains(metres)),
        Place::Degrees { center, half_width } => found.bearing_rad.map(|bearing| {
            let degrees = bearing.to_degrees();
            (near_deg(degrees, *center) - center).abs() <= *half_width
        }),
    })
}

/// Whether a place only states how far something is.
pub(crate) fn is_distance(place: &Place) -> bool {
    matches!(place, Place::Distance(_) | Place::Metres(_))
}

/// How probable it is that a place is as asked; 0 where nothing is known.
pub(crate) fn probability(place: &Place, found: &SpatialRelation, observer: &Observer<'_>) -> f64 {
    match place {
        Place::Distance(word) => probability::of_distance(found, *word, observer),
        Place::Direction(word) => probability::of_direction(found, *word, observer),
        Place::Metres(interval) => found
            .distance_m
            .map_or(0.0, |metres| probability::of_metres(metres, interval, observer)),
        Place::Degrees { center, half_width } => {
            probability::of_degrees(found, *center, *half_width, observer)
        }
    }
}

/// A number with its bounds.
pub(crate) fn measured(value: f64, unit: Unit, bounds: Interval) -> Measured {
    let inside = bounds.min.map_or(f64::INFINITY, |min| value - min);
    let inside = bounds.max.map_or(inside, |max| inside.min(max - value));
    Measured { value, unit, bounds, margin: inside }
}

/// Both ends of a stretch; infinite ones are open.
pub(crate) fn interval(min: f64, max: f64) -> Interval {
    let finite = |bound: f64| bound.is_finite().then_some(bound);
    Interval { min: finite(min), max: finite(max) }
}

/// The number behind a place and where it must lie; `None` for words without numbers, and where nothing bounds it.
pub(crate) fn measure(
    place: &Place,
    found: &SpatialRelation,
    lateral: LateralConvention,
) -> Option<Measured> {
    let metres =
        |min: f64, max| Some(measured(found.distance_m?, Unit::Metres, interval(min, max)));
    let degrees = |low: f64, high: f64| {
        let value = near_deg(found.bearing_rad?.to_degrees(), f64::midpoint(low, high));
        Some(measured(value, Unit::Degrees, interval(low, high)))
    };
    let found = match place {
        Place::Distance(word) => {
            let (low, high) = word.bounds_m();
            metres(if low > 0.0 { low } else { f64::NEG_INFINITY }, high)
        }
        Place::Metres(asked) => {
            metres(asked.min.unwrap_or(f64::NEG_INFINITY), asked.max.unwrap_or(f64::INFINITY))
        }
        Place::Degrees { center, half_width } => degrees(center - half_width, center + half_width),
        Place::Direction(word) => {
            let elevation = found.direction.map(|direction| direction.elevation);
            if elevation.is_some_and(|elevation| elevation != word.elevation) {
                rise(found, word.elevation)
            } else {
                let (low, high) = sector_bounds(word.sector, lateral);
                degrees(low, high)
            }
        }
    };
    found.filter(|measured| measured.margin.is_finite())
}

/// From and to, degrees counter-clockwise.
fn sector_bounds(sector: Sector, lateral: LateralConvention) -> (f64, f64) {
    sector.named(lateral).bounds_deg()
}

fn rise(found: &SpatialRelation, asked: Elevation) -> Option<Measured> {
    let bounds = match asked {
        Elevation::Level => interval(-LEVEL_RISE_MAX_M, LEVEL_RISE_MAX_M),
        Elevation::Up => interval(LEVEL_RISE_MAX_M, f64::INFINITY),
        Elevation::Down => interval(f64::NEG_INFINITY, -LEVEL_RISE_MAX_M),
    };
    Some(measured(found.rise_m?, Unit::Metres, bounds))
}

#[cfg(test)]
mod tests {
    use super::*;
    use jrdb_types::{Direction, DistanceWord};

    fn at(distance_m: f64, bearing_deg: f64) -> SpatialRelation {
        let (distance_m, bearing_rad) = (Some(distance_m), Some(bearing_deg.to_radians()));
        SpatialRelation { distance_m, bearing_rad, ..SpatialRelation::default() }
    }

    #[test]
    fn two_o_clock_is_to_the_right() {
        let place = Place::Degrees { center: -60.0, half_width: 15.0 };
        assert_eq!(truth(&place, &at(1.0, -50.0)), Truth::Yes);
        assert_eq!(truth(&place, &at(1.0, 60.0)), Truth::No);
        assert_eq!(truth(&place, &SpatialRelation::default()), Truth::Unknown);
        let behind = Place::Degrees { center: 180.0, half_width: 15.0 };
        assert_eq!(truth(&behind, &at(1.0, -170.0)), Truth::Yes);
    }

    #[test]
    fn the_margin_is_the_way_to_the_nearer_bound() {
        let word = Place::Distance(DistanceWord::Moderate);
        let physical = LateralConvention::Physical;
        assert_eq!(measure(&word, &at(2.0, 0.0), physical).map(|m| m.margin), Some(0.5));
        assert_eq!(measure(&word, &at(6.0, 0.0), physical).map(|m| m.margin), Some(-1.0));
        let back = Place::Direction(Direction::level(Sector::Back));
        let found = measure(&back, &at(1.0, -160.0), physical).unwrap();
        assert!((found.value - 200.0).abs() < 1e-9 && (found.margin - 15.0).abs() < 1e-9);
        let anywhere = Place::Metres(Interval::default());
        assert_eq!(measure(&anywhere, &at(1.0, 0.0), physical), None);
    }
}
