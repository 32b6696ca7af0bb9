#![doc = include_str!("../README.md")]

mod compare;
mod config;
mod error;
mod fit;
mod floor;
mod least_squares;
mod plane;
#[cfg(test)]
mod scene;
mod vote;

pub use compare::compare_floors;
pub use config::FloorConfig;
pub use error::Error;
pub use fit::{FitConfig, Sweep, View, about, check_fit, refine};
pub use floor::fit_floor;
pub use jrdb_types::calibration::{
    Doubt, Finding, FitReport, Floor, FloorAgreement, FloorDifference, Freedom, LidarFit, Measure,
    Motion, RefinedFreedom, RefinedLidar, Refinement, SensorFloor, Verdict,
};
pub use nalgebra;
