//! What the graph stage hands on: the scene as nodes and edges.

use serde::{Deserialize, Serialize};

use crate::artefact::Payload;
use crate::attribute::{Attribute, Attributes};
use crate::capabilities::{Capabilities, Coverage};
use crate::entity::{Between, SpatialRelation};
use crate::geometry::PixelBox;
use crate::id::{EntityId, FrameId};
use crate::issue::Issue;
use crate::vocab::{LateralConvention, PairWord};

/// A person or object: the paper's v_i = (s_i, c_i), attributes and centre.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Node {
    /// Identity.
    pub id: EntityId,
    /// Class name: `person` or the object's class.
    pub category: String,
    /// Confidence that it exists, in `[0, 1]`.
    pub score: f64,
    /// Where in the image, pixels.
    #[serde(rename = "box")]
    pub bbox: PixelBox,
    /// What is believed of it.
    #[serde(default)]
    pub attributes: Attributes,
    /// Centre `[x, y, z]`, metres, base frame (x forward, y left, z up).
    #[serde(default)]
    pub center: Option<[f64; 3]>,
    /// Direction it faces, radians counter-clockwise from +x of the base frame.
    #[serde(default)]
    pub heading_rad: Option<f64>,
    /// Height of its box in space, metres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height_m: Option<f64>,
    /// Velocity along x and y of the base frame, metres per second.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub velocity_mps: Option<[f64; 2]>,
    /// Number of the social group it belongs to, where the source tells groups; one frame's things with equal
    /// numbers are together.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub group: Option<u32>,
    /// Where it is, seen from the robot.
    #[serde(default)]
    pub from_robot: Option<SpatialRelation>,
}

impl Node {
    /// A node of which nothing but the box in the image is known.
    ///
    /// ```
    /// use jrdb_types::{EntityId, Node, PixelBox};
    /// let node = Node::new(EntityId::new("table", 1), "table", PixelBox::from([0.0, 0.0, 9.0, 9.0]));
    /// assert_eq!((node.score, node.center), (1.0, None));
    /// ```
    #[must_use]
    pub fn new(id: EntityId, category: impl Into<String>, bbox: PixelBox) -> Self {
        Self {
            id,
            category: category.into(),
            score: 1.0,
            bbox,
            attributes: Attributes::default(),
            center: None,
            heading_rad: None,
            height_m: None,
            velocity_mps: None,
            group: None,
            from_robot: None,
        }
    }
}

/// What an edge says of its two ends.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum EdgeRelation {
    /// Where `to` is, seen from `from`.
    Spatial(SpatialRelation),
    /// A word that holds of the pair (`from`, `to`).
    Pair {
        /// Which.
        word: PairWord,
        /// The number behind it: the gap of "next to", metres; the share hidden, of "in front of" and "behind".
        #[serde(default, skip_serializing_if = "Option::is_none")]
        value: Option<f64>,
    },
    /// What `from` does with `to`.
    Interaction {
        /// JRDB-Social's label.
        label: String,
    },
}

/// A directed edge.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Edge {
    /// The subject: whose frame a direction is told in.
    pub from: EntityId,
    /// The object.
    pub to: EntityId,
    /// What holds between them.
    pub relation: EdgeRelation,
}

/// One frame as a graph: nodes sorted by id, edges by ends; between two ends spatial, then pair words, then
/// interactions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SceneGraph {
    /// The frame.
    pub frame: FrameId,
    /// Which side "left" names in the words of this graph.
    pub lateral: LateralConvention,
    /// People and objects.
    pub nodes: Vec<Node>,
    /// Relations.
    pub edges: Vec<Edge>,
    /// Who is between whom, sorted by the middle one, then the ends.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub between: Vec<Between>,
    /// What could have been seen; when absent, what occurs in the graph.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub capabilities: Option<Capabilities>,
    /// What could not be built.
    #[serde(default)]
    pub issues: Vec<Issue>,
}

impl SceneGraph {
    /// A graph of these nodes, sorted by id, without edges. It holds all that there is: what is not in it is not there.
    #[must_use]
    pub fn new(frame: FrameId, lateral: LateralConvention, mut nodes: Vec<Node>) -> Self {
        nodes.sort_by(|a, b| a.id.cmp(&b.id));
        let (edges, between, issues) = (Vec::new(), Vec::new(), Vec::new());
        let capabilities = Some(Capabilities::open());
        Self { frame, lateral, nodes, edges, between, capabilities, issues }
    }
}

/// What occurs in a graph: what could be seen, where the graph does not say so itself.
#[must_use]
pub fn occurring(graph: &SceneGraph) -> Capabilities {
    let known =
        |&a: &Attribute| graph.nodes.iter().any(|node| !node.attributes.belief(a).is_unknown());
    let labels = graph.edges.iter().filter_map(|edge| match &edge.relation {
        EdgeRelation::Interaction { label } => Some(label.clone()),
        _ => None,
    });
    Capabilities {
        categories: graph.nodes.iter().map(|node| node.category.clone()).collect(),
        attributes: Attribute::ALL.iter().copied().filter(known).collect(),
        interactions: labels.collect(),
        places: Coverage::Complete,
    }
}

impl Payload for SceneGraph {
    const SCHEMA: &'static str = "jrdb.scene_graph";
    const VERSION: u32 = 2;
}
