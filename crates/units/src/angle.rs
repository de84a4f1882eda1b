//! Angles, angular rates and lengths.

/// An angle in degrees.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct Degrees(pub f64);

/// An angle in radians.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct Radians(pub f64);

/// An angular rate in degrees per second.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct DegPerS(pub f64);

/// An angular acceleration in degrees per second squared.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct DegPerS2(pub f64);

/// A length in metres.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct Metres(pub f64);

impl Degrees {
    /// The same angle in radians.
    #[must_use]
    pub const fn to_radians(self) -> Radians {
        Radians(self.0.to_radians())
    }
}

impl Radians {
    /// The same angle in degrees.
    #[must_use]
    pub const fn to_degrees(self) -> Degrees {
        Degrees(self.0.to_degrees())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_a_revolution_is_pi() {
        assert_eq!(Degrees(180.0).to_radians(), Radians(core::f64::consts::PI));
        assert_eq!(Radians(core::f64::consts::PI).to_degrees(), Degrees(180.0));
    }
}
