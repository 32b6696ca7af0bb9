//! What the four numbers of boxes mean, as far as all boxes of a file tell.

use jrdb_types::{ImageGeometry, Issue, IssueKind};

/// What the four numbers of every box of a file are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Convention {
    /// Left, top, width and height, pixels: COCO's.
    Usual,
    /// Left, top, right and bottom. Sure: nothing else fits so many boxes.
    Corners,
    /// Perhaps left, top, right and bottom; read as usual.
    PerhapsCorners,
    /// Perhaps centre, width and height; read as usual.
    PerhapsCentres,
    /// Parts of the picture.
    Parts,
}

/// Fewest boxes that leave no doubt.
const MIN_BOXES: usize = 5;
/// How far a sound box may reach over an edge of the picture, pixels.
const OVER_PX: f64 = 2.0;
/// Largest number of boxes that are parts of the picture.
const MAX_PART: f64 = 1.5;
/// Part of the boxes that must be too large for the picture to doubt the usual reading.
const DOUBTFUL: f64 = 0.3;

impl Convention {
    /// What all boxes of a file are.
    pub(super) fn of(boxes: &[[f64; 4]], image: ImageGeometry) -> Self {
        let proper = boxes.iter().filter(|numbers| numbers.iter().all(|n| n.is_finite()));
        let boxes: Vec<[f64; 4]> = proper.copied().collect();
        let all = |holds: &dyn Fn(&[f64; 4]) -> bool| boxes.iter().all(holds);
        if boxes.is_empty() {
            return Self::Usual;
        }
        if all(&|numbers| numbers.iter().all(|n| (-MAX_PART..=MAX_PART).contains(n))) {
            return Self::Parts;
        }
        let (width, height) = (f64::from(image.width_px), f64::from(image.height_px));
        // Around a panorama a box may go on, but nobody fills half of it.
        let is_wide = |x: f64, w: f64| {
            if image.wraps { w > width / 2.0 } else { x + w > width + OVER_PX }
        };
        let over = |[x, y, w, h]: &[f64; 4]| y + h > height + OVER_PX || is_wide(*x, *w);
        let part = boxes.iter().filter(|b| over(b)).count() as f64 / boxes.len() as f64;
        let are_corners = all(&|[x0, y0, x1, y1]| {
            x1 > x0 && y1 > y0 && *y1 <= height + OVER_PX && (image.wraps || *x1 <= width + OVER_PX)
        });
        let are_centres =
            all(&|[_, y, _, h]| y - h / 2.0 >= -OVER_PX && y + h / 2.0 <= height + OVER_PX);
        let (is_doubtful, are_many) = (part >= DOUBTFUL, boxes.len() >= MIN_BOXES);
        match (are_corners, is_doubtful) {
            (true, true) if are_many => Self::Corners,
            (true, doubtful) if doubtful || are_many => Self::PerhapsCorners,
            (_, true) if are_centres => Self::PerhapsCentres,
            _ => Self::Usual,
        }
    }

    /// What to tell about every frame with such boxes.
    pub(super) fn issue(self) -> Option<Issue> {
        let (kind, message) = match self {
            Self::Usual => return None,
            Self::Corners => (
                IssueKind::DoubtfulInput,
                "the boxes are corners (x1 y1 x2 y2) and were read so; COCO's are x y width height",
            ),
            Self::PerhapsCorners => (
                IssueKind::DoubtfulInput,
                "the boxes were read as x y width height in pixels; they may be corners (x1 y1 x2 y2)",
            ),
            Self::PerhapsCentres => (
                IssueKind::DoubtfulInput,
                "the boxes reach out of the picture as x y width height in pixels, which they were read as; \
                 x and y may be their centres",
            ),
            Self::Parts => (
                IssueKind::MissingInput,
                "the boxes are normalised (0 to 1 of the picture); expected x y width height in pixels: \
                 none could be used",
            ),
        };
        Some(Issue::new(kind, message))
    }
}

/// A box as left, top, width and height, pixels; none where that is not known.
pub(super) fn in_pixels(numbers: [f64; 4], convention: Convention) -> Option<[f64; 4]> {
    let [x0, y0, x1, y1] = numbers;
    match convention {
        Convention::Corners => Some([x0, y0, x1 - x0, y1 - y0]),
        Convention::Parts => None,
        _ => Some(numbers),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const IMAGE: ImageGeometry = ImageGeometry { width_px: 1000, height_px: 480, wraps: true };

    /// Boxes of people of several distances, left, top, width and height.
    fn usual() -> Vec<[f64; 4]> {
        (0..8)
            .map(|i| [900.0 - 110.0 * f64::from(i), 150.0, 60.0, 200.0 + 10.0 * f64::from(i)])
            .collect()
    }

    fn convention(change: impl Fn([f64; 4]) -> [f64; 4]) -> Convention {
        let boxes: Vec<_> = usual().into_iter().map(change).collect();
        Convention::of(&boxes, IMAGE)
    }

    #[test]
    fn each_convention_is_known_by_all_boxes() {
        assert_eq!(convention(|b| b), Convention::Usual);
        assert_eq!(convention(|[x, y, w, h]| [x, y, x + w, y + h]), Convention::Corners);
        let below = |[x, y, w, h]: [f64; 4]| [x + w / 2.0, y + 20.0 + h / 2.0, w, h];
        assert_eq!(convention(below), Convention::PerhapsCentres);
        let parts = |[x, y, w, h]: [f64; 4]| [x / 1000.0, y / 480.0, w / 1000.0, h / 480.0];
        assert_eq!(convention(parts), Convention::Parts);
        assert_eq!(
            Convention::of(&[[10.0, 300.0, 60.0, 470.0]], IMAGE),
            Convention::PerhapsCorners
        );
        assert_eq!(Convention::of(&[], IMAGE), Convention::Usual);
    }

    #[test]
    fn corners_become_sizes() {
        assert_eq!(
            in_pixels([1.0, 2.0, 4.0, 8.0], Convention::Corners),
            Some([1.0, 2.0, 3.0, 6.0])
        );
    }
}
