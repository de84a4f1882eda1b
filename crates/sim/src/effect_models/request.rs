//! The keys of `[effects]`.

use core::fmt;
use core::marker::PhantomData;

use serde::de::value::MapAccessDeserializer;
use serde::de::{Error, MapAccess, Visitor};
use serde::{Deserialize, Deserializer};

use super::settings::EffectSettings;

/// A key of `[effects]`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EffectRequest<S> {
    /// There is none: the effect is on if a fact of the scene calls for it.
    #[default]
    Absent,
    /// `false`.
    Off,
    /// `true`: in any case, with the settings of its fact, else the usual ones.
    On(S),
    /// A table: these settings.
    Settings(S),
}

impl<S> EffectRequest<S> {
    /// The settings, if the effect is requested.
    #[must_use]
    pub const fn settings(&self) -> Option<&S> {
        match self {
            Self::Absent | Self::Off => None,
            Self::On(settings) | Self::Settings(settings) => Some(settings),
        }
    }

    /// Whether it is `true`.
    pub(crate) const fn is_on(&self) -> bool {
        matches!(self, Self::On(_))
    }
}

impl<'de, S: EffectSettings> Deserialize<'de> for EffectRequest<S> {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(RequestVisitor(PhantomData))
    }
}

struct RequestVisitor<S>(PhantomData<S>);

impl<'de, S: EffectSettings> Visitor<'de> for RequestVisitor<S> {
    type Value = EffectRequest<S>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("true, false or a table of settings")
    }

    fn visit_bool<E: Error>(self, is_on: bool) -> Result<Self::Value, E> {
        match (is_on, S::usual()) {
            (false, _) => Ok(EffectRequest::Off),
            (true, Some(usual)) => Ok(EffectRequest::On(usual)),
            (true, None) => Err(E::custom(
                "expected false or a table of settings: this effect has no usual ones",
            )),
        }
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
        S::deserialize(MapAccessDeserializer::new(map)).map(EffectRequest::Settings)
    }
}
