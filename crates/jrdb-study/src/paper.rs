//! The numbers that the paper prints, to be shown beside those measured here.

use crate::table::{Cell, Origin, Role, Row};

/// The file they are in.
const PRINTED: &str = include_str!("../data/paper.csv");

/// The metrics of each category, as the paper names them.
pub const METRICS: [&str; 2] = ["mAP", "mIoU"];

/// A table of results of the paper.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Printed {
    /// Its number.
    pub number: String,
    /// Its categories.
    pub categories: Vec<String>,
    /// Its rows, with two cells per category.
    pub rows: Vec<Row>,
}

impl Printed {
    /// The rows with the cells of some categories only, in their order. A category that the table
    /// does not have has no cells.
    #[must_use]
    pub fn rows_for(&self, categories: &[String]) -> Vec<Row> {
        let place = |name: &String| self.categories.iter().position(|known| known == name);
        let pair = |row: &Row, category: Option<usize>, metric: usize| {
            category.and_then(|place| row.cells[place * METRICS.len() + metric])
        };
        let cells = |row: &Row| {
            let columns =
                categories.iter().flat_map(|name| (0..METRICS.len()).map(move |m| (name, m)));
            columns.map(|(name, metric)| pair(row, place(name), metric)).collect()
        };
        self.rows.iter().map(|row| Row { cells: cells(row), ..row.clone() }).collect()
    }
}

/// What the paper prints.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Paper {
    /// Its tables of results.
    pub tables: Vec<Printed>,
    /// Methods and their parameters, in billions.
    pub parameters: Vec<(String, f64)>,
}

impl Paper {
    /// Reads the numbers that come with this crate.
    ///
    /// ```
    /// let paper = jrdb_study::Paper::printed();
    /// let ours = &paper.tables[0].rows[6];
    /// assert_eq!(ours.method, "Our Framework");
    /// assert_eq!(ours.cells[0].map(|cell| cell.value), Some(16.53));
    /// ```
    #[must_use]
    pub fn printed() -> Self {
        let mut paper = Self::default();
        for line in PRINTED.lines().filter(|line| !line.starts_with('#')) {
            let fields: Vec<&str> = line.split(',').collect();
            paper.add(&fields);
        }
        paper
    }

    /// The table of this number.
    #[must_use]
    pub fn table(&self, number: &str) -> Option<&Printed> {
        self.tables.iter().find(|table| table.number == number)
    }

    fn add(&mut self, fields: &[&str]) {
        match fields {
            ["table", number, categories @ ..] => self.tables.push(Printed {
                number: (*number).into(),
                categories: categories.iter().map(|name| (*name).into()).collect(),
                rows: Vec::new(),
            }),
            ["parameters", method, billions] => {
                self.parameters.push(((*method).into(), number(billions)));
            }
            [role, method, results @ ..] => {
                let rows = self.tables.last_mut().map(|table| &mut table.rows);
                rows.expect("a table comes before its rows").push(row(role, method, results));
            }
            _ => {}
        }
    }
}

fn row(role: &str, method: &str, results: &[&str]) -> Row {
    let cells = results.iter().flat_map(|pair| pair.split(' '));
    Row {
        method: method.into(),
        role: if role == "baseline" { Role::Baseline } else { Role::Method },
        origin: Origin::Quoted,
        cells: cells.map(|text| Some(Cell::plain(number(text)))).collect(),
        failure: None,
    }
}

fn number(text: &str) -> f64 {
    text.parse().expect("the file that comes with the crate holds numbers")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the paper prints above its numbers: the change against the best baseline, percent.
    const PRINTED_CHANGES: [(&str, &str, &[f64]); 4] = [
        (
            "1",
            "Our Framework",
            &[35.7, 18.2, 96.7, 67.8, 43.0, 35.1, 15.1, 6.9, 15.0, 9.6, 9.3, -13.6, -14.4, -18.4],
        ),
        ("2", "Qwen2.5-VL-3B", &[33.0, 34.4, 10.3, 18.5, 10.2, 12.3, 2.2, 1.8]),
        ("2", "InternVL3.5-2B", &[19.1, 17.4, 6.7, 11.1, 15.7, 13.8, 3.3, 4.3]),
        ("2", "InternVL3.5-4B", &[55.7, 57.8, 35.0, 40.9, 24.9, 32.7, 19.6, 9.8]),
    ];

    fn changes(number: &str, method: &str) -> Vec<f64> {
        let paper = Paper::printed();
        let printed = paper.table(number).unwrap();
        let table = crate::Table {
            title: String::new(),
            unit: crate::Unit::Percent,
            categories: printed.categories.clone(),
            metrics: METRICS.map(String::from).to_vec(),
            rows: printed.rows.clone(),
            notes: Vec::new(),
        };
        let row = printed.rows.iter().find(|row| row.method == method).unwrap();
        (0..row.cells.len()).map(|at| table.mark(row, at).change_percent.unwrap()).collect()
    }

    #[test]
    fn its_changes_follow_from_its_numbers() {
        let mut count = 0;
        for (number, method, printed) in PRINTED_CHANGES {
            for (computed, printed) in changes(number, method).into_iter().zip(printed) {
                assert!((computed - printed).abs() < 0.1, "{method}: {computed} is not {printed}");
                count += 1;
            }
        }
        assert_eq!(count, 38);
    }

    #[test]
    fn conformance_its_numbers_are_those_of_the_research_data() {
        let path =
            concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/reference/paper-tables.csv");
        let Ok(text) = std::fs::read_to_string(path) else {
            println!("skipped: no shared data");
            return;
        };
        let paper = Paper::printed();
        let wanted = text.lines().skip(1).map(|line| line.split(',').collect::<Vec<_>>());
        let mut count = 0;
        for fields in wanted {
            let [table, method, category, metric, value, _] = fields[..] else {
                panic!("{fields:?}")
            };
            let found = match paper.table(table) {
                Some(printed) => {
                    let rows = printed.rows_for(&[category.into()]);
                    let row = rows.iter().find(|row| row.method == method).unwrap();
                    let at = METRICS.iter().position(|name| *name == metric).unwrap();
                    row.cells[at].unwrap().value
                }
                None => paper.parameters.iter().find(|(name, _)| name == method).unwrap().1,
            };
            assert_eq!(found, value.parse::<f64>().unwrap(), "{fields:?}");
            count += 1;
        }
        assert_eq!(count, 129);
    }

    #[test]
    fn a_category_that_a_table_lacks_has_no_cells() {
        let paper = Paper::printed();
        let rows = paper.table("2").unwrap().rows_for(&["human".into(), "gender-age-race".into()]);
        assert_eq!(rows[1].cells[..2], [None, None]);
        assert_eq!(rows[1].cells[2].map(|cell| cell.value), Some(16.3));
    }
}
