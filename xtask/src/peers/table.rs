//! What was measured, what is asked for, and the table that says both.

use std::collections::BTreeMap;

use serde_json::Value;

/// What is asked of a case.
#[derive(Debug, Clone, Copy)]
enum Gate {
    Nothing,
    /// So many times as fast as the best peer.
    Times(f64),
    /// So many times as fast as the best peer, and within a time, ms.
    TimesWithin(f64, f64),
    /// At most so many times the time of reading the bare bytes.
    OfBytes(f64),
    /// Within a time, ms.
    Within(f64),
}

/// A case as the results name it, as we print it, and what is asked of it.
const CASES: [(&str, &str, Gate); 29] = [
    ("N=131072 M=10", "131072 points, 10 boxes", Gate::TimesWithin(10.0, 1.0)),
    ("N=131072 M=50", "131072 points, 50 boxes", Gate::Nothing),
    ("N=131072 M=100", "131072 points, 100 boxes", Gate::TimesWithin(4.0, 3.0)),
    ("N=65536 M=10", "65536 points, 10 boxes", Gate::Nothing),
    ("N=65536 M=50", "65536 points, 50 boxes", Gate::Nothing),
    ("N=65536 M=100", "65536 points, 100 boxes", Gate::Nothing),
    ("relations M=100", "relations of 100", Gate::Times(3.0)),
    ("relations M=500", "relations of 500", Gate::Nothing),
    ("iou3d M=100", "3D overlap of 100", Gate::Nothing),
    ("iou3d M=500", "3D overlap of 500", Gate::Nothing),
    ("binary", "two binary PCDs", Gate::Nothing),
    ("binary, into new memory", "two binary PCDs, new memory", Gate::OfBytes(1.3)),
    ("odd", "two PCDs of 22-byte points", Gate::Nothing),
    ("compressed", "two compressed PCDs", Gate::Times(3.0)),
    ("ascii", "two ASCII PCDs", Gate::Nothing),
    ("query n=50", "query, graph of 50", Gate::Times(10.0)),
    ("query n=200", "query, graph of 200", Gate::Times(10.0)),
    ("query n=2000", "query, graph of 2000", Gate::Times(10.0)),
    ("index n=50", "index of 50", Gate::Times(5.0)),
    ("index n=200", "index of 200", Gate::Times(5.0)),
    ("index n=2000", "index of 2000", Gate::Times(5.0)),
    ("images=100", "COCO statistics, 100 images", Gate::Nothing),
    ("images=10000", "… of 10000 images", Gate::Times(2.0)),
    ("parse", "parse a question", Gate::Times(5.0)),
    ("decode 3760x480", "decode a panorama", Gate::Nothing),
    ("7 tiles -> 768^2 norm (no decode)", "its 7 tiles as tensors", Gate::Nothing),
    ("decode + 7 tiles", "panorama to 7 tensors", Gate::Times(2.0)),
    ("30 crops -> 448^2 norm (no decode)", "30 crops as tensors", Gate::Nothing),
    ("real frame", "a real frame to entities", Gate::Within(3.0)),
];

/// Peers may differ from their reference by so much: in metres, or as a share of a volume.
const PEER_TOLERANCE: f64 = 1e-4;
/// Our COCO statistics may differ from the reference evaluator's by so much.
const STATISTICS_TOLERANCE: f64 = 1e-12;

/// What we measured, by case.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Ours(BTreeMap<String, OurRow>);

#[derive(Debug, Clone, PartialEq)]
struct OurRow {
    ms: f64,
    /// Reading the bare bytes of the same files.
    bytes_ms: Option<f64>,
    /// Pairs that overlap.
    overlapping: Option<u64>,
    /// The COCO statistics.
    statistics: Option<Vec<f64>>,
}

impl Ours {
    pub(crate) fn parse(json: &Value) -> Self {
        let row = |row: &Value| {
            let number = |key: &str| row[key].as_f64();
            let (bytes_ms, overlapping) = (number("bytes_ms"), row["overlapping"].as_u64());
            let statistics = numbers(&row["statistics"]);
            let ours = OurRow { ms: number("median_ms")?, bytes_ms, overlapping, statistics };
            Some((row["case"].as_str()?.into(), ours))
        };
        Self(rows(json).filter_map(row).collect())
    }

    /// For each case the run with the smaller median.
    pub(crate) fn better_of(self, other: Self) -> Self {
        let mut all = self.0;
        for (case, row) in other.0 {
            let better = all.get(&case).cloned().filter(|first| first.ms <= row.ms);
            all.insert(case, better.unwrap_or(row));
        }
        Self(all)
    }

    /// Where ours and the peers found different things.
    pub(crate) fn faults(&self, peers: &Peers) -> Vec<String> {
        let overlapping = |(case, row): (&String, &OurRow)| {
            let (ours, theirs) = (row.overlapping?, *peers.overlapping.get(case)?);
            (ours != theirs).then(|| format!("{case}: {ours} pairs overlap, peers find {theirs}"))
        };
        let statistics = |(case, row): (&String, &OurRow)| {
            let (ours, theirs) = (row.statistics.as_ref()?, peers.statistics.get(case)?);
            let wrong = || format!("{case}: expected the statistics {theirs:?}, found {ours:?}");
            (!are_near(ours, theirs)).then(wrong)
        };
        let rows = || self.0.iter();
        rows().filter_map(overlapping).chain(rows().filter_map(statistics)).collect()
    }
}

/// What others measured.
#[derive(Debug, Default)]
pub(crate) struct Peers {
    /// For each case the fastest peer that was right, and its time, ms.
    best: BTreeMap<String, (String, f64)>,
    /// For each case the pairs that overlap.
    overlapping: BTreeMap<String, u64>,
    /// For each case the COCO statistics of the reference evaluator.
    statistics: BTreeMap<String, Vec<f64>>,
}

impl Peers {
    /// From the files that the scripts write.
    pub(crate) fn parse(files: &[Value]) -> Self {
        let mut peers = Self::default();
        for row in files.iter().flat_map(rows) {
            let (Some(case), Some(peer)) = (row["case"].as_str(), row["peer"].as_str()) else {
                continue;
            };
            if let Some(overlapping) = row["overlapping"].as_u64() {
                peers.overlapping.insert(case.into(), overlapping);
            }
            if let Some(statistics) = numbers(&row["stats"]).filter(|_| row["reference"] == *peer) {
                peers.statistics.insert(case.into(), statistics);
            }
            for (case, ms) in measured(row, case) {
                let is_best = peers.best.get(&case).is_none_or(|(_, best_ms)| ms < *best_ms);
                if is_best && is_sound(row) {
                    let peer = peer.trim_end_matches(FROM_FILES);
                    peers.best.insert(case, (peer.into(), ms));
                }
            }
        }
        peers
    }
}

fn rows(json: &Value) -> impl Iterator<Item = &Value> {
    json["rows"].as_array().map(Vec::as_slice).unwrap_or_default().iter()
}

fn numbers(json: &Value) -> Option<Vec<f64>> {
    json.as_array()?.iter().map(Value::as_f64).collect()
}

fn are_near(ours: &[f64], theirs: &[f64]) -> bool {
    let near = |(a, b): (&f64, &f64)| (a - b).abs() <= STATISTICS_TOLERANCE;
    ours.len() == theirs.len() && ours.iter().zip(theirs).all(near)
}

/// How the rows of COCO evaluations call their time. It includes reading files, so it is not taken.
const FROM_FILES: &str = ": files to 12 stats";

/// What a row says, by our names of the cases, ms: rows of queries tell one query and the index,
/// rows of texts one text, and those of COCO evaluations the time from memory to statistics.
fn measured(row: &Value, case: &str) -> Vec<(String, f64)> {
    if case.starts_with("images=") {
        let seconds = |key: &str| row[key].as_f64();
        let parts = seconds("cpu_s_evaluate").zip(seconds("cpu_s_accumulate"));
        let ms = |(evaluate, accumulate)| (case.into(), (evaluate + accumulate) * 1e3);
        return parts.map(ms).into_iter().collect();
    }
    let Some(one_us) = row["us_per_query"].as_f64() else {
        return peer_ms(row).map(|ms| (case.into(), ms)).into_iter().collect();
    };
    let size = case.split(' ').next().filter(|size| size.starts_with("n="));
    let Some(size) = size else { return vec![("parse".into(), one_us / 1e3)] };
    let index = row["build_ms"].as_f64().map(|ms| (format!("index {size}"), ms));
    std::iter::once((format!("query {size}"), one_us / 1e3)).chain(index).collect()
}

/// The smaller of a peer's medians of wall time and of processor time: others on this machine slow only the first.
fn peer_ms(row: &Value) -> Option<f64> {
    let (wall_ms, cpu_ms) = (row["median_ms"].as_f64(), row["cpu_median_ms"].as_f64());
    // A clock of processor time that ticks too slowly says 0.
    let cpu_ms = cpu_ms.filter(|&ms| ms > 0.0);
    wall_ms.map(|wall_ms| wall_ms.min(cpu_ms.unwrap_or(wall_ms)))
}

/// Whether a peer does the whole work and does it right.
fn is_sound(row: &Value) -> bool {
    let peer = row["peer"].as_str().unwrap_or_default();
    let is_partial = peer.contains("no seam") || peer.starts_with("raw file read");
    let is_none = |key: &str| row[key].is_null() || row[key] == 0;
    let is_near = row["max_err"].is_null()
        || row["max_err"].as_f64().is_some_and(|error| error <= PEER_TOLERANCE);
    !is_partial
        && row["error"].is_null()
        && is_none("wrong_centres")
        && is_none("disagree")
        && is_none("wrong")
        && is_near
}

/// The table, with a line on how to read it.
pub(crate) fn render(ours: &Ours, peers: &Peers) -> String {
    let mut text = format!(
        "\nms of one thread; ours: the better median of a run before and one after the peers, theirs: the smaller median of \
         wall and\nprocessor time of the fastest peer that is right\n\n\
         {:<28}{:>9}{:>10}{:>8}  {:<26}{:<20}{}\n",
        "case", "ours", "peer", "ratio", "best peer", "gate", "verdict"
    );
    for (case, shown, gate) in CASES {
        let row = ours.0.get(case);
        let best = peers.best.get(case);
        let ms = |ms: Option<f64>| match ms {
            None => "-".into(),
            Some(ms) if ms < 0.01 => format!("{ms:.5}"),
            Some(ms) => format!("{ms:.3}"),
        };
        let ratio = row.zip(best).map(|(row, (_, peer_ms))| peer_ms / row.ms);
        let peer = best.map_or("-", |(peer, _)| peer);
        let times = ratio.map_or("-".into(), |ratio| format!("{ratio:.1}x"));
        let (ours, theirs) = (ms(row.map(|row| row.ms)), ms(best.map(|(_, peer_ms)| *peer_ms)));
        let (gate, verdict) =
            (gate.shown(), row.map_or("not run".into(), |row| gate.verdict(row, ratio)));
        let line =
            format!("{shown:<28}{ours:>9}{theirs:>10}{times:>8}  {peer:<26}{gate:<20}{verdict}");
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text
}

impl Gate {
    fn shown(self) -> String {
        match self {
            Self::Nothing => String::new(),
            Self::Times(ratio) => format!(">= {ratio}x"),
            Self::TimesWithin(ratio, ms) => format!(">= {ratio}x, <= {ms} ms"),
            Self::OfBytes(ratio) => format!("<= {ratio}x bare bytes"),
            Self::Within(ms) => format!("<= {ms} ms"),
        }
    }

    /// `met` or `missed`, `no peer` where there is nothing to compare with, and beside bare bytes the ratio to them.
    fn verdict(self, row: &OurRow, ratio: Option<f64>) -> String {
        let word = |met: bool| if met { "met" } else { "missed" }.to_owned();
        let of_bytes =
            row.bytes_ms.map(|ms| (row.ms / ms, format!("({:.2}x of {ms:.3} ms)", row.ms / ms)));
        let fast = |least: f64| ratio.map(|ratio| ratio >= least);
        match self {
            Self::Nothing => of_bytes.map_or(String::new(), |(_, shown)| shown),
            Self::Within(ms) => word(row.ms <= ms),
            Self::Times(least) => fast(least).map_or("no peer".into(), word),
            Self::TimesWithin(least, ms) => {
                fast(least).map_or("no peer".into(), |fast| word(fast && row.ms <= ms))
            }
            Self::OfBytes(most) => of_bytes.map_or("not run".into(), |(times, shown)| {
                format!("{} {shown}", word(times <= most))
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn ours() -> Ours {
        Ours::parse(&json!({"rows": [
            {"case": "N=131072 M=10", "median_ms": 0.5},
            {"case": "N=131072 M=100", "median_ms": 3.5},
            {"case": "relations M=100", "median_ms": 1.0},
            {"case": "iou3d M=100", "median_ms": 1.0, "overlapping": 3},
            {"case": "binary", "median_ms": 0.2, "bytes_ms": 0.1},
            {"case": "binary, into new memory", "median_ms": 0.6, "bytes_ms": 0.5},
            {"case": "real frame", "median_ms": 3.1},
        ]}))
    }

    fn peers() -> Peers {
        let row = |case: &str, peer: &str, ms: f64| json!({"case": case, "peer": peer, "median_ms": ms, "cpu_median_ms": ms * 2.0});
        let mut wrong = row("N=131072 M=10", "fast and wrong", 0.1);
        wrong["wrong_centres"] = 2.into();
        let mut overlap = row("iou3d M=100", "shapely", 4.0);
        overlap["overlapping"] = 4.into();
        overlap["max_err"] = 1e-12.into();
        Peers::parse(&[
            json!({"rows": [wrong, row("N=131072 M=10", "numpy loop (no seam)", 0.2), {"case": "import", "peer": "torch", "error": "no"}]}),
            json!({"rows": [row("N=131072 M=10", "numba", 5.5), row("N=131072 M=10", "slow", 9.0), row("N=131072 M=100", "numba", 35.0)]}),
            json!({"rows": [overlap, row("binary", "raw file read (page cache)", 0.1), row("binary", "numpy", 0.3)]}),
        ])
    }

    fn line(case: &str) -> Vec<String> {
        let text = render(&ours(), &peers());
        let line = text.lines().find(|line| line.starts_with(case)).unwrap();
        line.split("  ")
            .map(|cell| cell.trim().into())
            .filter(|cell: &String| !cell.is_empty())
            .collect()
    }

    #[test]
    fn the_best_peer_is_the_fastest_that_does_the_whole_work_and_does_it_right() {
        let expected = [
            "131072 points, 10 boxes",
            "0.500",
            "5.500",
            "11.0x",
            "numba",
            ">= 10x, <= 1 ms",
            "met",
        ];
        assert_eq!(line("131072 points, 10 boxes"), expected);
        assert_eq!(line("two binary PCDs ")[4], "numpy");
    }

    #[test]
    fn a_gate_is_missed_by_time_alone_and_needs_a_peer() {
        assert_eq!(line("131072 points, 100 boxes").last().unwrap(), "missed");
        assert_eq!(line("a real frame").last().unwrap(), "missed");
        assert_eq!(line("relations of 100").last().unwrap(), "no peer");
        assert_eq!(line("two binary PCDs ").last().unwrap(), "(2.00x of 0.100 ms)");
        assert_eq!(line("two binary PCDs, new").last().unwrap(), "met (1.20x of 0.500 ms)");
        assert_eq!(line("two compressed PCDs").last().unwrap(), "not run");
    }

    #[test]
    fn the_better_of_two_runs_counts_whole() {
        let again = json!({"rows": [{"case": "binary", "median_ms": 0.1, "bytes_ms": 0.2}, {"case": "iou3d M=100", "median_ms": 2.0}]});
        let better = ours().better_of(Ours::parse(&again));
        let binary = &better.0["binary"];
        assert_eq!((binary.ms, binary.bytes_ms), (0.1, Some(0.2)));
        assert_eq!(better.0["iou3d M=100"].ms, 1.0);
    }

    #[test]
    fn rows_of_queries_tell_one_query_and_the_index_and_rows_of_texts_one_text() {
        let query = json!({"case": "n=50 E=2450", "peer": "p", "median_ms": 9.0, "us_per_query": 12.0, "build_ms": 3.0, "wrong": 0});
        let text =
            json!({"case": "10000 texts", "peer": "q", "median_ms": 180.0, "us_per_query": 18.0});
        let mut wrong = query.clone();
        wrong["us_per_query"] = 1.0.into();
        wrong["wrong"] = 3.into();
        let peers = Peers::parse(&[json!({"rows": [query, text, wrong]})]);
        let ms = |case: &str| peers.best[case].1;
        assert_eq!([ms("query n=50"), ms("index n=50"), ms("parse")], [0.012, 3.0, 0.018]);
    }

    #[test]
    fn rows_of_coco_evaluations_tell_the_time_from_memory() {
        let row = json!({"case": "images=100", "peer": "hotcoco: files to 12 stats", "median_ms": 99.0,
            "cpu_s_load": 0.9, "cpu_s_evaluate": 0.25, "cpu_s_accumulate": 0.5});
        let load = json!({"case": "images=100", "peer": "json.load of the detections only", "median_ms": 1.0});
        let peers = Peers::parse(&[json!({"rows": [row, load]})]);
        assert_eq!(peers.best["images=100"], ("hotcoco".into(), 750.0));
    }

    #[test]
    fn other_coco_statistics_than_the_reference_are_wrong() {
        let of = |peer: &str, ap: f64| json!({"case": "images=100", "peer": peer, "reference": "pycocotools", "stats": [ap, 0.5]});
        let peers = Peers::parse(&[json!({"rows": [of("pycocotools", 0.25), of("other", 0.3)]})]);
        let faults = |ap: f64| {
            let row = json!({"case": "images=100", "median_ms": 1.0, "statistics": [ap, 0.5]});
            Ours::parse(&json!({"rows": [row]})).faults(&peers)
        };
        assert!(faults(0.25 + 1e-14).is_empty());
        let expected = "images=100: expected the statistics [0.25, 0.5], found [0.26, 0.5]";
        assert_eq!(faults(0.26), [expected]);
    }

    #[test]
    fn another_number_of_overlapping_pairs_is_wrong() {
        assert_eq!(ours().faults(&peers()), ["iou3d M=100: 3 pairs overlap, peers find 4"]);
    }
}
