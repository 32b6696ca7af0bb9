//! Our kernels beside what people run today, on the same inputs in one session.
//!
//! The others' programs are Python scripts outside the repository, which also make the inputs.

mod table;

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail};
use serde_json::Value;

use crate::program::{cargo, refuse, root, target, usage};
use table::{Ours, Peers};

/// The research data, from the workspace's root, unless `JRDB_SHARED` names another folder.
const SHARED: &str = "../shared";

/// The others' scripts in it.
const SCRIPTS: &str = "bench/peers";

/// A group of inputs, and the script that times the others on them.
struct Group {
    name: &'static str,
    /// The last of its files that is written.
    last: &'static str,
    script: &'static str,
    /// What the script is called with.
    arguments: &'static [&'static str],
}

const fn group(name: &'static str, last: &'static str, script: &'static str) -> Group {
    Group { name, last, script, arguments: &[] }
}

const GROUPS: [Group; 7] = [
    group("a", "a/reference.json", "bench_a_projection.py"),
    group("b", "b/lower_odd.pcd", "bench_b_pcd.py"),
    group("c", "c/obb_500.npy", "bench_c_relations.py"),
    group("d", "d/queries.json", "bench_d_query.py"),
    Group { arguments: &IMAGES, ..group("e", "e/dt_10000.json", "bench_e_coco.py") },
    group("f", "f/texts.json", "bench_f_parse.py"),
    group("g", "g/crops.json", "bench_g_image.py"),
];

/// How many images the COCO evaluations are of. The slowest reference is run on the first only.
const IMAGES: [&str; 2] = ["100", "10000"];

/// The only inputs that are not made with numpy alone: where they cannot be made, their cases are not run.
const PICTURES: &str = "g";

/// Our programs, which check and time what is ours.
const OURS: [&str; 2] = ["peer_kernels", "peer_queries"];

/// Python modules that the peers are, or need, and the packages that have them. Only the first is a must.
const MODULES: [(&str, &str); 19] = [
    ("numpy", "numpy"),
    ("numba", "numba"),
    ("shapely", "shapely"),
    ("pypcd4", "pypcd4"),
    ("lzf", "python-neo-lzf"),
    ("PIL", "pillow"),
    ("torch", "torch"),
    ("open3d", "open3d"),
    ("cv2", "opencv-python-headless"),
    ("networkx", "networkx"),
    ("rustworkx", "rustworkx"),
    ("duckdb", "duckdb"),
    ("kuzu", "kuzu"),
    ("pyoxigraph", "pyoxigraph"),
    ("hotcoco", "hotcoco"),
    ("faster_coco_eval", "faster-coco-eval"),
    ("pycocotools", "pycocotools"),
    ("lark", "lark"),
    ("spacy", "spacy"),
];

/// Prints the version of each `module=package` that there is, and an empty line for the others.
const VERSIONS: &str = "\
import importlib.metadata, importlib.util, sys
for module, package in (pair.split('=') for pair in sys.argv[1:]):
    try:
        print(importlib.metadata.version(package) if importlib.util.find_spec(module) else '')
    except importlib.metadata.PackageNotFoundError:
        print('of unknown version')
";

pub(crate) fn peers(flags: &[String]) -> Result<()> {
    let session = Session::new(flags)?;
    session.show_packages()?;
    session.make_inputs()?;
    let before = session.ours()?;
    for group in &GROUPS {
        session.time(group)?;
    }
    let ours = before.better_of(session.ours()?);
    let peers = Peers::parse(&session.results()?);
    print!("{}", table::render(&ours, &peers));
    if let Ok(load) = fs::read_to_string("/proc/loadavg") {
        println!("load of this machine over 1, 5 and 15 minutes: {}", load.trim());
    }
    match ours.faults(&peers).as_slice() {
        [] => Ok(()),
        faults => bail!("wrong results: {}", faults.join("; ")),
    }
}

/// Where everything is.
struct Session {
    scripts: PathBuf,
    python: PathBuf,
    folder: PathBuf,
}

impl Session {
    fn new(flags: &[String]) -> Result<Self> {
        let shared = std::env::var_os("JRDB_SHARED").map_or_else(|| SHARED.into(), PathBuf::from);
        let mut scripts = root().join(shared).join(SCRIPTS);
        let mut python = PathBuf::from("python3");
        for flag in flags.chunks(2) {
            match flag {
                [name, path] if name == "--peers" => scripts = absolute(path)?,
                // A bare name is looked for as the shell does; a path may lead into an environment through a link.
                [name, path] if name == "--python" && !path.contains('/') => python = path.into(),
                [name, path] if name == "--python" => python = absolute(path)?,
                other => return usage("--peers DIR or --python PATH", other),
            }
        }
        if !scripts.join("gen_inputs.py").is_file() {
            let place = scripts.display();
            return refuse(&format!(
                "no peers in {place}: expected gen_inputs.py there; say where with --peers DIR"
            ));
        }
        let folder = target().join("peers");
        fs::create_dir_all(&folder)
            .with_context(|| format!("cannot create {}", folder.display()))?;
        Ok(Self { scripts, python, folder: folder.canonicalize()? })
    }

    fn data(&self) -> PathBuf {
        self.folder.join("data")
    }

    fn python(&self) -> Command {
        let mut command = Command::new(&self.python);
        command.current_dir(&self.folder);
        command.env("PYTHONDONTWRITEBYTECODE", "1").env("BENCH_THREADS", "1");
        command.env("BENCH_DATA", self.data()).env("BENCH_RESULTS", self.folder.join("results"));
        command.env("COCO_SIZES", IMAGES.join(","));
        command.env_remove("BENCH_ONLY").env_remove("BENCH_SLOW");
        command
    }

    /// Says which packages there are, and what to install for the others.
    fn show_packages(&self) -> Result<()> {
        let pairs = MODULES.iter().map(|(module, package)| format!("{module}={package}"));
        let mut command = self.python();
        let output = command.args(["-c", VERSIONS]).args(pairs).output().with_context(|| {
            format!("cannot start {}; say which Python with --python PATH", self.python.display())
        })?;
        if !output.status.success() {
            bail!("{} failed: {}", self.python.display(), String::from_utf8_lossy(&output.stderr));
        }
        let versions = String::from_utf8_lossy(&output.stdout);
        let (mut found, mut absent) = (Vec::new(), Vec::new());
        for ((module, package), version) in MODULES.iter().zip(versions.lines()) {
            match version {
                "" => absent.push(*package),
                version => found.push(format!("{module} {version}")),
            }
        }
        let install = format!("`{} -m pip install {}`", self.python.display(), absent.join(" "));
        if absent.contains(&"numpy") {
            return refuse(&format!("the peers need Python's numpy: {install}"));
        }
        println!("peers: {}", found.join(", "));
        if !absent.is_empty() {
            println!(
                "absent, and so are the peers that need them: {}; {install}",
                absent.join(", ")
            );
        }
        Ok(())
    }

    /// Makes the inputs that are not there yet.
    fn make_inputs(&self) -> Result<()> {
        for &Group { name, last, .. } in &GROUPS {
            if self.data().join(last).exists() {
                continue;
            }
            match self.script("gen_inputs.py", &[name], &format!("inputs_{name}.log")) {
                Err(error) if name == PICTURES => println!("{error:#}; its cases are not run"),
                made => made?,
            }
        }
        Ok(())
    }

    /// Runs a script of the peers; what it says goes to a log.
    fn script(&self, script: &str, arguments: &[&str], log: &str) -> Result<()> {
        println!("running {}", [&[script], arguments].concat().join(" "));
        let log = self.folder.join(log);
        let file =
            File::create(&log).with_context(|| format!("cannot create {}", log.display()))?;
        let mut command = self.python();
        command.arg(self.scripts.join(script)).args(arguments);
        let status = command.stdout(file.try_clone()?).stderr(file).status();
        if status.with_context(|| format!("cannot start {command:?}"))?.success() {
            return Ok(());
        }
        let said = fs::read_to_string(&log).unwrap_or_default();
        let last = said.trim_end().lines().next_back().unwrap_or_default();
        bail!("{script} failed, see {}: {last}", log.display())
    }

    /// Times the others with a script. One that fails, mostly for want of a package, only leaves its cases without peers.
    fn time(&self, group: &Group) -> Result<()> {
        let stale = self.result(group);
        if stale.exists() {
            fs::remove_file(&stale)
                .with_context(|| format!("cannot remove {}", stale.display()))?;
        }
        let log = format!("{}.log", group.script);
        if let Err(error) = self.script(group.script, group.arguments, &log) {
            println!("{error:#}; its cases have no peer");
        }
        Ok(())
    }

    /// Where a script writes what it measured on one thread.
    fn result(&self, group: &Group) -> PathBuf {
        let name = group.script.trim_start_matches("bench_").trim_end_matches(".py");
        let name = [&[name], group.arguments].concat().join("_");
        self.folder.join("results").join(format!("{name}_t1.json"))
    }

    fn results(&self) -> Result<Vec<Value>> {
        let paths = GROUPS.iter().map(|group| self.result(group));
        paths.filter(|path| path.exists()).map(|path| read_json(&path)).collect()
    }

    /// Checks and times ours; the programs say what is wrong.
    fn ours(&self) -> Result<Ours> {
        println!("building and running ours");
        let programs = OURS.iter().map(|example| self.our(example));
        let rows = programs.collect::<Result<Vec<Ours>>>()?;
        rows.into_iter().reduce(Ours::better_of).context("nothing of ours to run")
    }

    fn our(&self, example: &str) -> Result<Ours> {
        let mut command = cargo();
        command.args(["run", "--quiet", "--release", "--package", "jrdb"]);
        command.args(["--example", example, "--"]).arg(self.data()).current_dir(root());
        let output = command.stderr(Stdio::inherit()).output();
        let output = output.with_context(|| format!("cannot start {command:?}"))?;
        if !output.status.success() {
            bail!("{example} failed its checks");
        }
        let json = serde_json::from_slice(&output.stdout)
            .with_context(|| format!("{example} printed no JSON"))?;
        Ok(Ours::parse(&json))
    }
}

fn absolute(path: &str) -> Result<PathBuf> {
    std::path::absolute(path).with_context(|| format!("cannot find {path}"))
}

fn read_json(path: &Path) -> Result<Value> {
    let bytes = fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
    serde_json::from_slice(&bytes).with_context(|| format!("{} is not JSON", path.display()))
}
