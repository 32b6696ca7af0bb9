#![doc = include_str!("../README.md")]

mod brief;
mod budget;
pub mod calibration;
mod change;
mod chart;
mod check;
mod comparison;
mod explain;
mod issue;
mod property;
mod query;
mod reply;
mod scores;
mod why_not;
mod wording;
mod words;

pub use brief::{brief, ids};
pub use budget::{budget, confusion, reliability};
pub use change::change;
pub use chart::{budget_chart, reliability_chart};
pub use check::{asked, found};
pub use comparison::{comparison, distinguishable};
pub use explain::explain;
pub use issue::{notes, query_issue};
pub use property::property_value;
pub use query::query;
pub use reply::headline;
pub use scores::{intervals, scores, truth};
pub use why_not::{miss, why_not};
pub use wording::{condition, pattern};
pub use words::with_words;
