//! Every number and choice that shapes the search stage.

use jrdb_types::vocab::MatchPolicy;
use serde::{Deserialize, Serialize};

/// Whether the several relations of one phrase must hold with one partner.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Existentials {
    /// All with the same partner.
    #[default]
    Same,
    /// As JRDB-Reasoning's engine: what one edge says holds with one partner (distance and direction together), what
    /// another edge says perhaps with another.
    Independent,
}

/// Whether what is asked one after the other must be seen one after the other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SlotOrder {
    /// In this order, by the same track.
    #[default]
    Enforced,
    /// As JRDB-Reasoning's engine: every slot has its own answer.
    Independent,
}

/// How the conditions of one question come together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Pooling {
    /// They hold of one thing at one moment.
    #[default]
    Together,
    /// As JRDB-Reasoning's engine: every condition collects (thing, box) over the frames of the slot, and the
    /// collections that are not empty are intersected. What nothing satisfies is not asked for.
    PerCondition,
}

/// What the absence of a thing from the graph means.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum World {
    /// It is evidence only for what perception can see, as [`jrdb_types::Capabilities`] states it.
    #[default]
    Open,
    /// As JRDB-Reasoning's engine: what is not in the graph does not exist.
    Closed,
}

/// Configuration of [`crate::search`]. It is written into the artefact.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SearchConfig {
    /// How many of the asked attributes a candidate must have.
    pub policy: MatchPolicy,
    /// Whether several relations of one phrase hold with one partner.
    pub existentials: Existentials,
    /// Whether "and then" is demanded.
    pub order: SlotOrder,
    /// How conditions come together.
    pub pooling: Pooling,
    /// What absence means.
    pub world: World,
    /// Standard deviation of a position, metres. It turns a distance or direction near a bound into a
    /// probability; what holds is decided by the words alone.
    pub position_sigma_m: f64,
    /// Standard deviation of a person's heading, radians, where the graph does not say how certain a sector is.
    pub heading_sigma_rad: f64,
    /// For the ranking only: an age group that is believed counts for its neighbours at this probability, for the next but
    /// one at its square, and so on, where the belief gives them less. Ages are ordered, and whoever takes an adolescent for a
    /// young adult errs less than whoever takes a pensioner for one. An age believed for sure keeps probability 1.
    pub age_neighbor_probability: f64,
    /// People without a group number are together up to this distance, metres; so near is "next to" the robot.
    pub close_m: f64,
    /// "Between" the robot and something holds up to this distance from the straight line, metres.
    pub between_max_offset_m: f64,
    /// Whoever is "between" the robot and something is so far along the line from either end, metres.
    pub between_min_inside_m: f64,
    /// Somebody faces the robot within this angle to either side, degrees: the benchmark's sector "front".
    pub facing_half_angle_deg: f64,
    /// Frames in a second of a recording.
    pub frames_per_second: f64,
}

impl Default for SearchConfig {
    /// The deviations are the median errors of the default localiser (0.14 m) and of JRDB's heading labels (8.6°) on real
    /// frames of JRDB's sequence bytes-cafe-2019-02-07_0. Close is the benchmark's word, "between" as the projection
    /// stage has it between two things, 15 frames per second JRDB's recordings. One in twenty is the share of age
    /// labels that we would expect another annotator to move by one group.
    fn default() -> Self {
        Self {
            policy: MatchPolicy::Ranked,
            existentials: Existentials::Same,
            order: SlotOrder::Enforced,
            pooling: Pooling::Together,
            world: World::Open,
            position_sigma_m: 0.14,
            heading_sigma_rad: 0.15,
            age_neighbor_probability: 0.05,
            close_m: 1.5,
            between_max_offset_m: 0.5,
            between_min_inside_m: 0.3,
            facing_half_angle_deg: 30.0,
            frames_per_second: 15.0,
        }
    }
}

impl SearchConfig {
    /// What JRDB-Reasoning's engine does: its answers are the benchmark's ground truth.
    #[must_use]
    pub fn benchmark() -> Self {
        Self {
            policy: MatchPolicy::Strict,
            existentials: Existentials::Independent,
            order: SlotOrder::Independent,
            pooling: Pooling::PerCondition,
            world: World::Closed,
            ..Self::default()
        }
    }

    /// The same with another policy.
    #[must_use]
    pub(crate) fn with(self, policy: MatchPolicy) -> Self {
        Self { policy, ..self }
    }
}
