//! Which files a backbone loads.

use std::path::{Path, PathBuf};

use super::{AttributeFiles, Backbone, DetectorFiles, Folder};

/// The graphs of a vision-language model.
const VLM: [&str; 3] = ["vision_encoder", "embed_tokens", "decoder_model_merged"];

impl Backbone {
    /// The graphs that it loads from a models folder, a list for each of its models. A graph that
    /// is missing is listed where it is expected.
    #[must_use]
    pub fn graphs(&self, models: &Path) -> Vec<Vec<PathBuf>> {
        let attributes = self.attributes.as_ref().map(|files| files.graphs(models));
        self.detector.graphs(models).into_iter().chain(attributes.into_iter().flatten()).collect()
    }
}

impl DetectorFiles {
    fn graphs(&self, models: &Path) -> Vec<Vec<PathBuf>> {
        match self {
            Self::Florence2 { graphs, .. } => vec![florence2(&Folder::new(models, graphs))],
            Self::GroundingDino { graphs, .. } => {
                vec![vec![Folder::new(models, graphs).place("model")]]
            }
            Self::Ssdlite(files) => vec![vec![models.join(&files.file)]],
            Self::Pair(files) => {
                [&files.people.file, &files.objects.file].map(|file| vec![models.join(file)]).into()
            }
        }
    }
}

impl AttributeFiles {
    fn graphs(&self, models: &Path) -> Vec<Vec<PathBuf>> {
        match self {
            Self::Internvl { graphs, .. } | Self::Qwen25Vl { graphs, .. } => {
                let folder = Folder::new(models, graphs);
                vec![VLM.map(|name| folder.place(name)).into()]
            }
            Self::Appearance(files) => {
                [&files.faces, &files.gender, &files.age].map(|file| vec![models.join(file)]).into()
            }
        }
    }
}

/// As [`super::florence2`] loads them: the merged decoder, else the two that it is made of.
fn florence2(folder: &Folder) -> Vec<PathBuf> {
    let is_there = |name| folder.place(name).is_file();
    let is_split = !is_there("decoder_model_merged") && is_there("decoder_model");
    let decoder: &[&str] = if is_split {
        &["decoder_model", "decoder_with_past_model"]
    } else {
        &["decoder_model_merged"]
    };
    let others = ["vision_encoder", "embed_tokens", "encoder_model"];
    others.iter().chain(decoder).map(|name| folder.place(name)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(backbone: &str, models: &Path) -> Vec<Vec<String>> {
        let name = |path: &PathBuf| path.strip_prefix(models).unwrap().display().to_string();
        let graphs = Backbone::named(backbone, models).unwrap().graphs(models);
        graphs.iter().map(|graphs| graphs.iter().map(name).collect()).collect()
    }

    #[test]
    fn the_demo_loads_only_files_that_are_there() {
        let models = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../models"));
        let graphs = Backbone::named("demo", models).unwrap().graphs(models);
        assert_eq!(graphs.iter().map(Vec::len).collect::<Vec<_>>(), [5, 3]);
        for path in graphs.concat() {
            assert!(path.is_file(), "{path:?}");
        }
    }

    #[test]
    fn small_models_are_a_file_each_and_the_merged_decoder_is_expected() {
        let light = names("light", Path::new("/nowhere"));
        assert_eq!(light.len(), 5);
        assert_eq!(light[0], ["ssdlite-mbv2-300-person.f16.onnx"]);
        let paper = names("paper", Path::new("/nowhere"));
        assert_eq!(paper[0][3], "florence-2-base-ft/onnx/decoder_model_merged.onnx");
        assert_eq!(paper[1].len(), 3);
    }
}
