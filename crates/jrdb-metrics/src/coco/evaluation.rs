//! What an evaluation computes, and the reference evaluator's summary of it.

use super::config::Area;

/// Precision and recall of one category at one IoU threshold, area range and limit of detections.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// The category.
    pub category: u64,
    /// Index into [`iou_thresholds`](crate::coco::iou_thresholds).
    pub threshold: usize,
    /// The range of area.
    pub area: Area,
    /// The limit of detections per image.
    pub max_detections: usize,
    /// Interpolated precision at recall 0, 0.01 … 1.
    pub precision: Vec<f64>,
    /// Recall with all detections.
    pub recall: f64,
}

impl Curve {
    /// Mean of the interpolated precision over the 101 recall points, in `[0, 1]`.
    #[must_use]
    pub fn average_precision(&self) -> f64 {
        self.precision.iter().sum::<f64>() / self.precision.len() as f64
    }
}

/// The statistics of the reference evaluator; -1 where there is no ground truth.
#[derive(Debug, Clone, PartialEq)]
pub struct Statistics {
    /// Average precision over the ten thresholds with the greatest limit: mAP@[.50:.95].
    pub ap: f64,
    /// Average precision at IoU 0.50.
    pub ap50: f64,
    /// Average precision at IoU 0.75.
    pub ap75: f64,
    /// As `ap`, of [`Area::Small`], [`Area::Medium`] and [`Area::Large`].
    pub ap_by_area: [f64; 3],
    /// Average recall over the ten thresholds, for each limit of detections in ascending order.
    pub ar: Vec<f64>,
    /// As the last of `ar`, of [`Area::Small`], [`Area::Medium`] and [`Area::Large`].
    pub ar_by_area: [f64; 3],
}

impl Statistics {
    /// The numbers in the reference evaluator's order; twelve with three limits of detections.
    #[must_use]
    pub fn to_vec(&self) -> Vec<f64> {
        let mut all = vec![self.ap, self.ap50, self.ap75];
        all.extend(self.ap_by_area);
        all.extend(&self.ar);
        all.extend(self.ar_by_area);
        all
    }
}

/// Everything that was computed.
#[derive(Debug, Clone, PartialEq)]
pub struct Evaluation {
    /// A curve for each combination that has ground truth.
    pub curves: Vec<Curve>,
    /// The limits of detections, ascending.
    pub max_detections: Vec<usize>,
}

impl Evaluation {
    /// Mean average precision of the chosen curves; -1 if none is chosen.
    pub fn mean_ap(&self, chosen: impl Fn(&Curve) -> bool) -> f64 {
        mean(self.curves.iter().filter(|c| chosen(c)).map(Curve::average_precision))
    }

    /// Mean recall of the chosen curves; -1 if none is chosen.
    pub fn mean_recall(&self, chosen: impl Fn(&Curve) -> bool) -> f64 {
        mean(self.curves.iter().filter(|c| chosen(c)).map(|c| c.recall))
    }

    /// mAP@[.50:.95] of one category; -1 where it has no ground truth.
    #[must_use]
    pub fn category_ap(&self, category: u64) -> f64 {
        self.mean_ap(|c| {
            c.category == category && c.area == Area::All && Some(c.max_detections) == self.most()
        })
    }

    /// The reference evaluator's summary.
    #[must_use]
    pub fn statistics(&self) -> Statistics {
        const AT_75: usize = 5;
        let most = self.most();
        let whole = |c: &Curve, area| c.area == area && Some(c.max_detections) == most;
        let by_area = [Area::Small, Area::Medium, Area::Large];
        let limits = self.max_detections.iter();
        Statistics {
            ap: self.mean_ap(|c| whole(c, Area::All)),
            ap50: self.mean_ap(|c| whole(c, Area::All) && c.threshold == 0),
            ap75: self.mean_ap(|c| whole(c, Area::All) && c.threshold == AT_75),
            ap_by_area: by_area.map(|area| self.mean_ap(|c| whole(c, area))),
            ar: limits
                .map(|&n| self.mean_recall(|c| c.area == Area::All && c.max_detections == n))
                .collect(),
            ar_by_area: by_area.map(|area| self.mean_recall(|c| whole(c, area))),
        }
    }

    fn most(&self) -> Option<usize> {
        self.max_detections.last().copied()
    }
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0_usize), |(sum, count), v| (sum + v, count + 1));
    if count == 0 { -1.0 } else { sum / count as f64 }
}
