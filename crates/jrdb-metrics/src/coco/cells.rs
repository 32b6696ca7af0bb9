//! Sets of cells: a bit for each pair of an area range and an IoU threshold, so that one step of
//! matching decides all forty pairs.

use super::config::{Area, iou_thresholds};

/// A set of cells.
pub(super) type Cells = u64;

/// Every cell.
pub(super) const ALL_CELLS: Cells = Cells::MAX;
/// The lowest threshold of each area range.
const LOWEST: Cells = 0x0001_0001_0001_0001;
/// Bits between the same threshold of two area ranges.
const AREA_BITS: u32 = 16;
/// Every threshold of the first area range.
const THRESHOLDS: Cells = (1 << 10) - 1;

/// The cell of an area range and of an index into [`iou_thresholds`].
pub(super) fn cell(area: Area, threshold: usize) -> Cells {
    1 << (area as u32 * AREA_BITS + threshold as u32)
}

/// The cells of every area range that contains an area.
pub(super) fn cells_of_area(area_px2: f64) -> Cells {
    let containing = Area::ALL.into_iter().filter(|area| area.contains(area_px2));
    containing.fold(0, |cells, area| cells | THRESHOLDS << (area as u32 * AREA_BITS))
}

/// The cells of every threshold that an IoU reaches.
pub(super) fn cells_of_iou(iou: f64) -> Cells {
    let reached = iou_thresholds().iter().filter(|&&threshold| threshold <= iou).count();
    LOWEST * ((1 << reached) - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_iou_reaches_the_thresholds_up_to_itself_in_every_area_range() {
        assert_eq!(cells_of_iou(0.49), 0);
        assert_eq!(cells_of_iou(f64::NAN), 0);
        let at_half = Area::ALL.iter().fold(0, |cells, &area| cells | cell(area, 0));
        assert_eq!(cells_of_iou(0.5), at_half);
        assert_eq!(cells_of_iou(1.0).count_ones(), 40);
    }

    #[test]
    fn the_bound_of_two_area_ranges_is_in_both() {
        let both = cells_of_area(32.0 * 32.0);
        let ranges = Area::ALL.map(|area| both & cell(area, 9) != 0);
        assert_eq!(ranges, [true, true, true, false]);
        assert_eq!(cells_of_area(-1.0), 0);
    }
}
