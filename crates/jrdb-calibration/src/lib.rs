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

pub use compare::{FloorAgreement, FloorDifference, SensorFloor, compare_floors};
pub use config::FloorConfig;
pub use error::Error;
pub use fit::{
    Doubt, Finding, FitConfig, FitReport, Freedom, LidarFit, Measure, Motion, RefinedFreedom,
    RefinedLidar, Refinement, Sweep, Verdict, View, check_fit, refine,
};
pub use floor::{Floor, fit_floor};
pub use nalgebra;
