//! The tolerance that decides which effects a simulation needs.

use core::str::FromStr;

use serde::Serialize;
use utoipa::ToSchema;

/// A tolerated difference of clouds: at most so many percent of the points are missing, added, or
/// displaced by more than a length.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ToSchema)]
#[non_exhaustive]
pub struct EffectTolerance {
    /// The length, millimetres.
    pub displaced_mm: f64,
    /// Percent of the points.
    pub percent: f64,
}

impl FromStr for EffectTolerance {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let expected = || format!("expected a length and a share such as 5mm,0.1%, got {text:?}");
        let number = |text: &str, unit| {
            let number: f64 = text.trim().strip_suffix(unit)?.trim().parse().ok()?;
            (number > 0.0 && number.is_finite()).then_some(number)
        };
        let (length, share) = text.split_once(',').ok_or_else(expected)?;
        let displaced_mm = number(length, "mm").ok_or_else(expected)?;
        let percent = number(share, "%").filter(|percent| *percent < 100.0);
        Ok(Self {
            displaced_mm,
            percent: percent.ok_or_else(expected)?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tolerances_name_a_length_and_a_share() {
        let expected = EffectTolerance {
            displaced_mm: 5.0,
            percent: 0.1,
        };
        assert_eq!("5mm, 0.1 %".parse(), Ok(expected));
        for text in [
            "5mm", "5,0.1%", "5mm,0.1", "-1mm,1%", "5mm,100%", "nanmm,1%", "",
        ] {
            let message = text.parse::<EffectTolerance>().unwrap_err();
            assert!(
                message.starts_with("expected a length and a share"),
                "{text}"
            );
        }
    }
}
