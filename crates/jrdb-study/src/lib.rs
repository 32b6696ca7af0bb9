#![doc = include_str!("../README.md")]

mod fill;
mod inject;
mod paper;
mod placement;
mod plan;
mod same;
mod table;
mod write;

pub use fill::{MethodResult, heading, parameter_table, table};
pub use inject::{TRUTHS, Truths, Views, inject};
pub use paper::{METRICS, Paper, Printed};
pub use placement::{PlacedPerson, Placements, Side, SidePair, range_name};
pub use plan::{Data, Intervals, Method, Plan, PlanError, TablePlan};
pub use table::{Cell, Mark, Origin, Role, Row, Table, Unit};
pub use write::{csv, latex, markdown, text};
