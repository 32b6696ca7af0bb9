//! Where the tests look for an ONNX Runtime library.

use std::path::PathBuf;
use std::process::Command;

use jrdb_perception::OrtLibrary;

const ASK_PYTHON: &str = "import glob, importlib.util as u, os; \
    print(glob.glob(os.path.join(os.path.dirname(u.find_spec('onnxruntime').origin), 'capi', 'libonnxruntime.so*'))[0])";

fn path() -> Option<PathBuf> {
    if let Some(path) = std::env::var_os("ORT_DYLIB_PATH") {
        return Some(path.into());
    }
    let output = Command::new("python3").args(["-c", ASK_PYTHON]).output().ok()?;
    let line = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| line.trim().into())
}

/// The library named by `ORT_DYLIB_PATH`, else that of Python's onnxruntime package.
pub(crate) fn find() -> Option<OrtLibrary> {
    let found = path().map(|path| OrtLibrary::load(&path).unwrap());
    if found.is_none() {
        println!("skipped: no onnxruntime");
    }
    found
}
