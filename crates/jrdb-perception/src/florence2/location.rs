//! Locations in Florence-2's text: boxes on a grid of bins.

/// A box in location bins: x0, y0, x1, y1 in 0..=999.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LocationBox(pub [u16; 4]);

/// Bins per side of the picture.
pub(super) const BINS: f64 = 1000.0;

impl LocationBox {
    /// The bins of a box given by its corners, pixels of a picture of that size.
    ///
    /// ```
    /// use jrdb_perception::florence2::LocationBox;
    /// assert_eq!(LocationBox::from_corners([3.76, 0.48, 7.52, 480.0], [3760.0, 480.0]).0, [1, 1, 2, 999]);
    /// ```
    #[must_use]
    pub fn from_corners(corners: [f64; 4], size_px: [f64; 2]) -> Self {
        let bin = |axis: usize| {
            let bins = corners[axis] / (size_px[axis % 2] / BINS);
            bins.floor().clamp(0.0, BINS - 1.0) as u16
        };
        Self([bin(0), bin(1), bin(2), bin(3)])
    }

    pub(super) fn tags(self) -> String {
        self.0.map(|bin| format!("<loc_{bin}>")).concat()
    }

    pub(super) fn from_tags(text: &str) -> Option<Self> {
        let mut bins = text.strip_prefix("<loc_")?.strip_suffix('>')?.split("><loc_");
        let mut next = || bins.next()?.parse::<u16>().ok().filter(|bin| f64::from(*bin) < BINS);
        let region = Self([next()?, next()?, next()?, next()?]);
        bins.next().is_none().then_some(region)
    }
}
