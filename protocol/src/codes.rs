//! Enums of one-byte codes whose unlisted values stay representable.

/// Defines an enum of wire codes with `Unknown(u8)` for the rest, `from_u8` and `to_u8`.
macro_rules! byte_codes {
    (
        $(#[$meta:meta])*
        pub enum $name:ident {
            $($(#[$variant_meta:meta])* $variant:ident = $code:literal,)*
        }
    ) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum $name {
            $($(#[$variant_meta])* $variant,)*
            /// A code that is not listed.
            Unknown(u8),
        }

        impl $name {
            /// The code on the wire.
            #[must_use]
            pub const fn to_u8(self) -> u8 {
                match self {
                    $(Self::$variant => $code,)*
                    Self::Unknown(code) => code,
                }
            }

            /// The meaning of a code.
            #[must_use]
            pub const fn from_u8(code: u8) -> Self {
                match code {
                    $($code => Self::$variant,)*
                    code => Self::Unknown(code),
                }
            }
        }
    };
}

pub(crate) use byte_codes;
