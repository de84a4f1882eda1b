//! Objects of the device profile, 6000 to 6FFF (CiA 402).

use super::super::entry::EntryAccess::{Const, Ro, Rw, Rww, Wo};
use super::super::entry::Type::{I8, I16, I32, U8, U16, U32};
use super::super::entry::{DictionaryEntry, entry};

#[rustfmt::skip]
pub(super) const ENTRIES: &[DictionaryEntry] = &[
    entry(0x6007, 0, I16, Rw, 3), // Abort Connection Option Code
    entry(0x6040, 0, U16, Rww, 0).mappable(), // Controlword
    entry(0x6041, 0, U16, Ro, 0).mappable(), // Statusword
    entry(0x605B, 0, I16, Rw, 0), // Shutdown Option Code
    entry(0x605C, 0, I16, Rw, 1), // Disable Operation Option Code
    entry(0x605E, 0, I16, Rw, 2), // Fault Reaction Option Code
    entry(0x6060, 0, I8, Rww, 1).mappable(), // Modes of Operation
    entry(0x6061, 0, I8, Ro, 1).mappable(), // Modes of Operation Display
    entry(0x6062, 0, I32, Ro, 0).mappable(), // Position Demand Value
    entry(0x6064, 0, I32, Ro, 0).mappable(), // Position Actual Value
    entry(0x6065, 0, U32, Rww, 2000).mappable(), // Max Following Error
    entry(0x6067, 0, U32, Rw, 4_294_967_295), // Position Window
    entry(0x6068, 0, U16, Rw, 0), // Position Window Time
    entry(0x6069, 0, I32, Ro, 0).mappable(), // Velocity Sensor Actual Value
    entry(0x606B, 0, I32, Ro, 0).mappable(), // Velocity Demand Value
    entry(0x606C, 0, I32, Ro, 0).mappable(), // Velocity Actual Value
    entry(0x606D, 0, U32, Rw, 0xFFFF_FFFF), // Velocity Window
    entry(0x606E, 0, U16, Rw, 0), // Velocity Window Time
    entry(0x6078, 0, I16, Ro, 0).mappable(), // Current Actual Value
    entry(0x607A, 0, I32, Rww, 0).mappable(), // Target Position
    entry(0x607C, 0, I32, Rww, 0).mappable(), // Home Offset
    entry(0x607D, 0, U8, Const, 2), // Internal Number of Entries
    entry(0x607D, 1, I32, Rw, -2_147_483_648), // Min Position Limit
    entry(0x607D, 2, I32, Rw, 2_147_483_647), // Max Position Limit
    entry(0x607F, 0, U32, Rw, 25000).within(0, 25000), // Max Profile Velocity
    entry(0x6081, 0, U32, Rww, 1000).mappable(), // Profile Velocity
    entry(0x6083, 0, U32, Rww, 10000).mappable(), // Profile Acceleration
    entry(0x6084, 0, U32, Rww, 10000).mappable(), // Profile Deceleration
    entry(0x6085, 0, U32, Rww, 10000).mappable(), // QuickStop Deceleration
    entry(0x6086, 0, I16, Rww, 0).mappable(), // Motion Profile Type
    entry(0x6089, 0, I8, Rw, 0), // Position Notation Index
    entry(0x608A, 0, U8, Rw, 0xAC), // Position Dimension Index
    entry(0x608B, 0, I8, Rw, 0), // Velocity Notation Index
    entry(0x608C, 0, U8, Rw, 0xA4), // Velocity Dimension Index
    entry(0x608D, 0, I8, Rw, 0), // Acceleration Notation Index
    entry(0x608E, 0, U8, Rw, 0xA4), // Acceleration Dimension Index
    entry(0x6098, 0, I8, Rww, 7).mappable(), // Homing Method
    entry(0x6099, 0, U8, Const, 2), // Internal Number of Entries
    entry(0x6099, 1, U32, Rww, 100).mappable(), // Speed for Switch Search
    entry(0x6099, 2, U32, Rww, 10).mappable(), // Speed for Zero Search
    entry(0x609A, 0, U32, Rww, 1000).mappable(), // Homing Acceleration
    entry(0x60C0, 0, I16, Rw, -1).within(-1, -1), // Interpolation Sub Mode Selection
    entry(0x60C2, 0, U8, Const, 2), // Internal Number of Entries
    entry(0x60C2, 1, U8, Rw, 1).within(1, 1), // Interpolation Time Periode Value
    entry(0x60C2, 2, I8, Rw, -3).within(-3, -3), // Interpolation Time Index
    entry(0x60C4, 0, U8, Const, 6), // Internal Number of Entries
    entry(0x60C4, 1, U32, Ro, 0), // Maximum Buffer Size
    entry(0x60C4, 2, U32, Ro, 0), // Actual Buffer Size
    entry(0x60C4, 3, U8, Rw, 0).within(0, 0), // Buffer Organisation
    entry(0x60C4, 4, U16, Rw, 0).within(0, 64), // Buffer Position
    entry(0x60C4, 5, U8, Wo, 8).within(8, 8), // Size Of Data Record
    entry(0x60C4, 6, U8, Wo, 0).within(0, 1).mappable(), // Buffer Clear
    entry(0x60C5, 0, U32, Rw, 4_294_967_295), // Max Acceleration
    entry(0x60F6, 0, U8, Const, 2), // Internal Number of Entries
    entry(0x60F6, 1, I16, Rww, 300).mappable(), // Current Regulator P-Gain
    entry(0x60F6, 2, I16, Rww, 100).mappable(), // Current Regulator I-Gain
    entry(0x60F9, 0, U8, Const, 5), // Internal Number of Entries
    entry(0x60F9, 1, I16, Rww, 1000).mappable(), // Speed Regulator P-Gain
    entry(0x60F9, 2, I16, Rww, 100).mappable(), // Speed Regulator I-Gain
    entry(0x60F9, 4, U16, Rww, 0).mappable(), // Velocity Feedforward Factor in Speed Regulator
    entry(0x60F9, 5, U16, Rww, 0x0714).mappable(), // Acceleration Feedforward Factor in Speed Regulator
    entry(0x60FB, 0, U8, Const, 5), // Internal Number of Entries
    entry(0x60FB, 1, I16, Rww, 150).mappable(), // Position Regulator P-Gain
    entry(0x60FB, 2, I16, Rww, 10).mappable(), // Position Regulator I-Gain
    entry(0x60FB, 3, I16, Rww, 200).mappable(), // Position Regulator D-Gain
    entry(0x60FB, 4, U16, Rww, 0).mappable(), // Velocity Feedforward Factor in Position Regulator
    entry(0x60FB, 5, U16, Rww, 0).mappable(), // Acceleration Feedforward Factor in Position Regulator
    entry(0x60FF, 0, I32, Rww, 0).mappable(), // Target Velocity
    entry(0x6402, 0, U16, Rw, 10), // Motor Type
    entry(0x6410, 0, U8, Const, 5), // Internal Number of Entries
    entry(0x6410, 1, U16, Rww, 10000).within(0, 10000).mappable(), // Continuous Current Limit
    entry(0x6410, 2, U16, Rww, 25000).within(0, 25000).mappable(), // Output Current Limit
    entry(0x6410, 3, U8, Rw, 1), // Pole Pair Number
    entry(0x6410, 4, U32, Rww, 25000).mappable(), // Maximal Motor Speed
    entry(0x6410, 5, U16, Rw, 40).within(1, 5400), // Thermal Time Constant Winding
    entry(0x6502, 0, U32, Ro, 0x003F_0065), // Supported Drive Modes
];
