//! Light on colours.

use crate::room::Color;

/// A colour in more or less light.
pub(super) fn shade(color: Color, light: f64) -> Color {
    color.map(|value| (f64::from(value) * light).clamp(0.0, 255.0) as u8)
}
