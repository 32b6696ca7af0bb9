//! How many parameters models have, counted from their files.
//!
//! What counts is defined at [`jrdb_perception::count_parameters`]. Within one model a weight that
//! several graphs hold counts once.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File};
use std::io;
use std::path::{Component, Path, PathBuf};

use jrdb_perception::{Parameters, count_parameters};
use serde::Serialize;

use crate::Error;
use crate::backbone::{Backbone, built_in};

/// A number of parameters.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize)]
pub struct Count {
    /// How many parameters.
    pub parameters: u64,
    /// How many bytes these take in the files; scales and whatever else is there not counted.
    pub bytes: u64,
    /// How many parameters each type of number has.
    pub types: BTreeMap<String, u64>,
}

/// A graph and its parameters.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct GraphCount {
    /// The file, from the folder that was counted.
    pub file: PathBuf,
    /// What it holds.
    #[serde(flatten)]
    pub count: Count,
}

/// Graphs that belong together, and their parameters.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct GroupCount {
    /// The backbone, or the folder and what the graphs' names end with.
    pub name: String,
    /// The graphs that are there.
    pub graphs: Vec<GraphCount>,
    /// Files of graphs that belong to it and are not there.
    pub missing: Vec<PathBuf>,
    /// What all have together; less than the sum where graphs share weights.
    #[serde(flatten)]
    pub count: Count,
}

/// What a file or folder holds.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ParameterReport {
    /// The backbones of which at least one graph is there.
    pub backbones: Vec<GroupCount>,
    /// Graphs of no backbone, by folder and by what their names end with.
    pub others: Vec<GroupCount>,
}

/// Counts the parameters of an ONNX file, or of all ONNX files in a folder and below.
///
/// Backbones are the built-in ones and those that the folder describes (`NAME.json`). No weights
/// are loaded.
///
/// # Errors
/// When the path cannot be read, holds no model, or a file is not an ONNX model; it is named.
pub fn parameters(path: &Path) -> Result<ParameterReport, Error> {
    if !fs::metadata(path).map_err(Error::read(path))?.is_dir() {
        let root = path.parent().unwrap_or(Path::new(""));
        let folder = Folder { root, graphs: BTreeMap::from([(path.into(), count(path)?)]) };
        let others = vec![folder.group(folder.shown(path), &[vec![path.into()]])];
        return Ok(ParameterReport { backbones: Vec::new(), others });
    }
    let folder = Folder::read(path)?;
    let backbones = folder.backbones();
    let shown: BTreeSet<&PathBuf> =
        backbones.iter().flat_map(|(_, models)| models).flatten().collect();
    let mut others: BTreeMap<String, Vec<PathBuf>> = BTreeMap::new();
    for path in folder.graphs.keys().filter(|path| !shown.contains(path)) {
        others.entry(folder.group_name(path)).or_default().push(path.clone());
    }
    Ok(ParameterReport {
        backbones: backbones
            .iter()
            .map(|(name, models)| folder.group(name.clone(), models))
            .collect(),
        others: others.into_iter().map(|(name, graphs)| folder.group(name, &[graphs])).collect(),
    })
}

/// Counts one file, and compares weights that it keeps in files beside it.
fn count(path: &Path) -> Result<Parameters, Error> {
    let wrap = |source| Error::Engine { what: path.display().to_string(), source };
    let file = File::open(path).map_err(Error::read(path))?;
    let bytes = file.metadata().map_err(Error::read(path))?.len();
    let counted = count_parameters(file, bytes).map_err(wrap)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    Ok(counted.with_external_files(|location| open_beside(folder, location)))
}

/// Opens a file of a folder; nothing outside of it.
fn open_beside(folder: &Path, location: &str) -> io::Result<File> {
    let location = Path::new(location);
    if !location.components().all(|part| matches!(part, Component::Normal(_))) {
        return Err(io::ErrorKind::InvalidInput.into());
    }
    File::open(folder.join(location))
}

/// A folder and what its graphs hold.
struct Folder<'a> {
    root: &'a Path,
    graphs: BTreeMap<PathBuf, Parameters>,
}

impl<'a> Folder<'a> {
    fn read(root: &'a Path) -> Result<Self, Error> {
        let mut paths = Vec::new();
        collect_graphs(root, &mut paths)?;
        if paths.is_empty() {
            return Err(Error::NoModels { path: root.into() });
        }
        let counted = paths.into_iter().map(|path| Ok((path.clone(), count(&path)?)));
        Ok(Self { root, graphs: counted.collect::<Result<_, Error>>()? })
    }

    /// The backbones of which at least one graph is there, with the graphs of their models.
    fn backbones(&self) -> Vec<(String, Vec<Vec<PathBuf>>)> {
        let described = fs::read_dir(self.root).into_iter().flatten().flatten();
        let described = described.filter_map(|entry| {
            let path = entry.path();
            let is_json = path.extension().is_some_and(|extension| extension == "json");
            is_json.then(|| path.file_stem()?.to_str().map(str::to_owned))?
        });
        let names: BTreeSet<String> =
            built_in().into_iter().map(str::to_owned).chain(described).collect();
        // Other JSON files may lie there, too. Who names one as a backbone learns what is wrong.
        let graphs = |name: String| {
            let models = Backbone::named(&name, self.root).ok()?.graphs(self.root);
            models
                .iter()
                .flatten()
                .any(|path| self.graphs.contains_key(path))
                .then_some((name, models))
        };
        names.into_iter().filter_map(graphs).collect()
    }

    /// The count of models, each a list of graphs that may share weights.
    fn group(&self, name: String, models: &[Vec<PathBuf>]) -> GroupCount {
        let mut count = Count::default();
        for model in models {
            count.add(&Parameters::union(model.iter().filter_map(|path| self.graphs.get(path))));
        }
        let found = |path: &PathBuf| {
            let count = Count::from(self.graphs.get(path)?);
            Some(GraphCount { file: self.relative(path), count })
        };
        let paths = || models.iter().flatten();
        let missing = paths().filter(|path| !self.graphs.contains_key(*path));
        GroupCount {
            name,
            graphs: paths().filter_map(found).collect(),
            missing: missing.map(|path| self.relative(path)).collect(),
            count,
        }
    }

    fn relative(&self, path: &Path) -> PathBuf {
        path.strip_prefix(self.root).unwrap_or(path).into()
    }

    fn shown(&self, path: &Path) -> String {
        self.relative(path).display().to_string()
    }

    /// The folder of a graph, with the variant in its name.
    fn group_name(&self, path: &Path) -> String {
        let folder = path.parent().map(|folder| self.shown(folder)).unwrap_or_default();
        let folder = if folder.is_empty() { ".".into() } else { folder };
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        match variant(&stem) {
            "" => folder,
            variant => format!("{folder} ({})", variant.trim_start_matches('_')),
        }
    }
}

/// What a graph's name ends with, as `_q4` in `embed_tokens_q4`, where it begins with a usual name.
fn variant(stem: &str) -> &str {
    // Longer names before those that they begin with.
    const NAMES: [&str; 7] = [
        "decoder_with_past_model",
        "decoder_model_merged",
        "decoder_model",
        "encoder_model",
        "embed_tokens",
        "vision_encoder",
        "model",
    ];
    NAMES.iter().find_map(|name| stem.strip_prefix(name)).unwrap_or("")
}

/// The ONNX files in a folder and below, which is not left through links.
fn collect_graphs(folder: &Path, graphs: &mut Vec<PathBuf>) -> Result<(), Error> {
    for entry in fs::read_dir(folder).map_err(Error::read(folder))? {
        let entry = entry.map_err(Error::read(folder))?;
        let path = entry.path();
        if entry.file_type().map_err(Error::read(&path))?.is_dir() {
            collect_graphs(&path, graphs)?;
        } else if path.extension().is_some_and(|extension| extension == "onnx") && path.is_file() {
            graphs.push(path);
        }
    }
    Ok(())
}

impl Count {
    fn add(&mut self, counted: &Parameters) {
        self.parameters += counted.count();
        self.bytes += counted.bytes();
        for (name, count) in counted.by_type() {
            *self.types.entry(name).or_default() += count;
        }
    }
}

impl From<&Parameters> for Count {
    fn from(counted: &Parameters) -> Self {
        let mut count = Self::default();
        count.add(counted);
        count
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MODELS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../models");

    fn demo_graph(name: &str) -> PathBuf {
        Path::new(MODELS).join("demo/florence2/onnx").join(name)
    }

    #[test]
    fn the_demo_backbone_counts_weights_of_several_graphs_once() {
        let report = parameters(Path::new(MODELS)).unwrap();
        let demo = report.backbones.iter().find(|group| group.name == "demo").unwrap();
        assert!(demo.missing.is_empty());
        assert_eq!(demo.graphs.len(), 8);
        assert_eq!(demo.count.parameters, 935_072 + 496_104);
        let single: u64 = demo.graphs.iter().map(|graph| graph.count.parameters).sum();
        assert_eq!(single, 1_404_704 + 525_736);
        assert_eq!(demo.count.types.values().sum::<u64>(), demo.count.parameters);
    }

    #[test]
    fn a_single_file_is_a_group_of_its_own() {
        let report = parameters(&demo_graph("encoder_model.onnx")).unwrap();
        assert!(report.backbones.is_empty());
        assert_eq!(report.others[0].name, "encoder_model.onnx");
        assert_eq!(report.others[0].count.parameters, 99_744);
    }

    #[test]
    fn variants_of_a_model_are_counted_apart() {
        let folder = tempfile::tempdir().unwrap();
        for (name, copy) in [
            ("decoder_model.onnx", "decoder_model.onnx"),
            ("decoder_with_past_model.onnx", "decoder_with_past_model.onnx"),
            ("decoder_model.onnx", "decoder_model_q4.onnx"),
        ] {
            fs::copy(demo_graph(name), folder.path().join(copy)).unwrap();
        }
        let others = parameters(folder.path()).unwrap().others;
        let found: Vec<_> = others.iter().map(|g| (&*g.name, g.count.parameters)).collect();
        assert_eq!(found, [(".", 378_144), (". (q4)", 378_144)]);
    }

    #[test]
    fn missing_graphs_of_a_backbone_are_named() {
        let folder = tempfile::tempdir().unwrap();
        let graph = "florence-2-base-ft/onnx/encoder_model.onnx";
        fs::create_dir_all(folder.path().join(graph).parent().unwrap()).unwrap();
        fs::copy(demo_graph("encoder_model.onnx"), folder.path().join(graph)).unwrap();
        let backbones = parameters(folder.path()).unwrap().backbones;
        let names: Vec<_> = backbones.iter().map(|group| &group.name).collect();
        assert_eq!(names, ["florence2-internvl", "paper"]);
        let missing = Path::new("florence-2-base-ft/onnx/decoder_model_merged.onnx");
        assert_eq!(backbones[0].missing.len(), 6);
        assert!(backbones[0].missing.iter().any(|path| path == missing));
    }

    #[test]
    fn weights_outside_of_the_folder_are_not_opened() {
        let folder = Path::new(MODELS).join("demo/florence2/onnx");
        assert!(open_beside(&folder, "encoder_model.onnx").is_ok());
        for location in ["../config.json", "/etc/hostname"] {
            let error = open_beside(&folder, location).unwrap_err();
            assert_eq!(error.kind(), io::ErrorKind::InvalidInput, "{location}");
        }
    }

    #[test]
    fn broken_files_and_empty_folders_are_named() {
        let folder = tempfile::tempdir().unwrap();
        let error = parameters(folder.path()).unwrap_err().to_string();
        assert!(error.starts_with("expected ONNX files in"), "{error}");
        fs::write(folder.path().join("broken.onnx"), "hello, world").unwrap();
        let error = parameters(folder.path()).unwrap_err().to_string();
        assert!(error.contains("broken.onnx: expected an ONNX model"), "{error}");
    }
}
