//! Circles of files: a file that uses, directly or through others, a file that uses it.
//!
//! Files are read as text. What a file takes from another shows in its `use` lines and in paths that begin with `crate`, `super`,
//! `self` or a module of its own; a name that a parent passes on counts as taken from the file that defines it. `mod` lines are not uses, and tests
//! may use what they need.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

/// Folders whose files may use each other: the productions of a grammar call each other, which is what a grammar is.
const MAY_RECUR: [&str; 1] = ["crates/jrdb-parser/src/grammar/"];

/// A module path within a crate, as `["draw", "canvas"]`.
type Module = Vec<String>;

/// The circles among files of one crate, as lists of their names; `files` are its sources, `src` their folder.
pub(crate) fn circles(src: &Path, files: &[PathBuf], root: &Path) -> Result<Vec<Vec<String>>> {
    let mut sources = BTreeMap::new();
    for file in files {
        let text = std::fs::read_to_string(file)
            .with_context(|| format!("cannot read {}", file.display()))?;
        let shown = file.strip_prefix(root).unwrap_or(file).display().to_string();
        let module = module_of(src, file);
        let children = children(&module, src, files);
        sources.insert(module, Source::read(shown, &text, &children));
    }
    let arrows: BTreeMap<&Module, BTreeSet<&Module>> =
        sources.keys().map(|from| (from, uses(from, &sources))).collect();
    let circles = components(&arrows).into_iter().filter(|files| files.len() > 1);
    let named = circles.map(|files| files.iter().map(|m| sources[*m].file.clone()).collect());
    let may_recur = |files: &Vec<String>| {
        MAY_RECUR.iter().any(|folder| files.iter().all(|file| file.starts_with(folder)))
    };
    Ok(named.filter(|files| !may_recur(files)).collect())
}

/// What is known of a file.
struct Source {
    file: String,
    /// Paths that it uses, from the crate, a parent or itself.
    paths: Vec<Vec<String>>,
    /// Names that it passes on, with the path where they come from.
    passed_on: BTreeMap<String, Vec<String>>,
    /// Names that it defines.
    defined: BTreeSet<String>,
}

impl Source {
    fn read(file: String, text: &str, children: &[String]) -> Self {
        let code = without_tests_and_comments(text);
        let (mut paths, mut passed_on) = (Vec::new(), BTreeMap::new());
        for statement in use_statements(&code) {
            let (is_public, tree) = statement;
            for path in flatten(&tree) {
                if is_public && let Some(name) = path.last() {
                    passed_on.insert(name.clone(), path.clone());
                } else {
                    paths.push(path);
                }
            }
        }
        paths.extend(inline_paths(&code, children));
        let defined = code.lines().filter_map(defined_name).collect();
        Self { file, paths, passed_on, defined }
    }
}

/// The module of a file below `src`.
fn module_of(src: &Path, file: &Path) -> Module {
    let relative = file.strip_prefix(src).unwrap_or(file).with_extension("");
    let mut parts: Module =
        relative.iter().map(|part| part.to_string_lossy().into_owned()).collect();
    if parts.last().is_some_and(|last| last == "mod" || last == "lib" || last == "main") {
        parts.pop();
    }
    parts
}

/// The names of the modules right below a module.
fn children(module: &Module, src: &Path, files: &[PathBuf]) -> Vec<String> {
    let below = files.iter().map(|file| module_of(src, file));
    let below = below.filter(|m| m.len() == module.len() + 1 && m.starts_with(module));
    below.filter_map(|mut m| m.pop()).collect()
}

/// A file's text before its tests.
pub(crate) fn before_tests(text: &str) -> &str {
    const MARK: &str = "#[cfg(test)]\n";
    let opens = |at: &usize| text[at + MARK.len()..].lines().next().unwrap_or("").ends_with('{');
    let tests = text.match_indices(MARK).map(|(at, _)| at).find(opens);
    tests.map_or(text, |at| &text[..at])
}

fn without_tests_and_comments(text: &str) -> String {
    let lines = before_tests(text).lines().filter(|line| !line.trim_start().starts_with("//"));
    lines.collect::<Vec<_>>().join("\n")
}

/// `use` statements: whether they pass names on, and their tree without `use` and semicolon.
fn use_statements(code: &str) -> Vec<(bool, String)> {
    let mut found = Vec::new();
    let mut lines = code.lines();
    while let Some(line) = lines.next() {
        let trimmed = line.trim_start();
        let is_public = trimmed.starts_with("pub");
        let Some(start) = ["use ", "pub use ", "pub(crate) use ", "pub(super) use "]
            .iter()
            .find_map(|word| trimmed.strip_prefix(word))
        else {
            continue;
        };
        let mut tree = start.to_string();
        while !tree.contains(';') {
            let Some(next) = lines.next() else { break };
            tree.push_str(next.trim());
        }
        found.push((is_public, tree.split(';').next().unwrap_or_default().to_string()));
    }
    found
}

/// `a::{b, c::{d, e}}` as its paths; of `x as y` the first name counts.
fn flatten(tree: &str) -> Vec<Vec<String>> {
    fn walk(tree: &str, before: &[String], found: &mut Vec<Vec<String>>) {
        let tree = tree.trim();
        if let Some(open) = tree.find('{') {
            let mut before = before.to_vec();
            before.extend(names(&tree[..open]));
            let inner = tree[open + 1..].trim_end().strip_suffix('}').unwrap_or(&tree[open + 1..]);
            split_top(inner).iter().for_each(|part| walk(part, &before, found));
        } else if !tree.is_empty() {
            let mut path = before.to_vec();
            path.extend(names(tree.split(" as ").next().unwrap_or(tree)));
            if path.last().is_some_and(|last| last == "self") && path.len() > 1 {
                path.pop();
            }
            found.push(path);
        }
    }
    let mut found = Vec::new();
    walk(tree, &[], &mut found);
    found
}

fn names(path: &str) -> impl Iterator<Item = String> + '_ {
    path.split("::").map(str::trim).filter(|name| !name.is_empty()).map(String::from)
}

/// Splits at commas that are in no braces.
fn split_top(text: &str) -> Vec<String> {
    let (mut parts, mut depth) = (vec![String::new()], 0);
    for c in text.chars() {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                parts.push(String::new());
                continue;
            }
            _ => {}
        }
        if let Some(last) = parts.last_mut() {
            last.push(c);
        }
    }
    parts
}

/// Paths in expressions and types that begin with `crate`, `super`, `self` or a child module.
fn inline_paths(code: &str, children: &[String]) -> Vec<Vec<String>> {
    let mut found = Vec::new();
    let starts = ["crate", "super", "self"].into_iter().chain(children.iter().map(String::as_str));
    let starts: Vec<String> = starts.map(|start| format!("{start}::")).collect();
    for line in code.lines().filter(|line| !line.contains("use ")) {
        for start in &starts {
            for (at, _) in line.match_indices(start.as_str()) {
                let is_name = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
                let before = line[..at].chars().next_back();
                if before.is_some_and(|c| c.is_alphanumeric() || c == '_' || c == ':') {
                    continue;
                }
                let end = line[at..].find(|c| !is_name(c)).map_or(line.len(), |end| at + end);
                found.push(names(&line[at..end]).collect());
            }
        }
    }
    found
}

/// The name that a line defines at the top of a file.
fn defined_name(line: &str) -> Option<String> {
    let mut words = line.split(|c: char| !(c.is_alphanumeric() || c == '_' || c == '('));
    let mut word = words.next()?;
    let skipped = ["pub", "pub(crate", "pub(super", "pub(in", "const", "unsafe", "async", ""];
    while skipped.contains(&word) {
        let next = words.next()?;
        if word == "const" && next != "fn" {
            return Some(next.into());
        }
        word = next;
    }
    let kinds = ["fn", "struct", "enum", "trait", "type", "static", "union", "macro_rules"];
    let name = kinds.contains(&word).then(|| words.find(|word| !word.is_empty())).flatten()?;
    Some(name.split('(').next().unwrap_or(name).into())
}

/// The files that a file uses.
fn uses<'s>(from: &Module, sources: &'s BTreeMap<Module, Source>) -> BTreeSet<&'s Module> {
    let paths = &sources[from].paths;
    let used = paths.iter().filter_map(|path| resolve(from, path, sources));
    used.filter(|module| *module != from).collect()
}

/// The file that defines what a path names.
fn resolve<'s>(
    from: &Module,
    path: &[String],
    sources: &'s BTreeMap<Module, Source>,
) -> Option<&'s Module> {
    let (mut module, mut rest) = start(from, path, sources)?;
    // A name may be passed on several times; a circle of passing on ends here.
    for _ in 0..sources.len() {
        while let Some(child) =
            rest.first().map(|name| [&module[..], std::slice::from_ref(name)].concat())
            && sources.contains_key(&child)
        {
            module = child;
            rest.remove(0);
        }
        let (found, source) = sources.get_key_value(&module)?;
        let Some(name) = rest.first() else { return Some(found) };
        match source.passed_on.get(name) {
            Some(path) if !source.defined.contains(name) => {
                (module, rest) = start(&found.clone(), &path.clone(), sources)?;
            }
            _ => return Some(found),
        }
    }
    None
}

/// Where a path begins: the module, and the names after it. `None` for paths out of the crate.
fn start(
    from: &Module,
    path: &[String],
    sources: &BTreeMap<Module, Source>,
) -> Option<(Module, Vec<String>)> {
    let (mut module, mut rest) = match path.first()?.as_str() {
        "crate" => (Vec::new(), path[1..].to_vec()),
        "self" => (from.clone(), path[1..].to_vec()),
        "super" => (from.clone(), path.to_vec()),
        name => {
            let child = [&from[..], &[name.to_string()]].concat();
            let is_here = sources.contains_key(&child);
            return is_here.then(|| (child, path[1..].to_vec()));
        }
    };
    while rest.first().is_some_and(|name| name == "super") {
        module.pop();
        rest.remove(0);
    }
    Some((module, rest))
}

/// Sets of files that reach each other (Tarjan's strongly connected components).
fn components<'s>(
    arrows: &BTreeMap<&'s Module, BTreeSet<&'s Module>>,
) -> Vec<BTreeSet<&'s Module>> {
    let reach = |from: &'s Module| {
        let (mut seen, mut open) = (BTreeSet::new(), vec![from]);
        while let Some(module) = open.pop() {
            let next = arrows.get(module).into_iter().flatten();
            open.extend(next.filter(|to| seen.insert(**to)).copied());
        }
        seen
    };
    let reached: BTreeMap<&Module, BTreeSet<&Module>> =
        arrows.keys().map(|from| (*from, reach(from))).collect();
    let mut found: Vec<BTreeSet<&Module>> = Vec::new();
    for (from, seen) in &reached {
        if seen.contains(from) && !found.iter().any(|files| files.contains(from)) {
            let mutual = seen.iter().filter(|to| reached[**to].contains(from));
            found.push(mutual.copied().collect());
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn circles_of(files: &[(&str, &str)]) -> Vec<Vec<String>> {
        let folder = std::env::temp_dir().join(format!("jrdb-cycles-{}", std::process::id()));
        let folder = folder.join(files.len().to_string());
        let paths: Vec<PathBuf> = files.iter().map(|(name, _)| folder.join(name)).collect();
        for (path, (_, text)) in paths.iter().zip(files) {
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        }
        let found = circles(&folder, &paths, &folder).unwrap();
        std::fs::remove_dir_all(&folder).unwrap();
        found
    }

    #[test]
    fn two_files_that_use_each_other_are_a_circle_even_through_a_name_passed_on() {
        let lib = ("lib.rs", "mod a;\nmod b;\npub use a::{A, other as Else};\n");
        let a = ("a.rs", "use crate::b::b;\npub struct A;\n");
        let b = ("b.rs", "use crate::A;\npub fn b(_: A) {}\n");
        assert_eq!(circles_of(&[lib, a, b]), [["a.rs", "b.rs"]]);
    }

    #[test]
    fn mod_lines_and_tests_are_not_uses() {
        let lib = ("lib.rs", "mod a;\n//! see crate::a\n");
        let a = ("a.rs", "mod inner;\nuse inner::X;\nfn f() {}\n");
        let inner = (
            "a/inner.rs",
            "pub struct X;\n#[cfg(test)]\nmod tests {\n    use super::super::f;\n}\n",
        );
        let other = ("other.rs", "fn g() { crate::a::f() }\n");
        assert_eq!(circles_of(&[lib, a, inner, other]), Vec::<Vec<String>>::new());
    }

    #[test]
    fn a_parent_and_its_module_are_a_circle_if_each_uses_the_other() {
        let lib = ("lib.rs", "mod a;\n");
        let a = ("a/mod.rs", "mod inner;\npub struct A;\nfn f() { inner::g() }\n");
        let inner = ("a/inner.rs", "use super::A;\npub fn g() {}\n");
        let found = circles_of(&[lib, a, inner]);
        assert_eq!(found, [["a/mod.rs", "a/inner.rs"]]);
    }

    #[test]
    fn trees_of_names_are_flattened() {
        let found = flatten("crate::{a::{self, B}, c as d}");
        assert_eq!(found, [vec!["crate", "a"], vec!["crate", "a", "B"], vec!["crate", "c"]]);
    }
}
