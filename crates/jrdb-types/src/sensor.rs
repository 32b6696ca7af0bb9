//! What the sensors gave: pixels and points, in memory only.

/// An image of 8-bit RGB pixels.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Image {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// `3 · width · height` bytes: red, green, blue, row by row from the top.
    pub rgb: Vec<u8>,
}

impl Image {
    /// A picture of one colour.
    #[must_use]
    pub fn filled(width: usize, height: usize, color: [u8; 3]) -> Self {
        Self { width, height, rgb: color.repeat(width * height) }
    }

    /// The colour of a pixel.
    ///
    /// # Panics
    /// When the pixel is outside the image.
    #[must_use]
    pub fn pixel(&self, x: usize, y: usize) -> [u8; 3] {
        let at = 3 * (y * self.width + x);
        [self.rgb[at], self.rgb[at + 1], self.rgb[at + 2]]
    }
}

/// Points of one LiDAR sweep in the sensor's frame (x forward, y left, z up), metres; the arrays are
/// equally long.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PointCloud {
    /// Sensor name, as in the rig.
    pub sensor: String,
    /// Forward, metres.
    pub x: Vec<f32>,
    /// Left, metres.
    pub y: Vec<f32>,
    /// Up, metres.
    pub z: Vec<f32>,
    /// Strength of the return in the sensor's own scale; empty when the file has none.
    pub intensity: Vec<f32>,
    /// Rows of the file that had a non-finite coordinate and are not among the points.
    pub skipped: usize,
}

impl PointCloud {
    /// Number of points.
    #[must_use]
    pub fn len(&self) -> usize {
        self.x.len()
    }

    /// Whether there is no point.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }
}
