#![doc = include_str!("../README.md")]

mod check;
mod config;
mod probability;
mod search;
#[cfg(test)]
mod tests;
mod wording;

pub use config::SearchConfig;
pub use search::search;
pub use wording::describe;
