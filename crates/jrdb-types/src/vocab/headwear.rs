//! What people wear on the head.

use std::fmt;

use serde::{Deserialize, Serialize};

vocabulary! {
    /// What a person wears on the head.
    Headwear {
        /// Nothing.
        None = "none",
        /// With a peak and without a brim.
        Cap = "cap",
        /// With a brim, or of wool.
        Hat = "hat",
        /// Hard, against blows.
        Helmet = "helmet",
        /// A cloth around the head.
        Headscarf = "headscarf",
    }
}
