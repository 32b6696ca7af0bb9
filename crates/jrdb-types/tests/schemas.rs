//! The committed JSON Schemas are those of the types. Rewrite them with
//! `UPDATE_SCHEMAS=1 cargo test -p jrdb-types --features schema`.
#![cfg(feature = "schema")]
#![allow(clippy::unwrap_used, reason = "a failing helper should panic")]

use std::path::{Path, PathBuf};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../schemas")
}

#[test]
fn committed_schemas_are_those_of_the_types() {
    let rewrite = std::env::var_os("UPDATE_SCHEMAS").is_some();
    for artefact in jrdb_types::schema::all() {
        let path = folder().join(artefact.file_name());
        if rewrite {
            std::fs::write(&path, artefact.to_json()).unwrap();
        }
        let committed = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(
            committed == artefact.to_json(),
            "{} differs; read the head of this test",
            path.display()
        );
    }
}

#[test]
fn no_schema_is_left_over() {
    let known: Vec<String> = jrdb_types::schema::all()
        .iter()
        .map(jrdb_types::schema::ArtefactSchema::file_name)
        .collect();
    for entry in std::fs::read_dir(folder()).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        assert!(known.contains(&name), "{name} is the schema of nothing");
    }
}
