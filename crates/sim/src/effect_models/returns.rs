//! The reported returns of a pulse: the strongest, and the last, or the second strongest where the
//! strongest is the last (63-9243, sections 6.2 and 9.3.2).

use crate::firing::Echo;
/// A return and its light at the sensor, relative to a white wall head-on at 1 m.
#[derive(Clone, Copy, Debug)]
pub(super) struct Return {
    pub echo: Echo,
    pub strength: f64,
}

/// The strongest and the other return.
pub(super) fn reported(returns: &[Return]) -> [Echo; 2] {
    let place = |better: fn(&Return, &Return) -> bool, but: Option<usize>| {
        let others = (0..returns.len()).filter(|place| Some(*place) != but);
        others.reduce(|best, next| match (returns.get(best), returns.get(next)) {
            (Some(a), Some(b)) if better(b, a) => next,
            _ => best,
        })
    };
    let stronger: fn(&Return, &Return) -> bool = |a, b| a.strength > b.strength;
    let strongest = place(stronger, None);
    let last = place(|a, b| a.echo.range_m > b.echo.range_m, None);
    let other = match last == strongest {
        true => place(stronger, strongest),
        false => last,
    };
    [strongest, other].map(|place| {
        let chosen = place.and_then(|place| returns.get(place));
        chosen.map_or(Echo::NONE, |chosen| chosen.echo)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect_models::testing::echo;

    #[test]
    fn the_second_return_is_the_last_or_the_second_strongest() {
        let of = |pairs: &[(f64, f64)]| {
            let returns: Vec<Return> = (pairs.iter())
                .map(|&(range_m, strength)| Return {
                    echo: echo(range_m, 50.0),
                    strength,
                })
                .collect();
            reported(&returns).map(|echo| echo.range_m)
        };
        assert_eq!(of(&[]), [f64::INFINITY; 2]);
        assert_eq!(of(&[(5.0, 1.0)]), [5.0, f64::INFINITY]);
        // If the strongest is not the last: the last, even if weak.
        assert_eq!(of(&[(5.0, 1.0), (7.0, 0.5), (9.0, 0.1)]), [5.0, 9.0]);
        // If the strongest is the last: the second strongest.
        assert_eq!(of(&[(5.0, 0.2), (7.0, 0.5), (9.0, 1.0)]), [9.0, 7.0]);
    }
}
