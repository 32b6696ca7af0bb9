//! Which inputs make one output, and how much of each.

use super::filter::Filter;

pub(super) const FRACTION_BITS: u32 = 22;

/// The inputs of a row of outputs, of each the same number.
#[derive(Debug, Clone, Default)]
pub(super) struct Taps {
    /// How many inputs and outputs they are for.
    sizes: [usize; 2],
    filter: Option<Filter>,
    /// The first input of each output.
    pub(super) firsts: Vec<usize>,
    /// How many inputs every output has.
    pub(super) count: usize,
    /// Of each output's inputs, in units of 2⁻²²; the magnitudes of one output's sum to less than
    /// 2, so that 255 times their sum fits 32 bits. Outputs that need fewer have zeros.
    pub(super) weights: Vec<i32>,
}

impl Taps {
    /// Sets them for this many inputs, at least one, and outputs.
    pub(super) fn set(&mut self, input: usize, output: usize, filter: Filter) {
        if self.sizes == [input, output] && self.filter == Some(filter) {
            return;
        }
        let each: Vec<(usize, Vec<i32>)> =
            (0..output).map(|at| one_output(at, input, output, filter)).collect();
        let count = each.iter().map(|(_, weights)| weights.len()).max().unwrap_or_default();
        (self.sizes, self.filter, self.count) = ([input, output], Some(filter), count);
        self.firsts.clear();
        self.weights.clear();
        for (first, weights) in each {
            // Zeros before the weights where there are no inputs behind them.
            let start = first.min(input - count);
            let end = self.weights.len() + count;
            self.weights.resize(self.weights.len() + first - start, 0);
            self.weights.extend(weights);
            self.weights.resize(end, 0);
            self.firsts.push(start);
        }
    }
}

fn one_output(at: usize, input: usize, output: usize, filter: Filter) -> (usize, Vec<i32>) {
    let scale = input as f64 / output as f64;
    let stretch = scale.max(1.0);
    let reach = filter.reach() * stretch;
    let center = (at as f64 + 0.5) * scale;
    // Conversions to integers cut the fraction off, and negative numbers to 0.
    let first = (center - reach + 0.5) as usize;
    let end = ((center + reach + 0.5) as usize).min(input);
    let squeeze = 1.0 / stretch;
    let weight = |j: usize| filter.weight((j as f64 - center + 0.5) * squeeze);
    let exact: Vec<f64> = (first..end).map(weight).collect();
    let sum: f64 = exact.iter().sum();
    let unit = f64::from(1_u32 << FRACTION_BITS);
    (first, exact.iter().map(|w| (w / sum * unit).round() as i32).collect())
}
