//! Changes of an input that keep its structure, so that they get past the first check.

use serde_json::{Map, Value, json};

use crate::random::Random;

/// How an input is built.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Structure {
    /// Bytes without more.
    Bytes,
    /// Chunks with lengths and checksums.
    Png,
    /// Segments with lengths.
    Jpeg,
    /// Lines of a header, and a body whose length follows from them.
    Pcd,
    /// One JSON value.
    Json,
    /// A JSON value a line.
    JsonLines,
    /// Lines with scalars: YAML, headers, questions.
    Text,
}

/// Numbers at which programs go wrong, as text.
const NUMBERS: [&str; 14] = [
    "0",
    "-1",
    "1",
    "255",
    "256",
    "65535",
    "65536",
    "4294967295",
    "-2147483648",
    "1e308",
    "1e-308",
    "nan",
    "9223372036854775807",
    "99999999999999999999",
];

/// An input, changed in one to four places.
pub(crate) fn mutated(seed: &[u8], structure: Structure, random: &mut Random) -> Vec<u8> {
    let mut bytes = seed.to_vec();
    for _ in 0..=random.below(4) {
        // Now and then bytes only: a broken structure is an input, too.
        let structure = if random.one_in(8) { Structure::Bytes } else { structure };
        bytes = match structure {
            Structure::Bytes => changed_bytes(bytes, random),
            Structure::Png => png(&bytes, random),
            Structure::Jpeg => jpeg(bytes, random),
            Structure::Pcd => pcd(&bytes, random),
            Structure::Json => json_bytes(&bytes, random),
            Structure::JsonLines => json_lines(&bytes, random),
            Structure::Text => text(&bytes, random),
        };
    }
    bytes
}

fn changed_bytes(mut bytes: Vec<u8>, random: &mut Random) -> Vec<u8> {
    let at = random.below(bytes.len());
    match random.below(5) {
        0 => bytes.truncate(at),
        1 => {
            let length = random.below(16);
            let end = bytes.len().min(at + length);
            bytes.splice(at..end, (0..random.below(16)).map(|_| 0).collect::<Vec<u8>>());
        }
        2 => {
            let end = bytes.len().min(at + 64);
            let again = bytes[at..end].to_vec();
            bytes.splice(at..at, again);
        }
        _ if bytes.is_empty() => bytes.push(random.byte()),
        3 => bytes[at] ^= 1 << random.below(8),
        _ => bytes[at] = random.byte(),
    }
    bytes
}

/// PNG's checksum.
fn crc(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| (crc >> 1) ^ (0xedb8_8320 * (crc & 1)))
    })
}

const PNG_HEAD: usize = 8;
const PNG_CHUNKS: [&[u8; 4]; 12] = [
    b"PLTE", b"tRNS", b"gAMA", b"cHRM", b"sBIT", b"iCCP", b"eXIf", b"acTL", b"fcTL", b"fdAT",
    b"IDAT", b"IEND",
];

fn png(bytes: &[u8], random: &mut Random) -> Vec<u8> {
    let mut chunks: Vec<([u8; 4], Vec<u8>)> = Vec::new();
    let mut rest = bytes.get(PNG_HEAD..).unwrap_or_default();
    while let Some((&[a, b, c, d, name @ ..], behind)) = rest.split_first_chunk::<8>() {
        let length = (u32::from_be_bytes([a, b, c, d]) as usize).min(behind.len());
        chunks.push((name, behind[..length].to_vec()));
        rest = behind.get(length + 4..).unwrap_or_default();
    }
    let at = random.below(chunks.len());
    match random.below(6) {
        0 if !chunks.is_empty() => drop(chunks.remove(at)),
        1 if !chunks.is_empty() => chunks.insert(at, chunks[at].clone()),
        2 => {
            let length = random.below(40);
            let data = (0..length).map(|_| random.byte()).collect();
            chunks.insert(at, (**random.pick(&PNG_CHUNKS), data));
        }
        _ if chunks.is_empty() => {}
        3 => chunks[at].0 = **random.pick(&PNG_CHUNKS),
        _ => chunks[at].1 = changed_bytes(std::mem::take(&mut chunks[at].1), random),
    }
    let mut whole = bytes.get(..PNG_HEAD).unwrap_or_default().to_vec();
    for (name, data) in chunks {
        let named = [&name[..], &data].concat();
        whole.extend(u32::try_from(data.len()).unwrap_or(u32::MAX).to_be_bytes());
        whole.extend(&named);
        whole.extend(crc(&named).to_be_bytes());
    }
    whole
}

/// Changes a marker, a length or a byte of a segment before the first scan.
fn jpeg(mut bytes: Vec<u8>, random: &mut Random) -> Vec<u8> {
    let marks: Vec<usize> =
        (0..bytes.len().saturating_sub(4)).filter(|at| bytes[*at] == 0xff).collect();
    if marks.is_empty() {
        return changed_bytes(bytes, random);
    }
    let at = *random.pick(&marks);
    match random.below(4) {
        0 => bytes[at + 1] = random.byte() | 0xc0,
        1 => bytes[at + 3] = random.byte(),
        2 => {
            let end = bytes.len().min(at + 2 + usize::from(bytes[at + 3]));
            bytes.drain(at..end);
        }
        _ => {
            let place = (at + 4 + random.below(24)).min(bytes.len() - 1);
            bytes[place] = random.byte();
        }
    }
    bytes
}

/// The most that a body is lengthened to, bytes.
const BODY_MAX: usize = 1 << 16;

/// Changes a word of the header; every other time the body gets the length that the header then states.
fn pcd(bytes: &[u8], random: &mut Random) -> Vec<u8> {
    let Some(data) = bytes.windows(5).position(|word| word == b"DATA ") else {
        return changed_bytes(bytes.to_vec(), random);
    };
    let line = bytes[data..].iter().position(|byte| *byte == b'\n');
    let end = line.map_or(bytes.len(), |line| data + line + 1);
    let header = text(&bytes[..end], random);
    let mut body = bytes[end..].to_vec();
    if random.one_in(2) {
        let words = String::from_utf8_lossy(&header).into_owned();
        let numbers = |key: &str| -> Vec<usize> {
            let line = words.lines().find(|line| line.starts_with(key)).unwrap_or_default();
            line.split_whitespace().skip(1).filter_map(|word| word.parse().ok()).collect()
        };
        let counts = numbers("COUNT").into_iter().chain(std::iter::repeat(1));
        let row = numbers("SIZE").into_iter().zip(counts);
        let row: usize = row.map(|(size, count)| size.saturating_mul(count).min(BODY_MAX)).sum();
        let points = numbers("POINTS").first().copied().unwrap_or_default();
        body.resize(row.saturating_mul(points).min(BODY_MAX), 0);
    }
    [header, body].concat()
}

fn text(bytes: &[u8], random: &mut Random) -> Vec<u8> {
    let whole = String::from_utf8_lossy(bytes).into_owned();
    let mut lines: Vec<String> = whole.split('\n').map(String::from).collect();
    let at = random.below(lines.len());
    match random.below(6) {
        0 => drop(lines.remove(at)),
        1 => lines.insert(at, lines[at].clone()),
        _ => {
            let mut words: Vec<String> = lines[at].split(' ').map(String::from).collect();
            let word = random.below(words.len());
            match random.below(5) {
                0 => drop(words.remove(word)),
                1 => {
                    let times = random.below(200);
                    words.extend(std::iter::repeat_n(words[word].clone(), times));
                }
                2 => words[word] = "[".repeat(1 + random.below(300)),
                _ => words[word] = (*random.pick(&NUMBERS)).into(),
            }
            lines[at] = words.join(" ");
        }
    }
    lines.join("\n").into_bytes()
}

fn json_bytes(bytes: &[u8], random: &mut Random) -> Vec<u8> {
    let Ok(mut value) = serde_json::from_slice::<Value>(bytes) else {
        return text(bytes, random);
    };
    change(&mut value, random);
    serde_json::to_vec(&value).unwrap_or_default()
}

fn json_lines(bytes: &[u8], random: &mut Random) -> Vec<u8> {
    let whole = String::from_utf8_lossy(bytes).into_owned();
    let mut lines: Vec<Vec<u8>> = whole.lines().map(|line| line.as_bytes().to_vec()).collect();
    let at = random.below(lines.len());
    if let Some(line) = lines.get_mut(at) {
        *line = json_bytes(line, random);
    }
    lines.join(&b'\n')
}

/// Changes one value somewhere inside.
fn change(value: &mut Value, random: &mut Random) {
    match value {
        Value::Object(map) if !map.is_empty() && !random.one_in(6) => change_object(map, random),
        Value::Array(list) if !list.is_empty() && !random.one_in(6) => change_list(list, random),
        _ => *value = odd(value, random),
    }
}

fn change_object(map: &mut Map<String, Value>, random: &mut Random) {
    let keys: Vec<String> = map.keys().cloned().collect();
    let key = random.pick(&keys).clone();
    match random.below(12) {
        0 => drop(map.remove(&key)),
        1 => {
            let value = map.remove(&key).unwrap_or_default();
            map.insert(format!("{key}x"), value);
        }
        _ => {
            if let Some(inner) = map.get_mut(&key) {
                change(inner, random);
            }
        }
    }
}

fn change_list(list: &mut Vec<Value>, random: &mut Random) {
    let at = random.below(list.len());
    match random.below(12) {
        0 => drop(list.remove(at)),
        1 => {
            let times = random.below(60);
            list.extend(std::iter::repeat_n(list[at].clone(), times));
        }
        _ => change(&mut list[at], random),
    }
}

fn odd(value: &Value, random: &mut Random) -> Value {
    if let (Value::String(words), true) = (value, random.one_in(2)) {
        return match random.below(3) {
            0 => json!(words.repeat(2)),
            1 => json!(words.chars().rev().collect::<String>()),
            _ => json!(format!("{words}:\u{0}/../{}", random.pick(&NUMBERS))),
        };
    }
    match random.below(9) {
        0 => Value::Null,
        1 => json!([]),
        2 => json!({}),
        3 => json!(true),
        4 => json!(""),
        5 => json!(vec![value.clone(); 3]),
        6 => json!([[[[[[[[value.clone()]]]]]]]]),
        7 => json!(*random.pick(&NUMBERS)),
        _ => {
            let number: &&str = random.pick(&NUMBERS);
            serde_json::from_str(number).unwrap_or(Value::Null)
        }
    }
}
