//! Which world to make.

use jrdb_types::vocab::Headwear;
use serde::{Deserialize, Serialize};

use crate::feature::Feature;
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
    /// How each person looks beyond the attributes, in the order of their numbers. It is drawn. Empty draws people
    /// as ever; [`with_looks`](crate::with_looks) deals looks. A world states everything that is true of its people,
    /// skirts, rucksacks, canes and long hair included.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub looks: Vec<Vec<Feature>>,
}

impl Default for SynthConfig {
    /// Eight people on a plaza, one frame: enough for every kind of question.
    fn default() -> Self {
        let (setting, sequence) = (Setting::default(), "synth_0".into());
        let (headwear, looks) = Default::default();
        Self { seed: 0, people: 8, frames: 1, setting, sequence, headwear, looks }
    }
}
