//! `jrdb models params`: how many parameters models have.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Result;
use clap::Args;
use jrdb_cli::Error;
use jrdb_models::parameters::{Count, GroupCount, ParameterReport, parameters};

use super::print::{Format, say};

/// Least width of the column of files.
const FILE_WIDTH: usize = 24;

#[derive(Debug, Args)]
pub(crate) struct ParamsArgs {
    /// An ONNX file, or a folder with models; backbones are looked for in the folder itself
    #[arg(value_name = "DIR|FILE", default_value = "models")]
    path: PathBuf,
    /// How it is printed
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

pub(crate) fn params(args: &ParamsArgs) -> Result<ExitCode> {
    let report = parameters(&args.path).map_err(Error::from)?;
    match args.format {
        Format::Text => say(&text(&report))?,
        Format::Json => say(&(serde_json::to_string_pretty(&report)? + "\n"))?,
    }
    Ok(ExitCode::SUCCESS)
}

fn text(report: &ParameterReport) -> String {
    let groups = report.backbones.iter().chain(&report.others);
    let files = groups.flat_map(|group| &group.graphs).map(|graph| shown(&graph.file).len());
    let width = files.max().unwrap_or(0).max(FILE_WIDTH);
    let backbones =
        report.backbones.iter().map(|one| table(&format!("backbone {}", one.name), one, width));
    let others = report.others.iter().map(|one| table(other(&one.name), one, width));
    backbones.chain(others).collect::<Vec<_>>().join("\n")
}

/// A group that is no backbone: a file, a folder, or what lies in the folder itself.
fn other(name: &str) -> &str {
    if name == "." { "other graphs" } else { name }
}

fn table(title: &str, group: &GroupCount, width: usize) -> String {
    let row = |name: &str, count: &Count| {
        let (parameters, megabytes) = (count.parameters, count.bytes as f64 / 1e6);
        format!("  {name:<width$}  {parameters:>13}  {megabytes:>9.2}  {}\n", types(&count.types))
    };
    let title = format!("{title}: {}\n", total(group));
    let head = format!("  {:<width$}  {:>13}  {:>9}  types\n", "file", "parameters", "MB");
    let graphs = group.graphs.iter().map(|graph| row(&shown(&graph.file), &graph.count));
    let missing =
        group.missing.iter().map(|file| format!("  {:<width$}  {:>13}\n", shown(file), "missing"));
    let together = (group.graphs.len() > 1).then(|| row("together", &group.count));
    let rows = graphs.chain(missing).chain(together);
    std::iter::once(title).chain(std::iter::once(head)).chain(rows).collect()
}

/// The parameters of a group in words, and what they leave out.
fn total(group: &GroupCount) -> String {
    let single: u64 = group.graphs.iter().map(|graph| graph.count.parameters).sum();
    let shared = if single == group.count.parameters {
        String::new()
    } else {
        format!(" ({} with those repeated in several graphs)", in_words(single))
    };
    let missing = match group.missing.len() {
        0 => String::new(),
        1 => ", without 1 missing file".into(),
        count => format!(", without {count} missing files"),
    };
    format!("{} parameters{shared}{missing}", in_words(group.count.parameters))
}

/// A number in millions or billions where it is that large.
fn in_words(count: u64) -> String {
    const MILLION: f64 = 1e6;
    const BILLION: f64 = 1e9;
    match count as f64 {
        large if large >= BILLION => format!("{:.2} billion", large / BILLION),
        large if large >= MILLION => format!("{:.2} million", large / MILLION),
        _ => count.to_string(),
    }
}

/// The types of numbers, the most frequent first.
fn types(types: &BTreeMap<String, u64>) -> String {
    let mut types: Vec<_> = types.iter().collect();
    types.sort_by_key(|(_, count)| std::cmp::Reverse(**count));
    let one = |(name, count): &(&String, &u64)| format!("{name} {}", in_words(**count));
    match types.as_slice() {
        [(name, _)] => (*name).clone(),
        types => types.iter().map(one).collect::<Vec<_>>().join(", "),
    }
}

fn shown(path: &std::path::Path) -> String {
    path.display().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use jrdb_models::parameters::GraphCount;

    fn count(parameters: u64, types: &[(&str, u64)]) -> Count {
        let types = types.iter().map(|(name, count)| ((*name).into(), *count)).collect();
        Count { parameters, bytes: 4 * parameters, types }
    }

    #[test]
    fn the_table_shows_each_graph_the_sum_and_what_is_missing() {
        let float = |n| count(n, &[("float32", n)]);
        let graph = |file: &str, count| GraphCount { file: file.into(), count };
        let group = GroupCount {
            name: "mine".into(),
            graphs: vec![
                graph("a/decoder_model.onnx", float(3_000_000)),
                graph(
                    "a/embed_tokens.onnx",
                    count(2_500_000, &[("float32", 500), ("4-bit", 2_499_500)]),
                ),
            ],
            missing: vec!["a/vision_encoder.onnx".into()],
            count: count(4_000_000, &[("float32", 2_000_000), ("4-bit", 2_000_000)]),
        };
        let report = ParameterReport { backbones: vec![group], others: vec![] };
        let expected = "\
backbone mine: 4.00 million parameters (5.50 million with those \
repeated in several graphs), without 1 missing file
  file                         parameters         MB  types
  a/decoder_model.onnx            3000000      12.00  float32
  a/embed_tokens.onnx             2500000      10.00  4-bit 2.50 million, float32 500
  a/vision_encoder.onnx           missing
  together                        4000000      16.00  4-bit 2.00 million, float32 2.00 million
";
        assert_eq!(text(&report), expected);
    }

    #[test]
    fn numbers_are_in_millions_and_billions() {
        assert_eq!(in_words(999_999), "999999");
        assert_eq!(in_words(231_400_000), "231.40 million");
        assert_eq!(in_words(1_290_000_000), "1.29 billion");
    }
}
