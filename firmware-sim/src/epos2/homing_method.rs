//! Homing methods (6098): reference and direction of each (Firmware Specification, "Homing Mode";
//! numbers as in CiA 402).

use protocol::epos2::objects::input;

/// A homing method.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct HomingMethod {
    /// The first reference.
    pub search: Option<ReferenceSearch>,
    /// Direction to the index pulse, which is then the reference.
    pub index: Option<i32>,
}

/// A reference to search; directions are 1 and -1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ReferenceSearch {
    /// A switch: its bit in 2071. Its edge is detected on the way back.
    Switch { bit: u16, direction: i32 },
    /// A mechanical stop.
    Stop { direction: i32 },
}

impl HomingMethod {
    /// Bit of the switch; 0 for none.
    pub const fn switch_bit(&self) -> u16 {
        match self.search {
            Some(ReferenceSearch::Switch { bit, .. }) => bit,
            Some(ReferenceSearch::Stop { .. }) | None => 0,
        }
    }
}

/// The method of a number; `None` if the drive does not have it.
pub(super) fn method(number: i8) -> Option<HomingMethod> {
    let switch = |bit, direction| Some(ReferenceSearch::Switch { bit, direction });
    let stop = |direction| Some(ReferenceSearch::Stop { direction });
    let (search, index) = match number {
        0 | 35 => (None, None),
        1 => (switch(input::NEGATIVE_LIMIT, -1), Some(1)),
        2 => (switch(input::POSITIVE_LIMIT, 1), Some(-1)),
        7 => (switch(input::HOME_SWITCH, 1), Some(-1)),
        11 => (switch(input::HOME_SWITCH, -1), Some(1)),
        17 => (switch(input::NEGATIVE_LIMIT, -1), None),
        18 => (switch(input::POSITIVE_LIMIT, 1), None),
        23 => (switch(input::HOME_SWITCH, 1), None),
        27 => (switch(input::HOME_SWITCH, -1), None),
        33 => (None, Some(-1)),
        34 => (None, Some(1)),
        -1 => (stop(1), Some(-1)),
        -2 => (stop(-1), Some(1)),
        -3 => (stop(1), None),
        -4 => (stop(-1), None),
        _ => return None,
    };
    Some(HomingMethod { search, index })
}

/// Whether a value may be written to 6098.
pub(super) fn exists(number: i64) -> bool {
    i8::try_from(number).is_ok_and(|number| method(number).is_some())
}
