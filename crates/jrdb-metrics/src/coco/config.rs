//! How to evaluate: area ranges, IoU thresholds and limits of detections.

/// Which true boxes count, by area; bounds inclusive, in square pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Area {
    /// Up to 1e5² (practically all).
    All,
    /// Up to 32².
    Small,
    /// From 32² to 96².
    Medium,
    /// From 96².
    Large,
}

impl Area {
    /// Every range.
    pub const ALL: [Self; 4] = [Self::All, Self::Small, Self::Medium, Self::Large];

    /// Least and greatest area, square pixels, both inclusive.
    #[must_use]
    pub const fn bounds_px2(self) -> (f64, f64) {
        const SMALL: f64 = 32.0 * 32.0;
        const LARGE: f64 = 96.0 * 96.0;
        const END: f64 = 1e10;
        match self {
            Self::All => (0.0, END),
            Self::Small => (0.0, SMALL),
            Self::Medium => (SMALL, LARGE),
            Self::Large => (LARGE, END),
        }
    }

    pub(super) fn contains(self, area_px2: f64) -> bool {
        let (least, greatest) = self.bounds_px2();
        let outside = area_px2 < least || area_px2 > greatest;
        !outside
    }
}

/// How to evaluate.
#[derive(Debug, Clone, PartialEq)]
pub struct Config {
    /// Circumference of the panorama, pixels, for IoU on the circle; on the plane when absent.
    pub period_px: Option<f64>,
    /// How many detections per image and category may count: one evaluation for each limit.
    pub max_detections: Vec<usize>,
    /// Which ranges of area to evaluate.
    pub areas: Vec<Area>,
}

impl Default for Config {
    /// COCO's: on the plane, at most 1, 10 and 100 detections, all four ranges of area.
    fn default() -> Self {
        Self { period_px: None, max_detections: vec![1, 10, 100], areas: Area::ALL.to_vec() }
    }
}

/// The first and the last of the IoU thresholds.
pub(super) const LOWEST_IOU: f64 = 0.5;
const HIGHEST_IOU: f64 = 0.95;

/// COCO's IoU thresholds 0.50, 0.55 … 0.95, to the last bit those of the reference evaluator.
#[must_use]
pub fn iou_thresholds() -> [f64; 10] {
    let step = (HIGHEST_IOU - LOWEST_IOU) / 9.0;
    let mut thresholds = std::array::from_fn(|i| i as f64 * step + LOWEST_IOU);
    thresholds[9] = HIGHEST_IOU;
    thresholds
}
