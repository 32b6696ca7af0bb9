#![doc = include_str!("../README.md")]

pub mod backbone;
pub mod catalogue;
mod digest;
mod error;
pub mod fetch;
pub mod light;
pub mod loader;
pub mod profile;
mod python;
pub mod quality;
pub mod trial;

pub use digest::sha256_hex;
pub use error::Error;
