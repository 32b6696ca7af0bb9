//! Clouds to PCD files, laid out as JRDB's.

use std::fmt::Write;

use jrdb_types::PointCloud;

use super::encoding::Encoding;
use super::lzf;

/// The cloud as a PCD file of 4-byte floats: `x y z`, and `intensity` where the cloud has it.
///
/// The header is JRDB's. Equal clouds give equal bytes.
#[must_use]
pub fn write(cloud: &PointCloud, encoding: Encoding) -> Vec<u8> {
    let columns = columns(cloud);
    let mut bytes = header(columns.len(), cloud.len(), encoding).into_bytes();
    match encoding {
        Encoding::Ascii => bytes.extend(ascii(&columns, cloud.len()).bytes()),
        Encoding::Binary => bytes.extend(rows(&columns, cloud.len()).flat_map(f32::to_le_bytes)),
        Encoding::BinaryCompressed => {
            let planar: Vec<u8> =
                columns.iter().copied().flatten().flat_map(|v| v.to_le_bytes()).collect();
            let stream = lzf::compress(&planar);
            bytes.extend((stream.len() as u32).to_le_bytes());
            bytes.extend((planar.len() as u32).to_le_bytes());
            bytes.extend(stream);
        }
    }
    bytes
}

fn columns(cloud: &PointCloud) -> Vec<&[f32]> {
    let mut columns = vec![&cloud.x[..], &cloud.y, &cloud.z];
    if !cloud.intensity.is_empty() {
        columns.push(&cloud.intensity);
    }
    columns
}

fn header(columns: usize, points: usize, encoding: Encoding) -> String {
    let fields = &["x", "y", "z", "intensity"][..columns];
    let each = |word: &str| vec![word; columns].join(" ");
    let data = match encoding {
        Encoding::Ascii => "ascii",
        Encoding::Binary => "binary",
        Encoding::BinaryCompressed => "binary_compressed",
    };
    format!(
        "VERSION 0.7\nFIELDS {}\nSIZE {}\nTYPE {}\nCOUNT {}\nWIDTH {points}\nHEIGHT 1\n\
         VIEWPOINT 0.0 0.0 0.0 1.0 0.0 0.0 0.0\nPOINTS {points}\nDATA {data}\n",
        fields.join(" "),
        each("4"),
        each("F"),
        each("1"),
    )
}

/// Every number, point after point.
fn rows(columns: &[&[f32]], points: usize) -> impl Iterator<Item = f32> {
    (0..points).flat_map(move |row| columns.iter().map(move |column| column[row]))
}

fn ascii(columns: &[&[f32]], points: usize) -> String {
    let mut text = String::new();
    for (i, value) in rows(columns, points).enumerate() {
        let end = if (i + 1) % columns.len() == 0 { '\n' } else { ' ' };
        write!(text, "{value}{end}").expect("writing to memory does not fail");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_looks_like_jrdb_s() {
        let cloud = PointCloud {
            x: vec![1.0, -2.5],
            y: vec![0.0, 3.0],
            z: vec![0.1, 0.0],
            intensity: vec![7.0, 8.0],
            ..PointCloud::default()
        };
        let text = String::from_utf8(write(&cloud, Encoding::Ascii)).unwrap();
        assert_eq!(
            text,
            "VERSION 0.7\nFIELDS x y z intensity\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\n\
             WIDTH 2\nHEIGHT 1\nVIEWPOINT 0.0 0.0 0.0 1.0 0.0 0.0 0.0\nPOINTS 2\nDATA ascii\n\
             1 0 0.1 7\n-2.5 3 0 8\n"
        );
    }
}
