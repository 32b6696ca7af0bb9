//! Charts of scores as SVG: bars of an error budget, and a diagram of reliability.

use jrdb_types::score::{Budget, Reliability};

/// Width of a chart, pixels.
const WIDTH: f64 = 640.0;
/// Where bars begin, and where the zero of shares lies when none is negative, pixels.
const LEFT: f64 = 130.0;
/// Room right of the longest bar for its number, pixels.
const RIGHT: f64 = 70.0;
/// Height of a row, pixels.
const ROW: f64 = 26.0;
/// Height of a heading, pixels.
const HEADING: f64 = 40.0;

/// Colours that people with any colour vision tell apart: Okabe and Ito's blue and vermilion.
const GAIN: &str = "#0072b2";
const LOSS: &str = "#d55e00";

/// The Shapley shares of some budgets, one block of bars for each: what each part of the truth is
/// worth. A part that costs something when it is given points to the left.
#[must_use]
pub fn budget_chart(budgets: &[(String, Budget)]) -> String {
    let (mut body, mut top) = (String::new(), 0.0);
    for (name, budget) in budgets {
        body += &budget_block(name, budget, top);
        top += HEADING + ROW * budget.shares.len() as f64;
    }
    svg(top + 10.0, &body)
}

fn budget_block(name: &str, budget: &Budget, top: f64) -> String {
    let shares = || budget.shares.iter().map(|share| share.shapley);
    let (least, most) = (shares().fold(0.0, f64::min), shares().fold(0.0, f64::max));
    let scale = (WIDTH - LEFT - RIGHT) / (most - least).max(f64::MIN_POSITIVE);
    let zero = LEFT - least * scale;
    let (from, to) = (budget.without, budget.with_all);
    let title = format!("{name}: from {from:.3} to {to:.3} with everything given");
    let mut text = label(10.0, top + 26.0, "start", &title);
    for (number, share) in budget.shares.iter().enumerate() {
        let y = top + HEADING + ROW * number as f64;
        let (value, length) = (share.shapley, share.shapley.abs() * scale);
        let (x, colour) = if value < 0.0 { (zero - length, LOSS) } else { (zero, GAIN) };
        text += &label(LEFT - 40.0, y + 14.0, "end", &share.truth);
        text += &format!(
            "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{length:.1}\" height=\"18\" fill=\"{colour}\"/>\n"
        );
        text += &label(zero.max(x + length) + 6.0, y + 14.0, "start", &format!("{value:+.3}"));
    }
    text
}

/// How often candidates are right beside their stated probability: on the diagonal they are as
/// often right as they say. The area of a point grows with the number of its candidates.
#[must_use]
pub fn reliability_chart(of: &Reliability) -> String {
    const SIDE: f64 = 320.0;
    const TOP: f64 = 40.0;
    let place =
        |probability: f64, right: f64| (LEFT + SIDE * probability, TOP + SIDE * (1.0 - right));
    let total: usize = of.bins.iter().map(|bin| bin.count).sum();
    let title = format!("expected calibration error {:.3}", of.calibration_error);
    let mut body = label(LEFT, 26.0, "start", &title);
    body += &format!(
        "<rect x=\"{LEFT}\" y=\"{TOP}\" width=\"{SIDE}\" height=\"{SIDE}\" fill=\"none\" stroke=\"#777777\"/>\n"
    );
    let ((x0, y0), (x1, y1)) = (place(0.0, 0.0), place(1.0, 1.0));
    body += &format!(
        "<line x1=\"{x0}\" y1=\"{y0}\" x2=\"{x1}\" y2=\"{y1}\" stroke=\"#777777\" stroke-dasharray=\"4\"/>\n"
    );
    for bin in of.bins.iter().filter(|bin| bin.count > 0) {
        let (x, y) = place(bin.probability, bin.right);
        let radius = 3.0 + 17.0 * (bin.count as f64 / total as f64).sqrt();
        body += &format!(
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius:.1}\" fill=\"{GAIN}\" fill-opacity=\"0.6\"><title>{} candidates, stated {:.3}, right {:.3}</title></circle>\n",
            bin.count, bin.probability, bin.right
        );
    }
    for tick in [0.0, 0.5, 1.0] {
        let ((x, _), (_, y)) = (place(tick, 0.0), place(0.0, tick));
        body += &label(x, TOP + SIDE + 18.0, "middle", &tick.to_string());
        body += &label(LEFT - 8.0, y + 5.0, "end", &tick.to_string());
    }
    body += &label(LEFT + SIDE / 2.0, TOP + SIDE + 36.0, "middle", "stated probability");
    body += &label(LEFT - 40.0, TOP + SIDE / 2.0, "end", "right");
    svg(TOP + SIDE + 50.0, &body)
}

fn label(x: f64, y: f64, anchor: &str, text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;");
    format!("<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{text}</text>\n")
}

fn svg(height: f64, body: &str) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{height}\" \
         font-family=\"sans-serif\" font-size=\"14\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n{body}</svg>\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use jrdb_types::score::{ReliabilityBin, Share};

    #[test]
    fn bars_are_as_long_as_shares_and_point_to_their_side() {
        let share = |truth: &str, shapley| {
            let truth = truth.into();
            Share { truth, alone: 0.0, cumulative: 0.0, shapley }
        };
        let shares = vec![share("position", 0.3), share("a<b", -0.1)];
        let budget = Budget { without: 0.5, with_all: 0.7, shares };
        let chart = budget_chart(&[("exact".into(), budget)]);
        assert!(chart.contains("exact: from 0.500 to 0.700"), "{chart}");
        assert!(chart.contains("x=\"240.0\" y=\"40.0\" width=\"330.0\""), "{chart}");
        assert!(chart.contains("x=\"130.0\" y=\"66.0\" width=\"110.0\""), "{chart}");
        assert!(chart.contains("a&lt;b") && chart.contains("-0.100"), "{chart}");
    }

    #[test]
    fn a_bin_is_a_point_at_its_probability_and_its_share_of_right_ones() {
        let bin = |count, probability, right| ReliabilityBin {
            from: 0.0,
            to: 0.5,
            count,
            probability,
            right,
        };
        let bins = vec![bin(3, 0.5, 0.25), bin(0, 0.0, 0.0)];
        let chart = reliability_chart(&Reliability { calibration_error: 0.25, bins });
        assert_eq!(chart.matches("<circle").count(), 1);
        assert!(chart.contains("cx=\"290.0\" cy=\"280.0\""), "{chart}");
        assert!(chart.contains("calibration error 0.250"), "{chart}");
    }
}
