#![doc = include_str!("../README.md")]

mod cursor;
mod grammar;
mod lexicon;
mod suggest;
#[cfg(test)]
mod tests;
mod token;

pub use grammar::parse;
