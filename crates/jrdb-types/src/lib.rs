#![doc = include_str!("../README.md")]

pub mod answer;
pub mod artefact;
pub mod attribute;
pub mod calibration;
pub mod capabilities;
mod causes;
mod contained;
pub mod detection;
pub mod entity;
pub mod geometry;
pub mod graph;
pub mod id;
pub mod issue;
pub mod lens;
pub mod object;
pub mod query;
pub mod question;
pub mod rig;
#[cfg(feature = "schema")]
pub mod schema;
pub mod score;
pub mod sensor;
pub mod vocab;

pub use answer::{Answer, Status};
pub use artefact::{Artefact, ArtefactError, Payload};
pub use attribute::{
    Attribute, AttributeBelief, AttributeNotation, AttributeRow, AttributeSource, AttributeValue,
    AttributeWording, Attributes, Belief,
};
pub use capabilities::{Capabilities, Coverage, Vocabulary};
pub use causes::with_causes;
pub use contained::{Panicked, contained, is_contained};
pub use detection::{Detection, Detections};
pub use entity::{Entities, Entity, Heading, Localizer, PairRelation, Position, SpatialRelation};
pub use geometry::{Box3d, BoxError, FloorPlane, ImageGeometry, PixelBox};
pub use graph::{Edge, EdgeRelation, Node, SceneGraph};
pub use id::{EntityId, FrameId};
pub use issue::{Issue, IssueKind, Span};
pub use lens::{CylindricalPanorama, LensModel};
pub use query::{
    Condition, Pattern, Place, Quantity, Query, Related, RelationKind, Task, Viewpoint,
};
pub use question::{Question, Questions, Truth};
pub use rig::{Camera, Lidar, Rig, Rotation, Transform};
pub use score::{Comparison, Scores};
pub use sensor::{Image, PointCloud};
pub use vocab::{Action, Age, Direction, DistanceWord, Gender, LateralConvention, Race};
