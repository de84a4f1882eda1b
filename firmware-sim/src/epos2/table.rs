//! The dictionary's entries: index, subindex, type, access, factory value and limits as in the unit's own device description.
//!
//! One line an entry, in the order of addresses. Entries of CAN, of the analogue side and of modes that are not simulated are left
//! out; they answer "no object".

use super::dictionary::Access::{Ro, Rw};
use super::dictionary::Entry;
use super::dictionary::Type::{I8, I16, I32, Text, U8, U16, U32, U64};
use super::dictionary::entry;

/// How many entries there are.
const ENTRIES: usize = 149;

#[rustfmt::skip]
pub(super) const TABLE: [Entry; ENTRIES] = [
    entry(0x1000, 0, U32, Ro, 0x0002_0192), // Device Type
    entry(0x1001, 0, U8, Ro, 0), // Error Register
    entry(0x1003, 0, U8, Rw, 0), // Number of Errors
    entry(0x1003, 1, U32, Ro, 0), // Error History (1)
    entry(0x1003, 2, U32, Ro, 0), // Error History (2)
    entry(0x1003, 3, U32, Ro, 0), // Error History (3)
    entry(0x1003, 4, U32, Ro, 0), // Error History (4)
    entry(0x1003, 5, U32, Ro, 0), // Error History (5)
    entry(0x1008, 0, Text, Ro, 0), // Manufacturer Device Name
    entry(0x1010, 0, U8, Ro, 1), // Internal Largest SubIndex Supported
    entry(0x1010, 1, U32, Rw, 0), // Save All Parameters
    entry(0x1011, 0, U8, Ro, 5), // Internal Largest SubIndex Supported
    entry(0x1011, 1, U32, Rw, 0), // Restore All Default Parameters
    entry(0x1011, 4, U32, Rw, 0), // Internal Object Restore Factory Default Parameters
    entry(0x1011, 5, U32, Rw, 0), // Restore Default PDO COB-IDs
    entry(0x1013, 0, U32, Rw, 0), // High Resolution Time Stamp
    entry(0x1016, 0, U8, Ro, 2), // Internal Number of Entries
    entry(0x1016, 1, U32, Rw, 0), // Consumer 1 Heartbeat Time
    entry(0x1016, 2, U32, Rw, 0), // Consumer 2 Heartbeat Time
    entry(0x1017, 0, U16, Rw, 0), // Producer Heartbeat Time
    entry(0x1018, 0, U8, Ro, 4), // Internal Number of Entries
    entry(0x1018, 1, U32, Ro, 0x0000_00FB), // Vendor ID
    entry(0x1018, 2, U32, Ro, 0x6420_0000), // Product Code
    entry(0x1018, 3, U32, Ro, 0x2126_0000), // Revision Number
    entry(0x1018, 4, U32, Ro, 0), // Serial Number
    entry(0x2000, 0, U8, Rw, 0).plus_node_id(), // Node ID
    entry(0x2001, 0, U16, Rw, 2).within(0, 7), // CAN Bitrate
    entry(0x2002, 0, U16, Rw, 5).within(0, 5), // RS232 Baudrate
    entry(0x2003, 0, U8, Ro, 5), // Internal Number of Entries
    entry(0x2003, 1, U16, Ro, 0x2126), // Software Version
    entry(0x2003, 2, U16, Ro, 0x6420), // Hardware Version
    entry(0x2003, 3, U16, Ro, 0), // Application Number
    entry(0x2003, 4, U16, Ro, 0), // Application Version
    entry(0x2003, 5, U16, Ro, 0x2DB6), // Basesector Version
    entry(0x2004, 0, U64, Ro, 0), // Serial Number
    entry(0x2005, 0, U16, Rw, 500), // RS232 Frame Timeout
    entry(0x2006, 0, U16, Rw, 475), // USB Frame Timeout
    entry(0x2008, 0, U16, Rw, 0), // Miscellaneous Configuration
    entry(0x2009, 0, U16, Ro, 1), // Internal Dip Switch State
    entry(0x2020, 0, U32, Ro, 0), // Incremental Encoder 1 Counter
    entry(0x2027, 0, I16, Ro, 0), // Current Actual Value Averaged
    entry(0x2028, 0, I32, Ro, 0), // Velocity Actual Value Averaged
    entry(0x2070, 0, U8, Ro, 9), // Internal Number of Entries
    entry(0x2070, 1, U16, Rw, 15), // Configuration of Digital Input1
    entry(0x2070, 2, U16, Rw, 14), // Configuration of Digital Input2
    entry(0x2070, 3, U16, Rw, 13), // Configuration of Digital Input3
    entry(0x2070, 4, U16, Rw, 2), // Configuration of Digital Input4
    entry(0x2070, 5, U16, Rw, 1), // Configuration of Digital Input5
    entry(0x2070, 6, U16, Rw, 0), // Configuration of Digital Input6
    entry(0x2070, 7, U16, Rw, 9), // Configuration of Digital Input7
    entry(0x2070, 8, U16, Rw, 8), // Configuration of Digital Input8
    entry(0x2070, 9, U16, Rw, 7), // Configuration of Digital Input9
    entry(0x2071, 0, U8, Ro, 4), // Internal Number of Entries
    entry(0x2071, 1, U16, Ro, 0), // Digital Input Functionalities State
    entry(0x2071, 2, U16, Rw, 0xE387), // Digital Input Functionalities Mask
    entry(0x2071, 3, U16, Rw, 0), // Digital Input Functionalities Polarity
    entry(0x2071, 4, U16, Rw, 8), // Digital Input Functionalities Execution Mask
    entry(0x2078, 0, U8, Ro, 3), // Internal Number of Entries
    entry(0x2078, 1, U16, Rw, 0), // Digital Output State
    entry(0x2078, 2, U16, Rw, 0), // Digital Output Mask
    entry(0x2078, 3, U16, Rw, 0), // Digital Output Polarity
    entry(0x2079, 0, U8, Ro, 5), // Internal Number of Entries
    entry(0x2079, 1, U16, Rw, 15), // Configuration of Digital Output1
    entry(0x2079, 2, U16, Rw, 14), // Configuration of Digital Output2
    entry(0x2079, 3, U16, Rw, 13), // Configuration of Digital Output3
    entry(0x2079, 4, U16, Rw, 12), // Configuration of Digital Output4
    entry(0x2079, 5, U16, Rw, 11), // Configuration of Digital Output5
    entry(0x2080, 0, U16, Rw, 500), // Current Threshold for Homing Mode
    entry(0x2081, 0, I32, Rw, 0), // Home Position
    entry(0x2082, 0, I32, Ro, 0), // Home Position Displacement
    entry(0x20F4, 0, I16, Ro, 0), // Following Error Actual Value
    entry(0x2100, 0, U8, Ro, 3), // Internal Number of Entries
    entry(0x2100, 1, U16, Rw, 10), // Brake Reaction Rise Time
    entry(0x2100, 2, U16, Rw, 10), // Brake Reaction Fall Time
    entry(0x2100, 3, U16, Rw, 65535), // Brake Timeout
    entry(0x2101, 0, U8, Ro, 3), // Internal Number of Entries
    entry(0x2101, 1, U16, Rw, 30), // Standstill Window
    entry(0x2101, 2, U16, Rw, 50), // Standstill Window Time
    entry(0x2101, 3, U16, Rw, 1000), // Standstill Timeout
    entry(0x2210, 0, U8, Ro, 4), // Internal Number of Entries
    entry(0x2210, 1, U32, Rw, 500).within(16, 2500000), // Pulse Number Incremental Encoder 1
    entry(0x2210, 2, U16, Rw, 1), // Position Sensor Type
    entry(0x2210, 3, U16, Rw, 0), // Internal Absolute Position Offset
    entry(0x2210, 4, U16, Rw, 0), // Position Sensor Polarity
    entry(0x6007, 0, I16, Rw, 3), // Abort Connection Option Code
    entry(0x6040, 0, U16, Rw, 0), // Controlword
    entry(0x6041, 0, U16, Ro, 0), // Statusword
    entry(0x605B, 0, I16, Rw, 0), // Shutdown Option Code
    entry(0x605C, 0, I16, Rw, 1), // Disable Operation Option Code
    entry(0x605E, 0, I16, Rw, 2), // Fault Reaction Option Code
    entry(0x6060, 0, I8, Rw, 1), // Modes of Operation
    entry(0x6061, 0, I8, Ro, 1), // Modes of Operation Display
    entry(0x6062, 0, I32, Ro, 0), // Position Demand Value
    entry(0x6064, 0, I32, Ro, 0), // Position Actual Value
    entry(0x6065, 0, U32, Rw, 2000), // Max Following Error
    entry(0x6067, 0, U32, Rw, 0xFFFF_FFFF), // Position Window
    entry(0x6068, 0, U16, Rw, 0), // Position Window Time
    entry(0x6069, 0, I32, Ro, 0), // Velocity Sensor Actual Value
    entry(0x606B, 0, I32, Ro, 0), // Velocity Demand Value
    entry(0x606C, 0, I32, Ro, 0), // Velocity Actual Value
    entry(0x606D, 0, U32, Rw, 0xFFFF_FFFF), // Velocity Window
    entry(0x606E, 0, U16, Rw, 0), // Velocity Window Time
    entry(0x6078, 0, I16, Ro, 0), // Current Actual Value
    entry(0x607A, 0, I32, Rw, 0), // Target Position
    entry(0x607C, 0, I32, Rw, 0), // Home Offset
    entry(0x607D, 0, U8, Ro, 2), // Internal Number of Entries
    entry(0x607D, 1, I32, Rw, -0x8000_0000), // Min Position Limit
    entry(0x607D, 2, I32, Rw, 0x7FFF_FFFF), // Max Position Limit
    entry(0x607F, 0, U32, Rw, 25000).within(0, 25000), // Max Profile Velocity
    entry(0x6081, 0, U32, Rw, 1000), // Profile Velocity
    entry(0x6083, 0, U32, Rw, 10000), // Profile Acceleration
    entry(0x6084, 0, U32, Rw, 10000), // Profile Deceleration
    entry(0x6085, 0, U32, Rw, 10000), // QuickStop Deceleration
    entry(0x6086, 0, I16, Rw, 0), // Motion Profile Type
    entry(0x6089, 0, I8, Rw, 0), // Position Notation Index
    entry(0x608A, 0, U8, Rw, 172), // Position Dimension Index
    entry(0x608B, 0, I8, Rw, 0), // Velocity Notation Index
    entry(0x608C, 0, U8, Rw, 164), // Velocity Dimension Index
    entry(0x608D, 0, I8, Rw, 0), // Acceleration Notation Index
    entry(0x608E, 0, U8, Rw, 164), // Acceleration Dimension Index
    entry(0x6098, 0, I8, Rw, 7), // Homing Method
    entry(0x6099, 0, U8, Ro, 2), // Internal Number of Entries
    entry(0x6099, 1, U32, Rw, 100), // Speed for Switch Search
    entry(0x6099, 2, U32, Rw, 10), // Speed for Zero Search
    entry(0x609A, 0, U32, Rw, 1000), // Homing Acceleration
    entry(0x60C5, 0, U32, Rw, 0xFFFF_FFFF), // Max Acceleration
    entry(0x60F6, 0, U8, Ro, 2), // Internal Number of Entries
    entry(0x60F6, 1, I16, Rw, 300), // Current Regulator P-Gain
    entry(0x60F6, 2, I16, Rw, 100), // Current Regulator I-Gain
    entry(0x60F9, 0, U8, Ro, 5), // Internal Number of Entries
    entry(0x60F9, 1, I16, Rw, 1000), // Speed Regulator P-Gain
    entry(0x60F9, 2, I16, Rw, 100), // Speed Regulator I-Gain
    entry(0x60F9, 4, U16, Rw, 0), // Velocity Feedforward Factor in Speed Regulator
    entry(0x60F9, 5, U16, Rw, 1812), // Acceleration Feedforward Factor in Speed Regulator
    entry(0x60FB, 0, U8, Ro, 5), // Internal Number of Entries
    entry(0x60FB, 1, I16, Rw, 150), // Position Regulator P-Gain
    entry(0x60FB, 2, I16, Rw, 10), // Position Regulator I-Gain
    entry(0x60FB, 3, I16, Rw, 200), // Position Regulator D-Gain
    entry(0x60FB, 4, U16, Rw, 0), // Velocity Feedforward Factor in Position Regulator
    entry(0x60FB, 5, U16, Rw, 0), // Acceleration Feedforward Factor in Position Regulator
    entry(0x60FF, 0, I32, Rw, 0), // Target Velocity
    entry(0x6402, 0, U16, Rw, 10), // Motor Type
    entry(0x6410, 0, U8, Ro, 5), // Internal Number of Entries
    entry(0x6410, 1, U16, Rw, 10000).within(0, 10000), // Continuous Current Limit
    entry(0x6410, 2, U16, Rw, 25000).within(0, 25000), // Output Current Limit
    entry(0x6410, 3, U8, Rw, 1), // Pole Pair Number
    entry(0x6410, 4, U32, Rw, 25000), // Maximal Motor Speed
    entry(0x6410, 5, U16, Rw, 40).within(1, 5400), // Thermal Time Constant Winding
    entry(0x6502, 0, U32, Ro, 0x0000_0021), // Supported Drive Modes: of a real unit's 0x003F0065 those simulated, profile position and homing
];
