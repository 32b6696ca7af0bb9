//! Runs the parser on random texts for a given time.
//!
//! `cargo run --release -p jrdb-parser --example fuzz_parser -- [SECONDS] [SEED]`
//!
//! Texts are sentences of the tests, cut up and mixed, their words in random order, and random
//! characters. Most are short; a few are very long. Each text must be read without a panic and in
//! time linear in its length. Each issue must cover whole characters, the explanation must print,
//! and the notation must read back as the same query. The first failure is printed and ends the run
//! with exit code 1.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "its result is what it prints")]

use std::process::ExitCode;
use std::time::{Duration, Instant};

use jrdb_parser::{OfPerson, ParserConfig, explain, notation, parse_with};

const SENTENCES: &str = include_str!("../tests/sentences.query");

/// Time allowed per text, plus time per byte.
const PER_TEXT: Duration = Duration::from_millis(50);
const PER_BYTE: Duration = Duration::from_micros(5);

/// Characters that often cause faults: marks, quotes, controls, wide, combining, right to left,
/// outside the first plane.
const ODD: &[char] = &[
    ' ', ' ', ',', '.', '?', '!', '\'', '’', '"', '-', '–', '/', '\\', '(', ')', '[', ']', '{',
    '}', ':', ';', '&', '%', '0', '9', '\n', '\t', '\r', '\0', '\u{7f}', 'é', 'ß', 'İ', 'ﬀ',
    '\u{301}', '人', 'א', '\u{202e}', '\u{200b}', '𝒳', '👩',
];

/// SplitMix64.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, n: usize) -> usize {
        (self.next() % n.max(1) as u64) as usize
    }

    fn of<'a, T>(&mut self, all: &'a [T]) -> &'a T {
        &all[self.below(all.len())]
    }
}

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1).map(|text| text.parse::<u64>().ok());
    let seconds = arguments.next().flatten().unwrap_or(60);
    let seed = arguments.next().flatten().unwrap_or(0);
    let lines = SENTENCES.lines().map(str::trim).filter(|line| !line.is_empty());
    let sentences: Vec<&str> = lines.filter(|line| !line.starts_with(['#', '=', '!'])).collect();
    let words: Vec<&str> = sentences.iter().flat_map(|sentence| sentence.split(' ')).collect();
    let (mut random, start, mut texts, mut bytes) = (Random(seed), Instant::now(), 0_u64, 0_u64);
    while start.elapsed() < Duration::from_secs(seconds) {
        let text = any_text(&mut random, &sentences, &words);
        let viewpoint = *random.of(&[OfPerson::Own, OfPerson::Robot]);
        let config = ParserConfig { viewpoint };
        let checked = std::panic::catch_unwind(|| check(&text, &config));
        if let Err(fault) = checked.unwrap_or_else(|_| Err("a panic".into())) {
            eprintln!("{fault}, seed {seed}, text {texts}: {text:?}");
            return ExitCode::FAILURE;
        }
        texts += 1;
        bytes += text.len() as u64;
    }
    println!("{texts} texts of {bytes} bytes in {seconds} s, seed {seed}: nothing found");
    ExitCode::SUCCESS
}

fn check(text: &str, config: &ParserConfig) -> Result<(), String> {
    let start = Instant::now();
    let query = parse_with(text, config);
    let took = start.elapsed();
    if took > PER_TEXT + PER_BYTE * u32::try_from(text.len()).unwrap_or(u32::MAX) {
        return Err(format!("took {took:?} for {} bytes", text.len()));
    }
    for span in query.issues.iter().filter_map(|issue| issue.span) {
        if text.get(span.start..span.end).is_none() {
            return Err(format!("an issue at {span:?}"));
        }
    }
    let _ = explain(text, &query);
    let written = notation::write(&query);
    let back = notation::read(&written).map_err(|error| format!("{written}: {error}"))?;
    // The notation leaves out where a phrase stands in the text.
    if notation::write(&back) == written {
        Ok(())
    } else {
        Err(format!("{written} reads back otherwise"))
    }
}

fn any_text(random: &mut Random, sentences: &[&str], words: &[&str]) -> String {
    match random.below(100) {
        0..40 => {
            let sentence = *random.of(sentences);
            mutated(sentence, random)
        }
        40..60 => {
            let (one, other) = (*random.of(sentences), *random.of(sentences));
            format!("{} {}", half(one, random), half(other, random))
        }
        60..85 => {
            let count = 1 + random.below(25);
            (0..count).map(|_| *random.of(words)).collect::<Vec<_>>().join(" ")
        }
        85..97 => {
            let count = random.below(60);
            (0..count).map(|_| any_char(random)).collect()
        }
        97..99 => (*random.of(sentences)).repeat(1 + random.below(60)),
        _ => {
            let count = 1 + random.below(400);
            let word = *random.of(words);
            (0..count)
                .map(|_| if random.below(3) == 0 { *random.of(words) } else { word })
                .collect::<Vec<_>>()
                .join(" ")
        }
    }
}

/// The beginning or the end of a sentence.
fn half(sentence: &str, random: &mut Random) -> String {
    let words: Vec<&str> = sentence.split(' ').collect();
    let (start, end) = words.split_at(random.below(words.len()));
    if random.below(2) == 0 { start.join(" ") } else { end.join(" ") }
}

/// A sentence with a few characters taken out, put in, doubled or exchanged.
fn mutated(sentence: &str, random: &mut Random) -> String {
    let mut characters: Vec<char> = sentence.chars().collect();
    for _ in 0..random.below(6) {
        let at = random.below(characters.len());
        match random.below(4) {
            0 if !characters.is_empty() => drop(characters.remove(at)),
            1 => characters.insert(at, any_char(random)),
            2 if !characters.is_empty() => characters.insert(at, characters[at]),
            3 if at + 1 < characters.len() => characters.swap(at, at + 1),
            _ => {}
        }
    }
    characters.into_iter().collect()
}

fn any_char(random: &mut Random) -> char {
    match random.below(3) {
        0 => *random.of(ODD),
        1 => char::from(b'a' + random.below(26) as u8),
        _ => char::from_u32(random.below(0x11_0000) as u32).unwrap_or('x'),
    }
}
