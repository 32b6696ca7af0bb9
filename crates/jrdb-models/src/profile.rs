//! Where a run's time goes: every graph's calls and seconds, and the process's peak memory.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use jrdb_perception::{DeviceTensor, Engine, EngineError, Input};

/// What graphs have taken so far. Copies count together.
#[derive(Debug, Clone, Default)]
pub struct Profile(Arc<Mutex<BTreeMap<String, Spent>>>);

/// What one graph has taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Spent {
    /// How often it ran.
    pub calls: u32,
    /// For how long, all threads together.
    pub time: Duration,
}

impl Profile {
    /// The graph in a file, counted from now on under its folder's and its own name.
    #[must_use]
    pub fn watch(&self, engine: Box<dyn Engine>, path: &Path) -> Box<dyn Engine> {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let folders = path.ancestors().skip(1).filter_map(Path::file_name);
        let model = folders.map(|name| name.to_string_lossy()).find(|name| name != "onnx");
        let name = model.map_or_else(|| stem.to_string(), |model| format!("{model}/{stem}"));
        Box::new(Watched { engine, name, profile: self.clone() })
    }

    fn all(&self) -> MutexGuard<'_, BTreeMap<String, Spent>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn add(&self, name: &str, time: Duration) {
        let mut all = self.all();
        let spent = all.entry(name.to_owned()).or_default();
        spent.calls += 1;
        spent.time += time;
    }

    /// What every graph has taken, by name.
    #[must_use]
    pub fn spent(&self) -> BTreeMap<String, Spent> {
        self.all().clone()
    }

    /// A table: a line for each graph, and the process's peak memory where the system tells it. A decoder's calls are tokens, nearly.
    #[must_use]
    pub fn table(&self) -> String {
        let mut text = format!(
            "{:<40} {:>8} {:>12} {:>12} {:>12}\n",
            "graph", "calls", "s", "ms/call", "calls/s"
        );
        for (name, spent) in self.spent() {
            let seconds = spent.time.as_secs_f64();
            let calls = f64::from(spent.calls);
            let _ = writeln!(
                text,
                "{name:<40} {:>8} {seconds:>12.3} {:>12.3} {:>12.1}",
                spent.calls,
                1e3 * seconds / calls,
                calls / seconds.max(1e-9)
            );
        }
        if let Some(bytes) = peak_memory() {
            let _ = writeln!(text, "peak memory of the process: {:.0} MB", bytes as f64 / 1e6);
        }
        text
    }
}

/// The most memory that this process has had at once, bytes, where the system tells it.
#[must_use]
pub fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib * 1024)
}

#[derive(Debug)]
struct Watched {
    engine: Box<dyn Engine>,
    name: String,
    profile: Profile,
}

impl Watched {
    fn timed<T>(&self, run: impl FnOnce() -> T) -> T {
        let started = Instant::now();
        let result = run();
        self.profile.add(&self.name, started.elapsed());
        result
    }
}

impl Engine for Watched {
    fn name(&self) -> &str {
        self.engine.name()
    }

    fn inputs(&self) -> &[String] {
        self.engine.inputs()
    }

    fn outputs(&self) -> &[String] {
        self.engine.outputs()
    }

    fn run_on_device(
        &self,
        inputs: &[(&str, Input<'_>)],
        outputs: &[&str],
    ) -> Result<Vec<DeviceTensor>, EngineError> {
        self.timed(|| self.engine.run_on_device(inputs, outputs))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn graphs_are_told_by_folder_and_name() {
        let profile = Profile::default();
        profile.add("florence2/decoder_model", Duration::from_millis(4));
        profile.add("florence2/decoder_model", Duration::from_millis(2));
        let spent = profile.spent()["florence2/decoder_model"];
        assert_eq!((spent.calls, spent.time), (2, Duration::from_millis(6)));
        assert!(profile.table().contains(
            "florence2/decoder_model                         2        0.006        3.000"
        ));
    }
}
