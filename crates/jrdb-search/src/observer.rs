//! From where a direction is stated, and how well that is known.

use jrdb_types::LateralConvention;

use crate::SearchConfig;

/// Whose front a direction is relative to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Front {
    /// The robot's, or a line from the robot: known.
    OfRobot,
    /// A person's: known as well as the configuration states.
    OfPerson,
}

/// Who a place is seen by, under which names of the sides.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Observer<'c> {
    pub(crate) lateral: LateralConvention,
    pub(crate) front: Front,
    pub(crate) config: &'c SearchConfig,
}

impl Observer<'_> {
    /// Standard deviation of the front's direction, radians.
    pub(crate) fn heading_sigma_rad(&self) -> f64 {
        match self.front {
            Front::OfRobot => 0.0,
            Front::OfPerson => self.config.heading_sigma_rad,
        }
    }
}
