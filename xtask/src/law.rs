//! Who may depend on whom: the dependency law of docs/architecture.md.

/// A crate, what it is, and what it may depend on.
pub(crate) struct Row {
    /// Package name.
    pub(crate) name: &'static str,
    /// What it is, as in the table.
    pub(crate) what: &'static str,
    /// Crates of this workspace.
    pub(crate) ours: &'static [&'static str],
    /// Other crates; `None` where any may be used that deny.toml allows.
    pub(crate) others: Option<&'static [&'static str]>,
    /// Whether it may touch files, the environment, the clock or other programs.
    pub(crate) touches_the_world: bool,
}

impl Row {
    /// The folder of the crate, from the workspace's root.
    pub(crate) fn folder(&self) -> String {
        match self.name {
            "xtask" => "xtask".into(),
            // Cargo names what it installs after the package.
            "jrdb" => "crates/jrdb-cli".into(),
            name => format!("crates/{name}"),
        }
    }
}

/// A stage: pure, and knowing only the types, whatever maths or formats it uses inside.
const fn stage(name: &'static str, what: &'static str, ours: &'static [&'static str]) -> Row {
    Row { name, what, ours, others: None, touches_the_world: false }
}

/// The law.
pub(crate) const LAW: &[Row] = &[
    Row {
        name: "jrdb-types",
        what: "what passes between stages: plain serde types, numbers and words",
        ours: &[],
        others: Some(&["schemars", "serde", "serde_json", "thiserror"]),
        touches_the_world: false,
    },
    Row {
        name: "jrdb-dataset",
        what: "files of the outside world: JRDB trees, labels, calibration, clouds, questions",
        ours: &["jrdb-types"],
        others: None,
        touches_the_world: true,
    },
    stage("jrdb-perception", "image → detections with attributes", &["jrdb-types"]),
    stage(
        "jrdb-projection",
        "points and boxes → entities in 3D and their relations",
        &["jrdb-types"],
    ),
    stage(
        "jrdb-calibration",
        "does the cloud fit the image; the floor",
        &["jrdb-types", "jrdb-projection"],
    ),
    stage("jrdb-graph", "entities and relations → scene graph", &["jrdb-types"]),
    stage("jrdb-parser", "English → query", &["jrdb-types"]),
    stage(
        "jrdb-search",
        "graph and query → answer with its reasons",
        &["jrdb-types", "jrdb-graph"],
    ),
    stage("jrdb-metrics", "answers and truth → scores", &["jrdb-types"]),
    stage("jrdb-render", "answers, traces, scores → words", &["jrdb-types"]),
    stage(
        "jrdb-pipeline",
        "what people embed: a frame in, a scene that answers questions out",
        &[
            "jrdb-types",
            "jrdb-perception",
            "jrdb-projection",
            "jrdb-calibration",
            "jrdb-graph",
            "jrdb-parser",
            "jrdb-search",
            "jrdb-metrics",
        ],
    ),
    Row {
        name: "jrdb-models",
        what: "perception sources by name; catalogue, fetching and loading of models",
        ours: &["jrdb-types", "jrdb-dataset", "jrdb-perception", "jrdb-parser", "jrdb-metrics"],
        others: None,
        touches_the_world: true,
    },
    stage(
        "jrdb-draw",
        "pictures: panorama, view from above, overlay",
        &["jrdb-types", "jrdb-projection", "jrdb-render"],
    ),
    stage(
        "jrdb-study",
        "plans of studies, tables in the paper's layout, the paper's numbers",
        &["jrdb-types"],
    ),
    Row {
        name: "jrdb-synth",
        what: "drawn scenes with known answers",
        ours: &[
            "jrdb-types",
            "jrdb-dataset",
            "jrdb-perception",
            "jrdb-projection",
            "jrdb-graph",
            "jrdb-parser",
            "jrdb-search",
        ],
        others: None,
        touches_the_world: true,
    },
    Row {
        name: "jrdb",
        what: "the command: flags, runs over datasets, output layout, reports",
        ours: &[
            "jrdb-types",
            "jrdb-dataset",
            "jrdb-perception",
            "jrdb-projection",
            "jrdb-calibration",
            "jrdb-graph",
            "jrdb-parser",
            "jrdb-render",
            "jrdb-search",
            "jrdb-metrics",
            "jrdb-pipeline",
            "jrdb-models",
            "jrdb-draw",
            "jrdb-study",
            "jrdb-synth",
        ],
        others: None,
        touches_the_world: true,
    },
    Row {
        name: "xtask",
        what: "developer commands; starts the others through cargo",
        ours: &[],
        others: Some(&["anyhow", "serde_json"]),
        touches_the_world: true,
    },
];

/// The law as the table in docs/architecture.md.
pub(crate) fn table() -> String {
    let mut text = String::from("| crate | what it is | may depend on |\n|---|---|---|\n");
    for row in LAW {
        let short: Vec<&str> =
            row.ours.iter().map(|name| name.trim_start_matches("jrdb-")).collect();
        let ours = match short.as_slice() {
            [] => "none of ours".into(),
            all if all.len() + 2 == LAW.len() => "all above".into(),
            some => some.join(", "),
        };
        text.push_str(&format!("| `{}` | {} | {ours} |\n", row.name, row.what));
    }
    text
}
