//! How tracked things move, from where they are in neighbouring frames.

use std::collections::BTreeMap;

use jrdb_projection::heading::motion::{Motion, TrackPoint, velocity};
use jrdb_types::{Entities, EntityId, FrameId};

/// How each thing of a frame moves, by its id.
pub type Motions = BTreeMap<EntityId, Motion>;

/// JRDB's images and labels.
const FRAMES_PER_SECOND: f64 = 15.0;
/// Frames this near in time tell how a thing moves, seconds: within it people hardly turn.
const WINDOW_S: f64 = 0.5;

/// Where the tracked things of one frame are.
#[derive(Debug, Clone, PartialEq)]
pub struct Places {
    frame: FrameId,
    centers_m: BTreeMap<EntityId, [f64; 2]>,
}

impl Places {
    /// The places of a frame's entities.
    #[must_use]
    pub fn of(entities: &Entities) -> Self {
        let placed = entities.entities.iter().filter_map(|entity| {
            let [x, y, _] = entity.position?.center;
            Some((entity.id.clone(), [x, y]))
        });
        Self { frame: entities.frame.clone(), centers_m: placed.collect() }
    }

    /// A frame in which nothing is placed.
    #[must_use]
    pub fn nowhere(frame: &FrameId) -> Self {
        Self { frame: frame.clone(), centers_m: BTreeMap::new() }
    }

    fn time_s(&self) -> f64 {
        f64::from(self.frame.frame) / FRAMES_PER_SECOND
    }
}

/// The motions of every frame, by least squares over the frames of its sequence within half a second.
///
/// Frames are sorted by sequence, then number, 15 to the second. `position_std_m` is the standard deviation of a
/// position, metres. Everything is seen from the robot, which must stand.
#[must_use]
pub fn motions(places: &[Places], position_std_m: f64) -> Vec<Motions> {
    let near = |a: &Places, b: &Places| {
        a.frame.sequence == b.frame.sequence && (a.time_s() - b.time_s()).abs() <= WINDOW_S
    };
    let of_frame = |(at, now): (usize, &Places)| {
        let before = places[..at].iter().rev().take_while(|then| near(now, then));
        let after = places[at..].iter().take_while(|then| near(now, then));
        let window: Vec<&Places> = before.chain(after).collect();
        let motion = |id: &EntityId| {
            let point = |then: &&Places| {
                let position_m = *then.centers_m.get(id)?;
                Some(TrackPoint { time_s: then.time_s(), position_m })
            };
            let mut track: Vec<TrackPoint> = window.iter().filter_map(point).collect();
            track.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
            Some((id.clone(), velocity(&track, position_std_m)?))
        };
        now.centers_m.keys().filter_map(motion).collect()
    };
    places.iter().enumerate().map(of_frame).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(sequence: &str, frame: u32, x: f64) -> Places {
        let frame = FrameId { sequence: sequence.into(), frame };
        Places { frame, centers_m: BTreeMap::from([(EntityId::new("pedestrian", 1), [x, 2.0])]) }
    }

    #[test]
    fn only_near_frames_of_the_same_sequence_count() {
        let places = [at("a", 0, 0.0), at("a", 5, 0.4), at("a", 30, 9.0), at("b", 0, 7.0)];
        let found = motions(&places, 0.07);
        let speed = |index: usize| found[index].values().next().map(|motion| motion.velocity_mps);
        let expected = 0.4 / (5.0 / FRAMES_PER_SECOND);
        for index in [0, 1] {
            let [x, y] = speed(index).unwrap();
            assert!((x - expected).abs() < 1e-9 && y.abs() < 1e-12);
        }
        assert_eq!((speed(2), speed(3)), (None, None));
    }
}
