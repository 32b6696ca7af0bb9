//! How often intervals hold the truth, in simulated studies whose truth is known.
//!
//! A study has 27 recordings, as many as JRDB's test split. They are of very unequal length, long
//! ones are harder, and the questions of a recording share its difficulty. Coverage must be 93 to
//! 97 %: with 2,000 studies it is itself known to 0.5 %.

use jrdb_types::score::{Interval, Metric, QuestionScore};

use crate::bootstrap::{BootstrapConfig, Contrast};
use crate::example::judgement;
use crate::random::Random;
use crate::ratio::Ratio;
use crate::recordings::Recordings;

const STUDIES: u64 = 2_000;
const RECORDINGS: usize = 27;
/// So many recordings give the truth.
const POPULATION: usize = 200_000;
/// Of average precision, fewer do.
const POPULATION_OF_RANKINGS: usize = 6_000;
const CONFIG: BootstrapConfig = BootstrapConfig { draws: 999, seed: 5 };
const WANTED: std::ops::RangeInclusive<f64> = 0.93..=0.97;

struct World(Random);

impl World {
    fn new(seed: u64) -> Self {
        Self(Random::seeded(seed.wrapping_mul(0x0dd0_5eed)))
    }

    fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Nearly normal with deviation 1.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.unit()).sum::<f64>() - 6.0
    }

    fn chance(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }

    /// How many questions a recording has, and how probable it is that one is answered.
    fn recording(&mut self, skill: f64) -> (usize, f64) {
        let length = 4.0 * (3.0 * self.unit()).exp();
        let skill = skill - 0.05 * (length / 20.0).ln() + 0.15 * self.normal();
        (length as usize, skill.clamp(0.0, 1.0))
    }

    /// A recording's sum of IoU over questions or, with matches as denominator, over matches.
    fn ious(&mut self, per_match: bool) -> Ratio {
        let (questions, skill) = self.recording(0.6);
        let quality = 0.7 + 0.2 * skill;
        let mut sum = Ratio::default();
        for _ in 0..questions {
            let is_match = self.chance(skill);
            let iou = if is_match { quality + 0.1 * self.unit() } else { 0.0 };
            let whole = if per_match && !is_match { 0.0 } else { 1.0 };
            sum += Ratio { part: iou, whole };
        }
        sum
    }

    /// A recording's exact answers by two methods, of which the second is better.
    fn exact(&mut self) -> [Ratio; 2] {
        let (questions, skill) = self.recording(0.5);
        let gain = 0.1 + 0.1 * self.normal();
        let mut sums = [Ratio::default(); 2];
        for _ in 0..questions {
            let ease = self.unit();
            for (sum, skill) in sums.iter_mut().zip([skill, skill + gain]) {
                *sum += Ratio { part: f64::from(u8::from(ease < skill)), whole: 1.0 };
            }
        }
        sums
    }

    /// A recording's rankings by a method of this skill.
    fn rankings(&mut self, name: usize, skill: f64) -> Vec<QuestionScore> {
        let (questions, skill) = self.recording(skill);
        let questions = 1 + questions / 5;
        let ranking = |frame| {
            let mut ranked = Vec::new();
            for _ in 0..self.0.below(3) {
                ranked.push(((0.4 + 0.2 * self.normal()).clamp(0.0, 1.0), 0));
            }
            let mut missed = 0;
            for _ in 0..=self.0.below(2) {
                let thresholds = (10.0 * (skill + 0.2 * self.normal())).clamp(0.0, 10.0) as usize;
                match self.chance(skill) {
                    true => ranked.push(((0.6 + 0.2 * self.normal()).clamp(0.0, 1.0), thresholds)),
                    false => missed += 1,
                }
            }
            judgement(&format!("recording {name}"), frame, &ranked, missed)
        };
        (0..questions as u32).map(ranking).collect()
    }
}

/// The part of the studies whose interval holds the truth.
fn coverage(truth: f64, study: impl Fn(&mut World) -> Option<Interval>) -> f64 {
    let holds = |seed: &u64| study(&mut World::new(*seed)).unwrap().contains(truth);
    (1..=STUDIES).filter(holds).count() as f64 / STUDIES as f64
}

fn all(count: usize, each: impl FnMut(usize) -> Ratio) -> Vec<Ratio> {
    (0..count).map(each).collect()
}

fn total(of: Vec<Ratio>) -> f64 {
    of.into_iter().sum::<Ratio>().value().unwrap()
}

#[test]
fn intervals_of_means_and_ratios_hold_the_truth() {
    for (name, per_match) in [("mean", false), ("ratio", true)] {
        let truth = total(all(POPULATION, {
            let mut world = World::new(0);
            move |_| world.ious(per_match)
        }));
        let found = coverage(truth, |world| {
            let sums = all(RECORDINGS, |_| world.ious(per_match));
            Contrast::ratio(sums, [0.0, 1.0]).interval(&CONFIG)
        });
        assert!(WANTED.contains(&found), "{name} {truth:.4}: {found}");
    }
}

#[test]
fn intervals_of_differences_hold_the_truth() {
    let pairs = |world: &mut World, count| -> (Vec<Ratio>, Vec<Ratio>) {
        (0..count).map(|_| world.exact().into()).unzip()
    };
    let (a, b) = pairs(&mut World::new(0), POPULATION);
    let truth = total(b) - total(a);
    let found = coverage(truth, |world| {
        let (a, b) = pairs(world, RECORDINGS);
        Contrast::difference(&a, &b, [0.0, 1.0]).interval(&CONFIG)
    });
    assert!(WANTED.contains(&found), "{truth:.4}: {found}");
}

fn rankings(world: &mut World, count: usize, skill: f64) -> Vec<QuestionScore> {
    (0..count).flat_map(|name| world.rankings(name, skill)).collect()
}

fn recordings(questions: &[QuestionScore]) -> Recordings<'_> {
    Recordings::new(&questions.iter().collect::<Vec<_>>())
}

fn average_precision(world: &mut World, skill: f64) -> f64 {
    let population = rankings(world, POPULATION_OF_RANKINGS, skill);
    crate::summary::summary(&population.iter().collect::<Vec<_>>()).map_ranking
}

#[test]
fn intervals_of_average_precision_hold_the_truth() {
    let truth = average_precision(&mut World::new(0), 0.65);
    let found = coverage(truth, |world| {
        let questions = rankings(world, RECORDINGS, 0.65);
        recordings(&questions).sureness(Metric::MapRanking, &CONFIG).interval
    });
    assert!(WANTED.contains(&found), "{truth:.4}: {found}");
}

#[test]
fn intervals_of_differences_of_average_precision_hold_the_truth() {
    let of = |skill| average_precision(&mut World::new(0), skill);
    let truth = of(0.7) - of(0.6);
    let found = coverage(truth, |world| {
        let [a, b] = [0.6, 0.7].map(|skill| rankings(world, RECORDINGS, skill));
        let (a, b) = (recordings(&a), recordings(&b));
        a.sureness_of_difference(&b, Metric::MapRanking, &CONFIG).interval
    });
    assert!(WANTED.contains(&found), "{truth:.4}: {found}");
}
