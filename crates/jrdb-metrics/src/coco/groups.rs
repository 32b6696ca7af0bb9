//! The boxes of a dataset, grouped by category and image with one sort.

use std::cmp::Reverse;

use super::dataset::{Dataset, DetectionBox, GroundTruthBox};

/// The boxes of a dataset, ordered by category, then image; detections also by score.
pub(super) struct Grouped<'a> {
    truth: Vec<&'a GroundTruthBox>,
    detections: Vec<&'a DetectionBox>,
}

/// The boxes of one category that has true boxes.
#[derive(Clone, Copy)]
pub(super) struct Category<'a> {
    pub(super) id: u64,
    truth: &'a [&'a GroundTruthBox],
    detections: &'a [&'a DetectionBox],
}

/// The boxes of one category in one image.
pub(super) struct Group<'a> {
    pub(super) truth: &'a [&'a GroundTruthBox],
    /// Best first.
    pub(super) detections: &'a [&'a DetectionBox],
}

impl<'a> Grouped<'a> {
    pub(super) fn new(dataset: &'a Dataset) -> Self {
        // Stable sorts keep the order of equals, and cost little where the order is right already.
        let mut truth: Vec<_> = dataset.truth.iter().collect();
        truth.sort_by_key(|t| (t.category, t.image));
        let mut detections: Vec<_> = dataset.detections.iter().collect();
        detections.sort_by_key(|d| (d.category, d.image));
        let groups = detections.chunk_by_mut(|a, b| (a.category, a.image) == (b.category, b.image));
        groups.for_each(|group| group.sort_by_key(|d| rank(d.score)));
        Self { truth, detections }
    }

    /// Every category that has true boxes, ascending.
    pub(super) fn categories(&self) -> impl Iterator<Item = Category<'_>> {
        self.truth.chunk_by(|a, b| a.category == b.category).map(|truth| {
            let id = truth[0].category;
            let start = self.detections.partition_point(|d| d.category < id);
            let end = self.detections.partition_point(|d| d.category <= id);
            Category { id, truth, detections: &self.detections[start..end] }
        })
    }
}

impl<'a> Category<'a> {
    /// Every image that has boxes, ascending.
    pub(super) fn images(self) -> impl Iterator<Item = Group<'a>> {
        let (mut truth, mut detections) = (self.truth, self.detections);
        std::iter::from_fn(move || {
            let first = [truth.first().map(|t| t.image), detections.first().map(|d| d.image)];
            let image = first.into_iter().flatten().min()?;
            Some(Group {
                truth: take_leading(&mut truth, |t| t.image == image),
                detections: take_leading(&mut detections, |d| d.image == image),
            })
        })
    }
}

/// Splits off the leading elements that belong together.
fn take_leading<'a, T>(rest: &mut &'a [T], belongs: impl Fn(&T) -> bool) -> &'a [T] {
    let count = rest.iter().position(|one| !belongs(one)).unwrap_or(rest.len());
    let (leading, others) = rest.split_at(count);
    *rest = others;
    leading
}

/// A key that ascends where scores descend; what is not a number comes last, and the two zeros are
/// equal.
pub(super) fn rank(score: f64) -> Reverse<i64> {
    let number = if score.is_nan() { f64::NEG_INFINITY } else { score + 0.0 };
    let bits = number.to_bits().cast_signed();
    // Negative numbers ascend where their bits descend.
    Reverse(if bits < 0 { bits ^ i64::MAX } else { bits })
}

#[cfg(test)]
mod tests {
    use super::*;
    use jrdb_types::PixelBox;

    const BOX: PixelBox = PixelBox { x: 0.0, y: 0.0, w: 1.0, h: 1.0 };

    fn found(category: u64, image: u64, score: f64) -> DetectionBox {
        DetectionBox { image, category, bbox: BOX, score }
    }

    #[test]
    fn what_is_not_a_number_comes_last() {
        let mut scores = [f64::NAN, 0.1, f64::INFINITY, -0.5, -0.0, 0.0, -2.0];
        scores.sort_by_key(|&score| rank(score));
        assert_eq!(scores[..6], [f64::INFINITY, 0.1, 0.0, 0.0, -0.5, -2.0]);
        assert!(scores[6].is_nan());
    }

    #[test]
    fn images_with_boxes_of_one_side_only_are_visited_in_order() {
        let truth = [(1, 9), (1, 4), (2, 4)];
        let dataset = Dataset {
            truth: truth.map(|(category, image)| GroundTruthBox::new(image, category, BOX)).into(),
            detections: vec![
                found(1, 5, 0.1),
                found(1, 4, 0.2),
                found(1, 5, 0.3),
                found(3, 1, 0.4),
            ],
        };
        let grouped = Grouped::new(&dataset);
        let scores = |group: &Group<'_>| group.detections.iter().map(|d| d.score).collect();
        let seen: Vec<Vec<(usize, Vec<f64>)>> = grouped
            .categories()
            .map(|one| one.images().map(|group| (group.truth.len(), scores(&group))).collect())
            .collect();
        let of_first = vec![(1, vec![0.2]), (0, vec![0.3, 0.1]), (1, vec![])];
        assert_eq!(seen, [of_first, vec![(1, vec![])]]);
    }
}
