//! Colours of clothes.

use std::fmt;

use serde::{Deserialize, Serialize};

vocabulary! {
    /// The eleven basic colour terms of English (Berlin and Kay 1969).
    Color {
        /// Dark whatever its hue.
        Black = "black",
        /// Bright, hardly any hue.
        White = "white",
        /// Between black and white, hardly any hue.
        Gray = "gray",
        /// As blood.
        Red = "red",
        /// As the fruit.
        Orange = "orange",
        /// As lemons.
        Yellow = "yellow",
        /// As grass.
        Green = "green",
        /// As the sky.
        Blue = "blue",
        /// As violets.
        Purple = "purple",
        /// Light red.
        Pink = "pink",
        /// Dark orange.
        Brown = "brown",
    }
}
