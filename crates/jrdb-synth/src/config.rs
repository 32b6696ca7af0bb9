//! Which world to make.

use jrdb_types::vocab::Headwear;
use serde::{Deserialize, Serialize};

use crate::room::Setting;

/// Which world to make.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SynthConfig {
    /// Another seed is another world; the same configuration gives the same bytes.
    pub seed: u64,
    /// How many people; at most 60, and fewer when the room is too small for them.
    pub people: usize,
    /// How many frames, a third of a second apart.
    pub frames: u32,
    /// What kind of place.
    pub setting: Setting,
    /// Name of the sequence.
    pub sequence: String,
    /// What each person wears on the head, in the order of their numbers. It is true of them and not drawn, but for the
    /// caps of adolescents. Of people beyond the list, adolescents wear a cap and others nothing.
    pub headwear: Vec<Headwear>,
}

impl Default for SynthConfig {
    /// Eight people on a plaza, one frame: enough for every kind of question.
    fn default() -> Self {
        let (setting, sequence) = (Setting::default(), "synth_0".into());
        Self { seed: 0, people: 8, frames: 1, setting, sequence, headwear: Vec::new() }
    }
}
