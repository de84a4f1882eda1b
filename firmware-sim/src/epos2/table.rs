//! The entries of the dictionary: index, subindex, type, access, factory value, limits and
//! mappability, all 430 of them.
//!
//! They follow the device description (EDS) of an EPOS2 70/10 with firmware 2126h, in the order of
//! addresses. Where it gives no factory value, the value of a real drive is used. Objects of
//! functions that are not simulated (data recorder, interpolation buffer, autotuning, analogue
//! inputs) are plain storage.

use super::entry::EntryAccess::{Ro, Rw, Rww, Wo};
use super::entry::Type::{Domain, I8, I16, I32, Text, U8, U16, U32, U64};
use super::entry::{DictionaryEntry, entry};

/// The number of entries in the device description.
pub(super) const COUNT: usize = 430;

/// All entries, one per subindex, in order for binary search.
pub(super) static TABLE: [DictionaryEntry; COUNT] = {
    let mut all = [ENTRIES[0]; COUNT];
    let (mut from, mut to, mut index, mut key) = (0, 0, 0, 0);
    while from < ENTRIES.len() {
        let mut entry = ENTRIES[from];
        if entry.address.index != index && entry.address.sub == 1 {
            all[to] = DictionaryEntry::count(entry.address.index, last_sub(from));
            to += 1;
        }
        index = entry.address.index;
        while entry.address.sub <= entry.last_sub {
            let next = (index as u32) << 8 | entry.address.sub as u32;
            assert!(next > key, "the table is not in order");
            key = next;
            all[to] = entry;
            entry.address.sub += 1;
            to += 1;
        }
        from += 1;
    }
    assert!(to == COUNT);
    all
};

/// The last subindex of the object at a place of [`ENTRIES`].
const fn last_sub(mut place: usize) -> u8 {
    let index = ENTRIES[place].address.index;
    while place + 1 < ENTRIES.len() && ENTRIES[place + 1].address.index == index {
        place += 1;
    }
    ENTRIES[place].last_sub
}

/// The table. An object without subindex 0 here has the number of its last subindex there.
#[rustfmt::skip]
const ENTRIES: &[DictionaryEntry] = &[
    // Communication objects, 1000 to 1FFF (CiA 301).
    entry(0x1000, 0, U32, Ro, 0x0002_0192), // Device Type
    entry(0x1001, 0, U8, Ro, 0), // Error Register
    entry(0x1003, 0, U8, Rw, 0), // Number of Errors
    entry(0x1003, 1, U32, Ro, 0).to_sub(5), // Error History (1) to (5)
    entry(0x1005, 0, U32, Rw, 0x80).within(128, 128), // COB-ID SYNC
    entry(0x1008, 0, Text, Ro, 0), // Manufacturer Device Name
    entry(0x100C, 0, U16, Rw, 0), // Guard Time
    entry(0x100D, 0, U8, Rw, 0), // Lifetime Factor
    entry(0x1010, 1, U32, Rw, 0), // Save All Parameters
    entry(0x1011, 1, U32, Rw, 0), // Restore All Default Parameters
    entry(0x1011, 4, U32, Rw, 0), // Internal Object Restore Factory Default Parameters
    entry(0x1011, 5, U32, Rw, 0), // Restore Default PDO COB-IDs
    entry(0x1012, 0, U32, Rw, 0x0100), // COB-ID Time Stamp Object
    entry(0x1013, 0, U32, Rww, 0).mappable(), // High Resolution Time Stamp
    entry(0x1014, 0, U32, Rw, 0x80).plus_node_id(), // COB-ID EMCY
    entry(0x1016, 1, U32, Rw, 0), // Consumer 1 Heartbeat Time
    entry(0x1016, 2, U32, Rw, 0), // Consumer 2 Heartbeat Time
    entry(0x1017, 0, U16, Rw, 0), // Producer Heartbeat Time
    entry(0x1018, 1, U32, Ro, 0xFB), // Vendor ID
    entry(0x1018, 2, U32, Ro, 0x6420_0000), // Product Code
    entry(0x1018, 3, U32, Ro, 0x2126_0000), // Revision Number
    entry(0x1018, 4, U32, Ro, 0), // Serial Number
    entry(0x1020, 1, U32, Rw, 0), // Configuration Date
    entry(0x1020, 2, U32, Rw, 0), // Configuration Time
    entry(0x1200, 1, U32, Ro, 0x0600).plus_node_id(), // SDO COB-ID Client->Server (rx)
    entry(0x1200, 2, U32, Ro, 0x0580).plus_node_id(), // SDO COB-ID Server->Client (tx)
    entry(0x1400, 1, U32, Rw, 0x0200).plus_node_id(), // COB-ID used by RxPDO 1
    entry(0x1400, 2, U8, Rw, 0xFF), // Transmission Type
    entry(0x1401, 1, U32, Rw, 0x0300).plus_node_id(), // COB-ID used by RxPDO 2
    entry(0x1401, 2, U8, Rw, 0xFF), // Transmission Type
    entry(0x1402, 1, U32, Rw, 0x0400).plus_node_id(), // COB-ID used by RxPDO 3
    entry(0x1402, 2, U8, Rw, 0xFF), // Transmission Type
    entry(0x1403, 1, U32, Rw, 0x0500).plus_node_id(), // COB-ID used by RxPDO 4
    entry(0x1403, 2, U8, Rw, 0xFF), // Transmission Type
    entry(0x1600, 0, U8, Rw, 1).within(0, 8), // Number of Mapped Application Objects in RxPDO 1
    entry(0x1600, 1, U32, Rw, 0x6040_0010), // 1st Mapped Object in RxPDO 1
    entry(0x1600, 2, U32, Rw, 0).to_sub(8), // 2nd to 8th Mapped Object in RxPDO 1
    entry(0x1601, 0, U8, Rw, 2).within(0, 8), // Number of Mapped Application Objects in RxPDO 2
    entry(0x1601, 1, U32, Rw, 0x6040_0010), // 1st Mapped Object in RxPDO 2
    entry(0x1601, 2, U32, Rw, 0x6060_0008), // 2nd Mapped Object in RxPDO 2
    entry(0x1601, 3, U32, Rw, 0).to_sub(8), // 3rd to 8th Mapped Object in RxPDO 2
    entry(0x1602, 0, U8, Rw, 2).within(0, 8), // Number of Mapped Application Objects in RxPDO 3
    entry(0x1602, 1, U32, Rw, 0x6040_0010), // 1st Mapped Object in RxPDO 3
    entry(0x1602, 2, U32, Rw, 0x607A_0020), // 2nd Mapped Object in RxPDO 3
    entry(0x1602, 3, U32, Rw, 0).to_sub(8), // 3rd to 8th Mapped Object in RxPDO 3
    entry(0x1603, 0, U8, Rw, 2).within(0, 8), // Number of Mapped Application Objects in RxPDO 4
    entry(0x1603, 1, U32, Rw, 0x6040_0010), // 1st Mapped Object in RxPDO 4
    entry(0x1603, 2, U32, Rw, 0x60FF_0020), // 2nd Mapped Object in RxPDO 4
    entry(0x1603, 3, U32, Rw, 0).to_sub(8), // 3rd to 8th Mapped Object in RxPDO 4
    entry(0x1800, 1, U32, Rw, 0x4000_0180).plus_node_id(), // COB-ID used by TxPDO 1
    entry(0x1800, 2, U8, Rw, 0xFF), // Transmission Type
    entry(0x1800, 3, U16, Rw, 10), // Inhibit Time
    entry(0x1801, 1, U32, Rw, 0xC000_0280).plus_node_id(), // COB-ID used by TxPDO 2
    entry(0x1801, 2, U8, Rw, 0xFF), // Transmission Type
    entry(0x1801, 3, U16, Rw, 10), // Inhibit Time
    entry(0x1802, 1, U32, Rw, 0xC000_0380).plus_node_id(), // COB-ID used by TxPDO 3
    entry(0x1802, 2, U8, Rw, 0xFF), // Transmission Type
    entry(0x1802, 3, U16, Rw, 10), // Inhibit Time
    entry(0x1803, 1, U32, Rw, 0xC000_0480).plus_node_id(), // COB-ID used by TxPDO 4
    entry(0x1803, 2, U8, Rw, 0xFF), // Transmission Type
    entry(0x1803, 3, U16, Rw, 10), // Inhibit Time
    entry(0x1A00, 0, U8, Rw, 1).within(0, 8), // Number of Mapped Application Objects in TxPDO 1
    entry(0x1A00, 1, U32, Rw, 0x6041_0010), // 1st Mapped Object in TxPDO 1
    entry(0x1A00, 2, U32, Rw, 0).to_sub(8), // 2nd to 8th Mapped Object in TxPDO 1
    entry(0x1A01, 0, U8, Rw, 2).within(0, 8), // Number of Mapped Application Objects in TxPDO 2
    entry(0x1A01, 1, U32, Rw, 0x6041_0010), // 1st Mapped Object in TxPDO 2
    entry(0x1A01, 2, U32, Rw, 0x6061_0008), // 2nd Mapped Object in TxPDO 2
    entry(0x1A01, 3, U32, Rw, 0).to_sub(8), // 3rd to 8th Mapped Object in TxPDO 2
    entry(0x1A02, 0, U8, Rw, 2).within(0, 8), // Number of Mapped Application Objects in TxPDO 3
    entry(0x1A02, 1, U32, Rw, 0x6041_0010), // 1st Mapped Object in TxPDO 3
    entry(0x1A02, 2, U32, Rw, 0x6064_0020), // 2nd Mapped Object in TxPDO 3
    entry(0x1A02, 3, U32, Rw, 0).to_sub(8), // 3rd to 8th Mapped Object in TxPDO 3
    entry(0x1A03, 0, U8, Rw, 2).within(0, 8), // Number of Mapped Application Objects in TxPDO 4
    entry(0x1A03, 1, U32, Rw, 0x6041_0010), // 1st Mapped Object in TxPDO 4
    entry(0x1A03, 2, U32, Rw, 0x606C_0020), // 2nd Mapped Object in TxPDO 4
    entry(0x1A03, 3, U32, Rw, 0).to_sub(8), // 3rd to 8th Mapped Object in TxPDO 4
    // maxon's own objects, 2000 to 2FFF.
    entry(0x2000, 0, U8, Rw, 0).plus_node_id(), // Node ID
    entry(0x2001, 0, U16, Rw, 2).within(0, 7), // CAN Bitrate
    entry(0x2002, 0, U16, Rw, 5).within(0, 5), // RS232 Baudrate
    entry(0x2003, 1, U16, Ro, 0x2126), // Software Version
    entry(0x2003, 2, U16, Ro, 0x6420), // Hardware Version
    entry(0x2003, 3, U16, Ro, 0), // Application Number
    entry(0x2003, 4, U16, Ro, 0), // Application Version
    entry(0x2003, 5, U16, Ro, 0x2DB6), // Basesector Version
    entry(0x2004, 0, U64, Ro, 0), // Serial Number
    entry(0x2005, 0, U16, Rw, 0x01F4), // RS232 Frame Timeout
    entry(0x2006, 0, U16, Rw, 0x01DB), // USB Frame Timeout
    entry(0x2008, 0, U16, Rw, 0), // Miscellaneous Configuration
    entry(0x2009, 0, U16, Ro, 1), // Internal Dip Switch State
    entry(0x200A, 0, U16, Ro, 2), // CAN Bitrate Display
    entry(0x200C, 1, U32, Rw, 0).to_sub(4), // Custom persistent memory 1 to 4
    entry(0x2010, 0, U16, Rw, 0), // Internal DataRecorder Control
    entry(0x2011, 0, U16, Rw, 3), // Internal DataRecorder Configuration
    entry(0x2012, 0, U16, Rw, 0xA), // Internal DataRecorder Sampling Period
    entry(0x2013, 0, U16, Rw, 0), // Internal DataRecorder Number of Preceding Samples
    entry(0x2014, 0, U16, Rw, 0), // Internal DataRecorder Number of Sampling Variables
    entry(0x2015, 1, U16, Rw, 0).to_sub(4), // Internal DataRecorder Index of Variable 1 to 4
    entry(0x2016, 1, U16, Rw, 0).to_sub(4), // Internal DataRecorder SubIndex of Variable 1 to 4
    entry(0x2017, 0, U16, Ro, 0), // Internal DataRecorder Status
    entry(0x2018, 0, U16, Ro, 0), // Internal DataRecorder Max Number of Samples
    entry(0x2019, 0, U16, Ro, 0), // Internal DataRecorder Number of Recorded Samples
    entry(0x201A, 0, U16, Ro, 0), // Internal DataRecorder Vector Start Offset
    entry(0x201B, 0, Domain, Rw, 0), // Internal DataRecorder Data Buffer
    entry(0x2020, 0, U32, Ro, 0).mappable(), // Incremental Encoder 1 Counter
    entry(0x2021, 0, U32, Ro, 0).mappable(), // Incremental Encoder 1 Counter at Index Pulse
    entry(0x2022, 0, U16, Ro, 0).mappable(), // Hall Sensor Pattern
    entry(0x2023, 0, U16, Rw, 0), // Internal Object Actual Rotor Angle
    entry(0x2024, 0, U16, Ro, 0), // Internal System State
    entry(0x2025, 0, U32, Wo, 0), // Internal Object Reserved
    entry(0x2026, 1, U32, Rw, 0), // Internal Object MemoryAddress
    entry(0x2026, 2, U16, Rw, 0), // Internal Object MemoryValue
    entry(0x2027, 0, I16, Ro, 0).mappable(), // Current Actual Value Averaged
    entry(0x2028, 0, I32, Ro, 0).mappable(), // Velocity Actual Value Averaged
    entry(0x2029, 0, I32, Ro, 0).mappable(), // Auxiliary Velocity Actual Value Averaged
    entry(0x202C, 1, U32, Ro, 0x6400), // Internal Object Main Position Sensor Resolution
    entry(0x202C, 2, U32, Ro, 0), // Internal Object Maximal Velocity Limit
    entry(0x202C, 3, U32, Ro, 0), // Internal Object Auxiliary Position Sensor Resolution
    entry(0x202D, 1, I16, Ro, 0), // Internal Object Maximum measured angle difference
    entry(0x202D, 2, I16, Ro, 0), // Internal Object Minimum measured angle difference
    entry(0x202D, 3, U16, Ro, 0), // Internal Object Angle difference overflow counter
    entry(0x202D, 4, U16, Rw, 0x64), // Internal Object Angle Error factor 2 pole motor
    entry(0x202D, 5, U16, Rw, 0xB4), // Internal Object Angle Error factor N pole motor
    entry(0x202E, 1, U16, Ro, 0), // Internal Object ADC NTC temperature value
    entry(0x202E, 2, I16, Ro, 0), // Internal Object ADC current U (W1)
    entry(0x202E, 3, I16, Ro, 0), // Internal Object ADC current V (W2)
    entry(0x202E, 4, U16, Ro, 0).to_sub(10), // Internal Object ADC Input voltage to CAN-ID Switch 3
    entry(0x202E, 11, I16, Ro, 0), // Internal Object ADC current W (W3)
    entry(0x202E, 12, I16, Ro, 0), // Internal Object ADC Supply Voltage Udd
    entry(0x2030, 0, I16, Rww, 0).mappable(), // Current Mode Setting Value
    entry(0x2031, 0, I16, Ro, 0).mappable(), // Current Demand Value
    entry(0x2062, 0, I32, Rww, 0).mappable(), // Position Mode Setting Value
    entry(0x2069, 0, I32, Ro, 0).mappable(), // Auxiliary Velocity Sensor Actual Value
    entry(0x206B, 0, I32, Rww, 0).mappable(), // Velocity Mode Setting Value
    entry(0x206C, 0, I32, Ro, 0).mappable(), // Auxiliary Velocity Actual Value
    entry(0x2070, 1, U16, Rw, 15), // Configuration of Digital Input1
    entry(0x2070, 2, U16, Rw, 14), // Configuration of Digital Input2
    entry(0x2070, 3, U16, Rw, 13), // Configuration of Digital Input3
    entry(0x2070, 4, U16, Rw, 2), // Configuration of Digital Input4
    entry(0x2070, 5, U16, Rw, 1), // Configuration of Digital Input5
    entry(0x2070, 6, U16, Rw, 0), // Configuration of Digital Input6
    entry(0x2070, 7, U16, Rw, 9), // Configuration of Digital Input7
    entry(0x2070, 8, U16, Rw, 8), // Configuration of Digital Input8
    entry(0x2070, 9, U16, Rw, 7), // Configuration of Digital Input9
    entry(0x2071, 1, U16, Ro, 0).mappable(), // Digital Input Functionalities State
    entry(0x2071, 2, U16, Rw, 0xE387), // Digital Input Functionalities Mask
    entry(0x2071, 3, U16, Rw, 0), // Digital Input Functionalities Polarity
    entry(0x2071, 4, U16, Rw, 8), // Digital Input Functionalities Execution Mask
    entry(0x2074, 1, I32, Ro, 0).mappable(), // Position Marker Captured Position
    entry(0x2074, 2, U8, Rw, 0), // Position Marker Edge Type
    entry(0x2074, 3, U8, Rw, 0), // Position Marker Mode
    entry(0x2074, 4, U16, Rw, 0), // Position Marker Counter
    entry(0x2074, 5, I32, Ro, 0), // Position Marker History (1)
    entry(0x2074, 6, I32, Ro, 0), // Position Marker History (2)
    entry(0x2078, 1, U16, Rww, 0).mappable(), // Digital Output State
    entry(0x2078, 2, U16, Rw, 0), // Digital Output Mask
    entry(0x2078, 3, U16, Rw, 0), // Digital Output Polarity
    entry(0x2079, 1, U16, Rw, 15), // Configuration of Digital Output1
    entry(0x2079, 2, U16, Rw, 14), // Configuration of Digital Output2
    entry(0x2079, 3, U16, Rw, 13), // Configuration of Digital Output3
    entry(0x2079, 4, U16, Rw, 12), // Configuration of Digital Output4
    entry(0x2079, 5, U16, Rw, 11), // Configuration of Digital Output5
    entry(0x207A, 1, U16, Rww, 0).mappable(), // Position Compare Configuration
    entry(0x207A, 2, I32, Rww, 0).mappable(), // Position Compare Reference Position
    entry(0x207A, 3, I32, Rw, 0), // Position Compare Interval Width
    entry(0x207A, 4, U16, Rw, 0), // Position Compare Interval Repetitions
    entry(0x207A, 5, U16, Rw, 0), // Position Compare Pulse Width
    entry(0x207B, 1, U16, Rw, 15), // Configuration of Analog Input1
    entry(0x207B, 2, U16, Rw, 14), // Configuration of Analog Input2
    entry(0x207C, 1, I16, Ro, 0).mappable(), // Analog Input 1
    entry(0x207C, 2, I16, Ro, 0).mappable(), // Analog Input 2
    entry(0x207D, 0, U16, Rw, 0), // Analog Input Functionalities Execution Mask
    entry(0x2080, 0, U16, Rww, 500).mappable(), // Current Threshold for Homing Mode
    entry(0x2081, 0, I32, Rww, 0).mappable(), // Home Position
    entry(0x2082, 0, I32, Ro, 0), // Home Position Displacement
    entry(0x20C1, 0, U64, Wo, 0).mappable(), // Interpolation Data Record
    entry(0x20C4, 1, U16, Ro, 0).mappable(), // Interpolation Buffer Status
    entry(0x20C4, 2, U16, Rw, 4).within(0, 63), // Interpolation Buffer Underflow Warning
    entry(0x20C4, 3, U16, Rw, 60).within(1, 64), // Interpolation Buffer Overflow Warning
    entry(0x20F4, 0, I16, Ro, 0).mappable(), // Following Error Actual Value
    entry(0x2100, 1, U16, Rw, 10), // Brake Reaction Rise Time
    entry(0x2100, 2, U16, Rw, 10), // Brake Reaction Fall Time
    entry(0x2100, 3, U16, Rw, 65535), // Brake Timeout
    entry(0x2101, 1, U16, Rw, 30), // Standstill Window
    entry(0x2101, 2, U16, Rw, 50), // Standstill Window Time
    entry(0x2101, 3, U16, Rw, 1000), // Standstill Timeout
    entry(0x2210, 1, U32, Rw, 500).within(16, 2_500_000), // Pulse Number Incremental Encoder 1
    entry(0x2210, 2, U16, Rw, 1), // Position Sensor Type
    entry(0x2210, 3, U16, Rw, 0), // Internal Absolute Position Offset
    entry(0x2210, 4, U16, Rw, 0), // Position Sensor Polarity
    entry(0x2211, 1, U16, Rw, 0x01F4), // SSI Encoder Data Rate
    entry(0x2211, 2, U16, Rw, 0x0C0D), // SSI Encoder Number of Data Bits
    entry(0x2211, 3, I32, Ro, 0), // SSI Encoder Actual Position
    entry(0x2211, 4, U16, Rw, 0), // SSI Encoder Encoding Type
    entry(0x2212, 1, U32, Rw, 500).within(16, 2_500_000), // Incremental Encoder 2 Pulse Number
    entry(0x2212, 2, U32, Ro, 0).mappable(), // Incremental Encoder 2 Counter
    entry(0x2212, 3, U32, Ro, 0).mappable(), // Incremental Encoder 2 Counter at Index Pulse
    entry(0x2213, 1, U32, Rw, 524292).within(64, 10_000_000), // Sinus Incremental Encoder 2 Resolution
    entry(0x2213, 2, I32, Ro, 0), // Sinus Incremental Encoder 2 Actual Position
    entry(0x2213, 3, U16, Ro, 0), // Internal Sinus Incremental Encoder 2 Actual Angle
    entry(0x2220, 0, U16, Rw, 0), // Controller Structure
    entry(0x2230, 1, U32, Rw, 0), // Gear Ratio Numerator
    entry(0x2230, 2, U16, Rw, 1), // Gear Ratio Denominator
    entry(0x2230, 3, U32, Rw, 0x0001_86A0), // Gear Maximal Speed
    entry(0x2240, 1, U16, Rw, 0), // Internal SSI Encoder State
    entry(0x2240, 2, I32, Ro, 0), // Internal SSI Encoder Zero Position Reference
    entry(0x2300, 1, I32, Ro, 0), // Digital Position Desired Value
    entry(0x2300, 2, U16, Rw, 1), // Digital Position Scaling Numerator
    entry(0x2300, 3, U16, Rw, 1), // Digital Position Scaling Denominator
    entry(0x2300, 4, U8, Rw, 0), // Digital Position Polarity
    entry(0x2300, 5, I32, Rw, 0), // Digital Position Offset
    entry(0x2301, 1, I16, Rw, 0), // Analog Current Setpoint Scaling
    entry(0x2301, 2, I16, Rw, 0), // Analog Current Setpoint Offset
    entry(0x2301, 3, I8, Rw, 0), // Analog Current Setpoint Notation Index
    entry(0x2301, 4, I16, Ro, 0), // Analog Current Setpoint
    entry(0x2302, 1, I16, Rw, 0), // Analog Velocity Setpoint Scaling
    entry(0x2302, 2, I32, Rw, 0), // Analog Velocity Setpoint Offset
    entry(0x2302, 3, I8, Rw, 0), // Analog Velocity Setpoint Notation Index
    entry(0x2302, 4, I32, Ro, 0), // Analog Velocity Setpoint
    entry(0x2303, 1, I16, Rw, 0), // Analog Position Setpoint Scaling
    entry(0x2303, 2, I32, Rw, 0), // Analog Position Setpoint Offset
    entry(0x2303, 3, I8, Rw, 0), // Analog Position Setpoint Notation Index
    entry(0x2303, 4, I32, Ro, 0), // Analog Position Setpoint
    entry(0x2400, 1, U16, Rw, 0), // Internal Cut-off Frequency of Oscillator
    entry(0x2400, 2, U32, Rw, 0), // Internal Target Amplitude of Oscillation
    entry(0x2400, 3, U16, Rw, 0), // Internal Oscillation Control
    entry(0x2401, 1, U32, Ro, 0), // Internal Cycle Duration
    entry(0x2401, 2, U32, Ro, 0), // Internal Phase Delay
    entry(0x2401, 3, U16, Ro, 0), // Internal Set Value Ramp Current
    entry(0x2401, 4, U32, Ro, 0), // Internal Actual Position Peak Value
    entry(0x2401, 5, U32, Ro, 0), // Internal Actual Value of Dynamic Friction
    entry(0x2401, 6, U16, Ro, 0), // Internal Number of Oscillation Cycles
    entry(0x2401, 7, U16, Ro, 0), // Internal Maximum Friction Current
    entry(0x2401, 8, U32, Ro, 0), // Internal Actual Position Peak Value Aux
    entry(0x2401, 9, U32, Ro, 0), // Internal Actual Position Peak Value Difference
    entry(0x2410, 1, U16, Rw, 0), // Internal LR Identification Control
    entry(0x2410, 2, U16, Rw, 0), // Internal LR Identification Current
    entry(0x2411, 1, U16, Ro, 0).to_sub(3), // Internal Resistance to Frequency
    entry(0x2FFF, 1, U32, Wo, 0), // Internal Download Start
    entry(0x2FFF, 2, U16, Rw, 0), // Internal Download Number of SubSections
    entry(0x2FFF, 3, Domain, Wo, 0), // Internal Download Code SubSection
    entry(0x2FFF, 4, U16, Ro, 0x2DB6), // Internal Download Boot Code Version
    entry(0x2FFF, 5, U32, Ro, 0x6620), // Internal Download Serial Number HighWord
    entry(0x2FFF, 6, U32, Ro, 0), // Internal Download Serial Number LowWord
    // Objects of the device profile, 6000 to 6FFF (CiA 402).
    entry(0x6007, 0, I16, Rw, 3), // AbortCode Connection Option Code
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
    entry(0x6099, 1, U32, Rww, 100).mappable(), // Speed for Switch Search
    entry(0x6099, 2, U32, Rww, 10).mappable(), // Speed for Zero Search
    entry(0x609A, 0, U32, Rww, 1000).mappable(), // Homing Acceleration
    entry(0x60C0, 0, I16, Rw, -1).within(-1, -1), // Interpolation Sub Mode Selection
    entry(0x60C2, 1, U8, Rw, 1).within(1, 1), // Interpolation Time Periode Value
    entry(0x60C2, 2, I8, Rw, -3).within(-3, -3), // Interpolation Time Index
    entry(0x60C4, 1, U32, Ro, 0), // Maximum Buffer Size
    entry(0x60C4, 2, U32, Ro, 0), // Actual Buffer Size
    entry(0x60C4, 3, U8, Rw, 0).within(0, 0), // Buffer Organisation
    entry(0x60C4, 4, U16, Rw, 0).within(0, 64), // Buffer Position
    entry(0x60C4, 5, U8, Wo, 8).within(8, 8), // Size Of Data Record
    entry(0x60C4, 6, U8, Wo, 0).within(0, 1).mappable(), // Buffer Clear
    entry(0x60C5, 0, U32, Rw, 4_294_967_295), // Max Acceleration
    entry(0x60F6, 1, I16, Rww, 300).mappable(), // Current Regulator P-Gain
    entry(0x60F6, 2, I16, Rww, 100).mappable(), // Current Regulator I-Gain
    entry(0x60F9, 1, I16, Rww, 1000).mappable(), // Speed Regulator P-Gain
    entry(0x60F9, 2, I16, Rww, 100).mappable(), // Speed Regulator I-Gain
    entry(0x60F9, 4, U16, Rww, 0).mappable(), // Velocity Feedforward Factor in Speed Regulator
    entry(0x60F9, 5, U16, Rww, 0x0714).mappable(), // Acceleration Feedforward Factor in Speed Regulator
    entry(0x60FB, 1, I16, Rww, 150).mappable(), // Position Regulator P-Gain
    entry(0x60FB, 2, I16, Rww, 10).mappable(), // Position Regulator I-Gain
    entry(0x60FB, 3, I16, Rww, 200).mappable(), // Position Regulator D-Gain
    entry(0x60FB, 4, U16, Rww, 0).mappable(), // Velocity Feedforward Factor in Position Regulator
    entry(0x60FB, 5, U16, Rww, 0).mappable(), // Acceleration Feedforward Factor in Position Regulator
    entry(0x60FF, 0, I32, Rww, 0).mappable(), // Target Velocity
    entry(0x6402, 0, U16, Rw, 10), // Motor Type
    entry(0x6410, 1, U16, Rww, 10000).within(0, 10000).mappable(), // Continuous Current Limit
    entry(0x6410, 2, U16, Rww, 25000).within(0, 25000).mappable(), // Output Current Limit
    entry(0x6410, 3, U8, Rw, 1), // Pole Pair Number
    entry(0x6410, 4, U32, Rww, 25000).mappable(), // Maximal Motor Speed
    entry(0x6410, 5, U16, Rw, 40).within(1, 5400), // Thermal Time Constant Winding
    entry(0x6502, 0, U32, Ro, 0x003F_0065), // Supported Drive Modes
];
