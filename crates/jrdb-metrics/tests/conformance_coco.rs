//! Our COCO numbers against those of the reference evaluator.
#![allow(clippy::unwrap_used, reason = "a failing helper should panic")]

use std::collections::BTreeMap;
use std::path::PathBuf;

use jrdb_metrics::coco::{Config, Dataset, DetectionBox, GroundTruthBox, evaluate};
use jrdb_types::PixelBox;
use serde_json::Value;

const TOLERANCE: f64 = 1e-12;

fn shared() -> PathBuf {
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared");
    std::env::var_os("JRDB_SHARED").map_or_else(|| beside.into(), PathBuf::from)
}

fn list(value: &Value) -> &[Value] {
    value.as_array().unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    list(value).iter().map(|v| v.as_f64().unwrap()).collect()
}

fn bbox(value: &Value) -> PixelBox {
    PixelBox::from(<[f64; 4]>::try_from(numbers(&value["bbox"])).unwrap())
}

fn dataset(case: &Value) -> Dataset {
    let truth = list(&case["gt"]["annotations"]).iter().map(|a| GroundTruthBox {
        image: a["image_id"].as_u64().unwrap(),
        category: a["category_id"].as_u64().unwrap(),
        bbox: bbox(a),
        area_px2: a["area"].as_f64().unwrap(),
        crowd: a["iscrowd"] == 1,
    });
    let detections = list(&case["dt"]).iter().map(|d| DetectionBox {
        image: d["image_id"].as_u64().unwrap(),
        category: d["category_id"].as_u64().unwrap(),
        bbox: bbox(d),
        score: d["score"].as_f64().unwrap(),
    });
    Dataset { truth: truth.collect(), detections: detections.collect() }
}

fn agrees(case: &Value) -> bool {
    let limits = list(&case["max_dets"]).iter().map(|v| v.as_u64().unwrap() as usize).collect();
    let config = Config { max_detections: limits, ..Config::default() };
    let found = evaluate(&dataset(case), &config);
    let categories = list(&case["gt"]["categories"]).iter();
    let by_category: Vec<f64> =
        categories.map(|c| found.category_ap(c["id"].as_u64().unwrap())).collect();
    let close = |a: &[f64], b: &[f64]| {
        a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= TOLERANCE)
    };
    close(&found.statistics().to_vec(), &numbers(&case["stats"]))
        && close(&by_category, &numbers(&case["ap_per_category"]))
}

#[test]
fn conformance_coco() {
    let folder = shared().join("goldens/coco");
    let Ok(files) = std::fs::read_dir(folder) else {
        println!("skipped: no shared data");
        return;
    };
    let mut tally: BTreeMap<String, (usize, usize)> = BTreeMap::new();
    let mut wrong = Vec::new();
    for path in
        files.map(|f| f.unwrap().path()).filter(|p| p.extension().is_some_and(|e| e == "json"))
    {
        let goldens: Value = serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap();
        for case in list(&goldens["cases"]) {
            let (right, all) = tally.entry(case["kind"].as_str().unwrap().into()).or_default();
            *all += 1;
            if agrees(case) {
                *right += 1;
            } else {
                wrong.push(case["name"].clone());
            }
        }
    }
    for (kind, (right, all)) in &tally {
        println!("{kind}: {right} of {all}");
    }
    assert!(!tally.is_empty() && wrong.is_empty(), "these cases differ: {wrong:?}");
}
