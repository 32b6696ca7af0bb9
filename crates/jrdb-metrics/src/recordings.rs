//! The questions of a run by recording, which is what varies independently.

use std::collections::BTreeMap;

use jrdb_types::score::{Interval, IntervalWarning, Metric, QuestionScore};

use crate::bootstrap::{BootstrapConfig, Contrast, FEW_RECORDINGS};
use crate::jackknife;
use crate::pool::{List, Pool, Precisions, mean};
use crate::ratio::{Ratio, ratio};

/// Average precision of a run, and without each recording.
struct Averages {
    whole: Precisions,
    without: Vec<Precisions>,
}

/// The questions of a run by recording.
pub(crate) struct Recordings<'a> {
    /// Each question with the number of its recording, by name.
    questions: Vec<(usize, &'a QuestionScore)>,
    /// How many recordings there are.
    pub(crate) count: usize,
    ranking: Option<Averages>,
    selection: Option<Averages>,
}

/// How sure a metric, or a difference, is.
pub(crate) struct Sureness {
    pub(crate) interval: Option<Interval>,
    /// How many recordings tell it; where none does, it has no value.
    pub(crate) recordings: usize,
    pub(crate) warning: Option<IntervalWarning>,
}

impl<'a> Recordings<'a> {
    pub(crate) fn new(questions: &[&'a QuestionScore]) -> Self {
        let names = questions.iter().map(|one| (one.frame.sequence.as_str(), 0));
        let mut numbers: BTreeMap<&str, usize> = names.collect();
        numbers.values_mut().zip(0..).for_each(|(number, place)| *number = place);
        let number = |one: &&'a QuestionScore| (numbers[one.frame.sequence.as_str()], *one);
        let questions: Vec<_> = questions.iter().map(number).collect();
        let averages = |list| averages(&Pool::new(&questions, numbers.len(), list), numbers.len());
        let (ranking, selection) = (averages(List::Ranking), averages(List::Selection));
        Self { count: numbers.len(), questions, ranking, selection }
    }

    /// How sure a metric of this run is.
    pub(crate) fn sureness(&self, metric: Metric, config: &BootstrapConfig) -> Sureness {
        let range = metric.range();
        let Some((list, pick)) = average_precision(metric) else {
            return Sureness::of_ratio(&Contrast::ratio(self.sums(metric), range), config);
        };
        let interval = self.averages(list).as_ref().and_then(|averages| {
            let without: Vec<f64> = averages.without.iter().map(pick).collect();
            jackknife::interval(pick(&averages.whole), &without, range)
        });
        Sureness::new(interval, self.count)
    }

    /// How sure the difference `other - self` is, over the same questions.
    pub(crate) fn sureness_of_difference(
        &self,
        other: &Self,
        metric: Metric,
        config: &BootstrapConfig,
    ) -> Sureness {
        let range = metric.range();
        let Some((list, pick)) = average_precision(metric) else {
            let contrast = Contrast::difference(&self.sums(metric), &other.sums(metric), range);
            return Sureness::of_ratio(&contrast, config);
        };
        let both = self.averages(list).as_ref().zip(other.averages(list).as_ref());
        let interval = both.and_then(|(a, b)| {
            let without = a.without.iter().zip(&b.without).map(|(a, b)| pick(b) - pick(a));
            let difference = pick(&b.whole) - pick(&a.whole);
            jackknife::interval(difference, &without.collect::<Vec<_>>(), [-1.0, 1.0])
        });
        Sureness::new(interval, self.count)
    }

    fn averages(&self, list: List) -> &Option<Averages> {
        match list {
            List::Ranking => &self.ranking,
            List::Selection => &self.selection,
        }
    }

    /// A metric's parts, summed over each recording.
    fn sums(&self, metric: Metric) -> Vec<Ratio> {
        let mut sums = vec![Ratio::default(); self.count];
        self.questions.iter().for_each(|(of, one)| sums[*of] += ratio(metric, one));
        sums
    }
}

impl Sureness {
    fn new(interval: Option<Interval>, recordings: usize) -> Self {
        let warning = match recordings {
            1 => Some(IntervalWarning::OneRecording),
            _ if interval.is_none() => Some(IntervalWarning::NoValue),
            0..FEW_RECORDINGS => Some(IntervalWarning::FewRecordings),
            _ => None,
        };
        Self { interval, recordings, warning }
    }

    fn of_ratio(contrast: &Contrast, config: &BootstrapConfig) -> Self {
        Self::new(contrast.interval(config), contrast.recordings())
    }
}

/// One number of an average precision at ten thresholds.
type Pick = fn(&Precisions) -> f64;

/// Of the metrics that are average precisions: of which list, and which number of it.
fn average_precision(metric: Metric) -> Option<(List, Pick)> {
    let at_50: Pick = |all| all[0];
    match metric {
        Metric::MapRanking => Some((List::Ranking, mean)),
        Metric::Ap50Ranking => Some((List::Ranking, at_50)),
        Metric::MapSelection => Some((List::Selection, mean)),
        Metric::Ap50Selection => Some((List::Selection, at_50)),
        _ => None,
    }
}

/// `None` where fewer than two recordings have a true box.
fn averages(pool: &Pool, recordings: usize) -> Option<Averages> {
    let mut weights = vec![1.0; recordings];
    let whole = pool.average_precision(&weights)?;
    let without = (0..recordings).map(|one| {
        weights[one] = 0.0;
        let left = pool.average_precision(&weights);
        weights[one] = 1.0;
        left
    });
    let without = without.collect::<Option<Vec<_>>>()?;
    (pool.recordings_with_truth() > 1).then_some(Averages { whole, without })
}
