//! How tracked things move, from where they are in neighbouring frames.

use std::collections::{BTreeMap, VecDeque};

use jrdb_projection::Motions;
use jrdb_projection::heading::motion::{Motion, TrackPoint, velocity};
use jrdb_types::{EntityId, FrameId};

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
    /// The places of a frame's things: x and y of their centres, base frame, metres.
    #[must_use]
    pub fn new(frame: FrameId, centers_m: impl IntoIterator<Item = (EntityId, [f64; 2])>) -> Self {
        Self { frame, centers_m: centers_m.into_iter().collect() }
    }

    fn time_s(&self) -> f64 {
        f64::from(self.frame.frame) / FRAMES_PER_SECOND
    }

    fn is_near(&self, other: &Self) -> bool {
        self.frame.sequence == other.frame.sequence
            && (self.time_s() - other.time_s()).abs() <= WINDOW_S
    }
}

/// Frames with the motions of their things, as an iterator: a frame comes out once all frames within half a second of it
/// have come in.
///
/// Frames are sorted by sequence, then number, 15 to the second. A motion is the least-squares line through the
/// places of a thing. Everything is seen from the robot, which must stand. Only the frames of the window are kept.
pub struct WithMotions<I, T> {
    frames: I,
    /// The standard deviation of a position, metres.
    position_std_m: f64,
    past: VecDeque<Places>,
    ahead: VecDeque<(Places, T)>,
}

/// Adds motions to frames; `position_std_m` is the standard deviation of a position, metres.
pub fn with_motions<I, T>(frames: I, position_std_m: f64) -> WithMotions<I::IntoIter, T>
where
    I: IntoIterator<Item = (Places, T)>,
{
    let (past, ahead) = (VecDeque::new(), VecDeque::new());
    WithMotions { frames: frames.into_iter(), position_std_m, past, ahead }
}

impl<I: Iterator<Item = (Places, T)>, T> Iterator for WithMotions<I, T> {
    type Item = (Motions, T);

    fn next(&mut self) -> Option<Self::Item> {
        while self.is_open() {
            match self.frames.next() {
                Some(frame) => self.ahead.push_back(frame),
                None => break,
            }
        }
        let (now, item) = self.ahead.pop_front()?;
        while self.past.front().is_some_and(|then| !then.is_near(&now)) {
            self.past.pop_front();
        }
        let after = self.ahead.iter().map(|(then, _)| then).take_while(|then| then.is_near(&now));
        let window: Vec<&Places> = self.past.iter().chain([&now]).chain(after).collect();
        let motions = motions(&now, &window, self.position_std_m);
        self.past.push_back(now);
        Some((motions, item))
    }
}

impl<I, T> WithMotions<I, T> {
    /// Whether a frame that has not come in yet may be near the first one that waits.
    fn is_open(&self) -> bool {
        match (self.ahead.front(), self.ahead.back()) {
            (Some((first, _)), Some((last, _))) => first.is_near(last),
            _ => true,
        }
    }
}

fn motions(now: &Places, window: &[&Places], position_std_m: f64) -> Motions {
    let motion = |id: &EntityId| -> Option<(EntityId, Motion)> {
        let point = |then: &&Places| {
            let position_m = *then.centers_m.get(id)?;
            Some(TrackPoint { time_s: then.time_s(), position_m })
        };
        let track: Vec<TrackPoint> = window.iter().filter_map(point).collect();
        Some((id.clone(), velocity(&track, position_std_m)?))
    };
    now.centers_m.keys().filter_map(motion).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(sequence: &str, frame: u32, x: f64) -> (Places, u32) {
        let id = FrameId { sequence: sequence.into(), frame };
        (Places::new(id, [(EntityId::new("pedestrian", 1), [x, 2.0])]), frame)
    }

    #[test]
    fn only_near_frames_of_the_same_sequence_count() {
        let places = [at("a", 0, 0.0), at("a", 5, 0.4), at("a", 30, 9.0), at("b", 0, 7.0)];
        let found: Vec<(Motions, u32)> = with_motions(places, 0.07).collect();
        assert_eq!(found.iter().map(|(_, frame)| *frame).collect::<Vec<_>>(), [0, 5, 30, 0]);
        let speed = |index: usize| found[index].0.values().next().map(|motion| motion.velocity_mps);
        let expected = 0.4 / (5.0 / FRAMES_PER_SECOND);
        for index in [0, 1] {
            let [x, y] = speed(index).unwrap();
            assert!((x - expected).abs() < 1e-9 && y.abs() < 1e-12);
        }
        assert_eq!((speed(2), speed(3)), (None, None));
    }

    #[test]
    fn a_frame_comes_out_before_far_ones_come_in() {
        let mut taken = 0;
        let frames = (0..100).map(|frame| {
            taken = frame;
            at("a", frame, 0.1)
        });
        let first = with_motions(frames, 0.07).next().unwrap();
        assert_eq!((first.1, taken), (0, 8));
    }
}
