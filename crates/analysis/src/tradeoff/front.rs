//! The Pareto front: choices that no other choice dominates. Smaller is better in every cost.

use std::cmp::Ordering;

/// Whether each choice, given by its costs, is on the front. Equal choices are on it together. A
/// choice with a NaN is not on it and dominates no other.
///
/// In the order of costs, only an earlier choice on the front can dominate a choice, so each is
/// compared with the front so far.
#[must_use]
pub fn front(choices: &[Vec<f64>]) -> Vec<bool> {
    let mut order: Vec<usize> = (0..choices.len())
        .filter(|&i| costs(choices, i).iter().all(|cost| !cost.is_nan()))
        .collect();
    order.sort_by(|&a, &b| compare(costs(choices, a), costs(choices, b)));
    let mut on = vec![false; choices.len()];
    let mut kept: Vec<usize> = Vec::new();
    for i in order {
        if kept
            .iter()
            .any(|&k| beats(costs(choices, k), costs(choices, i)))
        {
            continue;
        }
        kept.push(i);
        if let Some(on) = on.get_mut(i) {
            *on = true;
        }
    }
    on
}

/// The same for costs that were measured several times, given by their median and their minimum. A
/// choice is off the front only if the medians of another dominate its minima, so choices that the
/// measurement cannot separate from the front are on it.
#[must_use]
pub fn front_within_spread(middles: &[Vec<f64>], bests: &[Vec<f64>]) -> Vec<bool> {
    let on = front(middles);
    // A choice that any median dominates is dominated by one on the front of the medians.
    let ahead: Vec<&Vec<f64>> = middles
        .iter()
        .zip(on)
        .filter_map(|(middle, on)| on.then_some(middle))
        .collect();
    let is_number = |costs: &[f64]| costs.iter().all(|cost| !cost.is_nan());
    middles
        .iter()
        .zip(bests)
        .map(|(middle, best)| {
            is_number(middle) && is_number(best) && !ahead.iter().any(|other| beats(other, best))
        })
        .collect()
}

/// Whether `a` is at least as good as `b` in every cost and better in one.
#[must_use]
pub fn beats(a: &[f64], b: &[f64]) -> bool {
    let mut pairs = a.iter().zip(b);
    pairs.clone().all(|(a, b)| a <= b) && pairs.any(|(a, b)| a < b)
}

fn costs(choices: &[Vec<f64>], i: usize) -> &[f64] {
    choices.get(i).map_or(&[], Vec::as_slice)
}

fn compare(a: &[f64], b: &[f64]) -> Ordering {
    let unequal = a.iter().zip(b).find(|(a, b)| a != b);
    unequal.map_or(Ordering::Equal, |(a, b)| a.total_cmp(b))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The definition: each against every other.
    fn slow(choices: &[Vec<f64>]) -> Vec<bool> {
        let is_number = |choice: &[f64]| choice.iter().all(|cost| !cost.is_nan());
        choices
            .iter()
            .map(|a| {
                is_number(a)
                    && !choices.iter().any(|b| {
                        let no_worse = (0..a.len()).all(|k| b[k] <= a[k]);
                        let better = (0..a.len()).any(|k| b[k] < a[k]);
                        is_number(b) && no_worse && better
                    })
            })
            .collect()
    }

    /// Few values, so that ties are common, with zeros of both signs, infinity and NaN.
    fn cost() -> impl Strategy<Value = f64> {
        prop_oneof![
            8 => (0..6_i32).prop_map(f64::from),
            2 => -1.0..1.0_f64,
            1 => prop_oneof![Just(-0.0), Just(f64::INFINITY), Just(f64::NAN)],
        ]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(512))]

        #[test]
        fn the_front_agrees_with_its_definition(
            choices in (1..5_usize).prop_flat_map(|n| prop::collection::vec(prop::collection::vec(cost(), n), 0..40)),
        ) {
            prop_assert_eq!(front(&choices), slow(&choices));
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(512))]

        #[test]
        fn the_front_within_spread_agrees_with_its_definition(
            choices in prop::collection::vec((prop::array::uniform2(cost()), prop::array::uniform2(0.0..2.0_f64)), 0..30),
        ) {
            let middles: Vec<Vec<f64>> = choices.iter().map(|(c, _)| c.to_vec()).collect();
            let bests: Vec<Vec<f64>> = choices.iter().map(|(c, s)| vec![c[0] - s[0], c[1] - s[1]]).collect();
            let got = front_within_spread(&middles, &bests);
            for (i, best) in bests.iter().enumerate() {
                let beaten = middles.iter().any(|m| {
                    m[0] <= best[0] && m[1] <= best[1] && (m[0] < best[0] || m[1] < best[1])
                });
                let is_number = best.iter().all(|cost| !cost.is_nan());
                prop_assert_eq!(got[i], is_number && !beaten);
            }
            prop_assert_eq!(front_within_spread(&middles, &middles), front(&middles));
        }
    }

    #[test]
    fn indistinguishable_choices_are_on_the_front() {
        let middles = [vec![1.00, 5.0], vec![1.01, 5.0], vec![2.0, 5.0]];
        let bests = [vec![0.99, 5.0], vec![0.98, 5.0], vec![1.9, 5.0]];
        assert_eq!(front_within_spread(&middles, &bests), [true, true, false]);
        assert_eq!(front(&middles), [true, false, false]);
    }

    #[test]
    fn dominated_choices_are_not_on_the_front() {
        let choices = [[1.0, 4.0], [2.0, 2.0], [4.0, 1.0], [3.0, 3.0], [2.0, 2.0]];
        let choices: Vec<Vec<f64>> = choices.iter().map(|c| c.to_vec()).collect();
        assert_eq!(front(&choices), [true, true, true, false, true]);
    }
}
