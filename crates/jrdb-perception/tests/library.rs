//! Files that are no ONNX Runtime library are errors. No library may be loaded in this process.

use std::path::Path;

use jrdb_perception::{EngineError, OrtLibrary};

#[test]
fn what_is_no_library_is_an_error_that_names_the_file() {
    let manifest = concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml");
    let mut files = vec!["/no/such/libonnxruntime.so", manifest];
    if cfg!(target_os = "linux") {
        files.push("libc.so.6"); // a library, but another one
    }
    for file in files {
        let error = OrtLibrary::load(Path::new(file)).unwrap_err();
        assert!(matches!(&error, EngineError::Library { path, .. } if path == Path::new(file)));
        let expected =
            format!("expected an ONNX Runtime library of version 1.17 or later at {file:?}");
        assert_eq!(error.to_string(), expected);
    }
}
