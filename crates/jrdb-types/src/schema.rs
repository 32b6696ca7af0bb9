//! JSON Schemas of every artefact, for programs in other languages.

use schemars::{JsonSchema, Schema, schema_for};

use crate::{
    Answer, Artefact, Comparison, Detections, Entities, Payload, Query, Questions, Rig, SceneGraph,
    Scores,
};

/// The schema of one artefact.
#[derive(Debug, Clone, PartialEq)]
pub struct ArtefactSchema {
    /// [`Payload::SCHEMA`].
    pub name: &'static str,
    /// [`Payload::VERSION`].
    pub version: u32,
    /// JSON Schema of the whole artefact, envelope included.
    pub schema: Schema,
}

impl ArtefactSchema {
    fn of<T: Payload + JsonSchema>() -> Self {
        let mut schema = schema_for!(Artefact<T>);
        schema.insert("title".into(), T::SCHEMA.into());
        // The envelope's two fixed fields, so that a validator refuses another artefact.
        for (field, value) in [("schema", T::SCHEMA.into()), ("schema_version", T::VERSION.into())]
        {
            let pointer = format!("/properties/{field}");
            if let Some(field) =
                schema.pointer_mut(&pointer).and_then(serde_json::Value::as_object_mut)
            {
                field.insert("const".into(), value);
            }
        }
        Self { name: T::SCHEMA, version: T::VERSION, schema }
    }

    /// The file's name under `schemas/`: `jrdb.query.v1.json`.
    #[must_use]
    pub fn file_name(&self) -> String {
        format!("{}.v{}.json", self.name, self.version)
    }

    /// The schema as indented JSON with a final newline.
    ///
    /// # Panics
    /// Never: a schema's keys are strings.
    #[must_use]
    pub fn to_json(&self) -> String {
        let mut text = serde_json::to_string_pretty(&self.schema).expect("schema keys are strings");
        text.push('\n');
        text
    }
}

/// Every artefact's schema, in the order of the pipeline.
#[must_use]
pub fn all() -> Vec<ArtefactSchema> {
    vec![
        ArtefactSchema::of::<Rig>(),
        ArtefactSchema::of::<Detections>(),
        ArtefactSchema::of::<Entities>(),
        ArtefactSchema::of::<SceneGraph>(),
        ArtefactSchema::of::<Query>(),
        ArtefactSchema::of::<Answer>(),
        ArtefactSchema::of::<Questions>(),
        ArtefactSchema::of::<Scores>(),
        ArtefactSchema::of::<Comparison>(),
    ]
}
