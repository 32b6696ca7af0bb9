//! All relations of all pairs of a frame.

use jrdb_types::entity::Between;
use jrdb_types::vocab::PairWord;
use jrdb_types::{
    Box3d, EntityId, Heading, ImageGeometry, LateralConvention, PairRelation, SpatialRelation,
};
use nalgebra::Point3;

use super::occlusion::{Silhouette, hides};
use super::pairwise::{Pairwise, pairwise};
use super::{RelationConfig, adjacency, between, certainty, facing, motion, overlap, wrap_rad};

/// Something with a place, as the relations see it.
#[derive(Debug, Clone, Copy)]
pub struct Thing<'a> {
    /// Identity.
    pub id: &'a EntityId,
    /// Whether it is a person: only people face others.
    pub is_person: bool,
    /// Centre, metres, base frame.
    pub center: Point3<f64>,
    /// Where it faces, if that is known.
    pub heading: Option<Heading>,
    /// Box in space, if its size is known.
    pub box3d: Option<Box3d>,
    /// Velocity along x and y, metres per second, if it is known.
    pub velocity_mps: Option<[f64; 2]>,
    /// What it shows to the robot.
    pub silhouette: Silhouette<'a>,
}

/// Every ordered pair of things, sorted by subject, then object.
#[must_use]
pub fn relate(
    things: &[Thing<'_>],
    image: ImageGeometry,
    lateral: LateralConvention,
    config: &RelationConfig,
) -> Vec<PairRelation> {
    let centers: Vec<Point3<f64>> = things.iter().map(|thing| thing.center).collect();
    let headings: Vec<f64> =
        things.iter().map(|thing| thing.heading.map_or(0.0, |heading| heading.angle_rad)).collect();
    let words = pairwise(&centers, &headings, lateral);
    let frame = Frame { things, words: &words, image, config };
    let mut relations = Vec::with_capacity(things.len() * things.len().saturating_sub(1));
    for subject in 0..things.len() {
        for object in (0..things.len()).filter(|&object| object != subject) {
            relations.push(frame.pair(subject, object));
        }
    }
    relations.sort_by(|a, b| (&a.subject, &a.object).cmp(&(&b.subject, &b.object)));
    relations
}

/// Who is between whom, sorted by the middle one, then the ends.
#[must_use]
pub fn between_all(things: &[Thing<'_>], config: &RelationConfig) -> Vec<Between> {
    let mut found = Vec::new();
    for (first, a) in things.iter().enumerate() {
        for b in &things[first + 1..] {
            let is_near = (a.center - b.center).xy().norm() <= config.between_max_apart_m;
            for middle in things.iter().filter(|m| is_near && m.id != a.id && m.id != b.id) {
                found.extend(between_two(middle, a, b, config));
            }
        }
    }
    found.sort_by(|a, b| (&a.middle, &a.ends).cmp(&(&b.middle, &b.ends)));
    found
}

fn between_two(
    middle: &Thing<'_>,
    a: &Thing<'_>,
    b: &Thing<'_>,
    config: &RelationConfig,
) -> Option<Between> {
    let (a, b) = if a.id <= b.id { (a, b) } else { (b, a) };
    let along = between::along(&middle.center, [&a.center, &b.center])?;
    let nearer_end = along.fraction.min(1.0 - along.fraction);
    let inside_m = nearer_end * (b.center - a.center).xy().norm();
    let is_between =
        along.offset_m <= config.between_max_offset_m && inside_m >= config.between_min_inside_m;
    is_between.then(|| Between {
        middle: middle.id.clone(),
        ends: [a.id.clone(), b.id.clone()],
        offset_m: along.offset_m,
        fraction: along.fraction,
    })
}

struct Frame<'a> {
    things: &'a [Thing<'a>],
    words: &'a Pairwise,
    image: ImageGeometry,
    config: &'a RelationConfig,
}

impl Frame<'_> {
    fn pair(&self, subject: usize, object: usize) -> PairRelation {
        let (from, to) = (&self.things[subject], &self.things[object]);
        let boxes = from.box3d.as_ref().zip(to.box3d.as_ref());
        let hides_of = |front: &Thing<'_>, behind: &Thing<'_>| {
            let clearance_m = self.config.hides_clearance_m;
            hides(&front.silhouette, &behind.silhouette, self.image, clearance_m)
        };
        let velocities = from.velocity_mps.zip(to.velocity_mps);
        let mut pair = PairRelation {
            gap_m: boxes.map(|(a, b)| adjacency::gap_m(a, b)),
            overlap: boxes.map(|(a, b)| overlap::iou(a, b)).filter(|&iou| iou > 0.0),
            hides: hides_of(from, to),
            motion_angle_rad: velocities
                .and_then(|(a, b)| motion::angle_rad(a, b, self.config.moving_min_mps)),
            ..PairRelation::of(from.id.clone(), to.id.clone(), self.spatial(subject, object))
        };
        let is_hidden = hides_of(to, from)
            .is_some_and(|hides| hides.image_fraction >= self.config.hides_min_fraction);
        pair.words = self.words_of(&pair, is_hidden, (subject, object));
        pair
    }

    fn spatial(&self, from: usize, to: usize) -> SpatialRelation {
        let (words, heading) = (self.words, self.things[from].heading);
        let offset = self.things[to].center - self.things[from].center;
        let bearing = |heading: Heading| wrap_rad(offset.y.atan2(offset.x) - heading.angle_rad);
        let probability = |heading: Heading| {
            certainty::probability(
                words.physical_sector(from, to),
                bearing(heading),
                heading.std_rad,
            )
        };
        SpatialRelation {
            distance: words.distance(from, to),
            direction: heading.map(|_| words.direction(from, to)),
            distance_m: Some(words.distance_m(from, to)),
            bearing_rad: heading.map(bearing),
            rise_m: Some(words.rise_m(from, to)),
            direction_probability: heading.map(probability),
        }
    }

    fn words_of(
        &self,
        pair: &PairRelation,
        is_hidden: bool,
        (subject, object): (usize, usize),
    ) -> Vec<PairWord> {
        let config = self.config;
        let hides = pair.hides.is_some_and(|h| h.image_fraction >= config.hides_min_fraction);
        let faces = self.faces(subject, object);
        let with = pair.motion_angle_rad.is_some_and(|a| a.abs() <= config.same_direction_rad);
        let holds = [
            (PairWord::Adjacent, pair.gap_m.is_some_and(|gap_m| gap_m <= config.adjacent_max_m)),
            (PairWord::Overlapping, pair.overlap.is_some()),
            (PairWord::Hides, hides),
            (PairWord::HiddenBy, is_hidden),
            (PairWord::Facing, faces),
            (PairWord::FacingEachOther, faces && self.faces(object, subject)),
            (PairWord::SameDirection, with),
        ];
        holds.into_iter().filter(|&(_, holds)| holds).map(|(word, _)| word).collect()
    }

    fn faces(&self, from: usize, to: usize) -> bool {
        let subject = &self.things[from];
        let Some(heading) = subject.heading.filter(|_| subject.is_person) else { return false };
        let offset = self.things[to].center - subject.center;
        let bearing_rad = wrap_rad(offset.y.atan2(offset.x) - heading.angle_rad);
        facing::holds(bearing_rad, self.words.distance_m(from, to), self.config.facing_max_m)
    }
}
