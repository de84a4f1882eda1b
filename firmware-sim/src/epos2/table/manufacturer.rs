//! maxon's own objects, 2000 to 2FFF.

use super::super::entry::EntryAccess::{Const, Ro, Rw, Rww, Wo};
use super::super::entry::Type::{Domain, I8, I16, I32, U8, U16, U32, U64};
use super::super::entry::{DictionaryEntry, entry};

#[rustfmt::skip]
pub(super) const ENTRIES: &[DictionaryEntry] = &[
    entry(0x2000, 0, U8, Rw, 0).plus_node_id(), // Node ID
    entry(0x2001, 0, U16, Rw, 2).within(0, 7), // CAN Bitrate
    entry(0x2002, 0, U16, Rw, 5).within(0, 5), // RS232 Baudrate
    entry(0x2003, 0, U8, Const, 5), // Internal Number of Entries
    entry(0x2003, 1, U16, Ro, 0x2126), // Software Version
    entry(0x2003, 2, U16, Ro, 0x6420), // Hardware Version
    entry(0x2003, 3, U16, Ro, 0), // Application Number
    entry(0x2003, 4, U16, Ro, 0), // Application Version
    entry(0x2003, 5, U16, Ro, 0x2DB6), // Basesector Version
    entry(0x2004, 0, U64, Const, 0), // Serial Number
    entry(0x2005, 0, U16, Rw, 0x01F4), // RS232 Frame Timeout
    entry(0x2006, 0, U16, Rw, 0x01DB), // USB Frame Timeout
    entry(0x2008, 0, U16, Rw, 0), // Miscellaneous Configuration
    entry(0x2009, 0, U16, Ro, 1), // Internal Dip Switch State
    entry(0x200A, 0, U16, Ro, 2), // CAN Bitrate Display
    entry(0x200C, 0, U8, Const, 4), // Internal Number of Entries
    entry(0x200C, 1, U32, Rw, 0).to_sub(4), // Custom persistent memory 1 to 4
    entry(0x2010, 0, U16, Rw, 0), // Internal DataRecorder Control
    entry(0x2011, 0, U16, Rw, 3), // Internal DataRecorder Configuration
    entry(0x2012, 0, U16, Rw, 0xA), // Internal DataRecorder Sampling Period
    entry(0x2013, 0, U16, Rw, 0), // Internal DataRecorder Number of Preceding Samples
    entry(0x2014, 0, U16, Rw, 0), // Internal DataRecorder Number of Sampling Variables
    entry(0x2015, 0, U8, Ro, 4), // Internal Number of Entries
    entry(0x2015, 1, U16, Rw, 0).to_sub(4), // Internal DataRecorder Index of Variable 1 to 4
    entry(0x2016, 0, U8, Ro, 4), // Internal Number of Entries
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
    entry(0x2026, 0, U8, Ro, 2), // Internal Object Number of Entries
    entry(0x2026, 1, U32, Rw, 0), // Internal Object MemoryAddress
    entry(0x2026, 2, U16, Rw, 0), // Internal Object MemoryValue
    entry(0x2027, 0, I16, Ro, 0).mappable(), // Current Actual Value Averaged
    entry(0x2028, 0, I32, Ro, 0).mappable(), // Velocity Actual Value Averaged
    entry(0x2029, 0, I32, Ro, 0).mappable(), // Auxiliary Velocity Actual Value Averaged
    entry(0x202C, 0, U8, Ro, 3), // Internal Object Number of Entries
    entry(0x202C, 1, U32, Ro, 0x6400), // Internal Object Main Position Sensor Resolution
    entry(0x202C, 2, U32, Ro, 0), // Internal Object Maximal Velocity Limit
    entry(0x202C, 3, U32, Ro, 0), // Internal Object Auxiliary Position Sensor Resolution
    entry(0x202D, 0, U8, Ro, 5), // Internal Object Number of Entries
    entry(0x202D, 1, I16, Ro, 0), // Internal Object Maximum measured angle difference
    entry(0x202D, 2, I16, Ro, 0), // Internal Object Minimum measured angle difference
    entry(0x202D, 3, U16, Ro, 0), // Internal Object Angle difference overflow counter
    entry(0x202D, 4, U16, Rw, 0x64), // Internal Object Angle Error factor 2 pole motor
    entry(0x202D, 5, U16, Rw, 0xB4), // Internal Object Angle Error factor N pole motor
    entry(0x202E, 0, U8, Ro, 12), // Internal Object Number of Entries
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
    entry(0x2071, 1, U16, Ro, 0).mappable(), // Digital Input Functionalities State
    entry(0x2071, 2, U16, Rw, 0xE387), // Digital Input Functionalities Mask
    entry(0x2071, 3, U16, Rw, 0), // Digital Input Functionalities Polarity
    entry(0x2071, 4, U16, Rw, 8), // Digital Input Functionalities Execution Mask
    entry(0x2074, 0, U8, Ro, 6), // Internal Number of Entries
    entry(0x2074, 1, I32, Ro, 0).mappable(), // Position Marker Captured Position
    entry(0x2074, 2, U8, Rw, 0), // Position Marker Edge Type
    entry(0x2074, 3, U8, Rw, 0), // Position Marker Mode
    entry(0x2074, 4, U16, Rw, 0), // Position Marker Counter
    entry(0x2074, 5, I32, Ro, 0), // Position Marker History (1)
    entry(0x2074, 6, I32, Ro, 0), // Position Marker History (2)
    entry(0x2078, 0, U8, Ro, 3), // Internal Number of Entries
    entry(0x2078, 1, U16, Rww, 0).mappable(), // Digital Output State
    entry(0x2078, 2, U16, Rw, 0), // Digital Output Mask
    entry(0x2078, 3, U16, Rw, 0), // Digital Output Polarity
    entry(0x2079, 0, U8, Ro, 5), // Internal Number of Entries
    entry(0x2079, 1, U16, Rw, 15), // Configuration of Digital Output1
    entry(0x2079, 2, U16, Rw, 14), // Configuration of Digital Output2
    entry(0x2079, 3, U16, Rw, 13), // Configuration of Digital Output3
    entry(0x2079, 4, U16, Rw, 12), // Configuration of Digital Output4
    entry(0x2079, 5, U16, Rw, 11), // Configuration of Digital Output5
    entry(0x207A, 0, U8, Ro, 5), // Internal Number of Entries
    entry(0x207A, 1, U16, Rww, 0).mappable(), // Position Compare Configuration
    entry(0x207A, 2, I32, Rww, 0).mappable(), // Position Compare Reference Position
    entry(0x207A, 3, I32, Rw, 0), // Position Compare Interval Width
    entry(0x207A, 4, U16, Rw, 0), // Position Compare Interval Repetitions
    entry(0x207A, 5, U16, Rw, 0), // Position Compare Pulse Width
    entry(0x207B, 0, U8, Ro, 2), // Internal Number of Entries
    entry(0x207B, 1, U16, Rw, 15), // Configuration of Analog Input1
    entry(0x207B, 2, U16, Rw, 14), // Configuration of Analog Input2
    entry(0x207C, 0, U8, Ro, 2), // Internal Number of Entries
    entry(0x207C, 1, I16, Ro, 0).mappable(), // Analog Input 1
    entry(0x207C, 2, I16, Ro, 0).mappable(), // Analog Input 2
    entry(0x207D, 0, U16, Rw, 0), // Analog Input Functionalities Execution Mask
    entry(0x2080, 0, U16, Rww, 500).mappable(), // Current Threshold for Homing Mode
    entry(0x2081, 0, I32, Rww, 0).mappable(), // Home Position
    entry(0x2082, 0, I32, Ro, 0), // Home Position Displacement
    entry(0x20C1, 0, U64, Wo, 0).mappable(), // Interpolation Data Record
    entry(0x20C4, 0, U8, Ro, 3), // Internal Number of Entries
    entry(0x20C4, 1, U16, Ro, 0).mappable(), // Interpolation Buffer Status
    entry(0x20C4, 2, U16, Rw, 4).within(0, 63), // Interpolation Buffer Underflow Warning
    entry(0x20C4, 3, U16, Rw, 60).within(1, 64), // Interpolation Buffer Overflow Warning
    entry(0x20F4, 0, I16, Ro, 0).mappable(), // Following Error Actual Value
    entry(0x2100, 0, U8, Ro, 3), // Internal Number of Entries
    entry(0x2100, 1, U16, Rw, 10), // Brake Reaction Rise Time
    entry(0x2100, 2, U16, Rw, 10), // Brake Reaction Fall Time
    entry(0x2100, 3, U16, Rw, 65535), // Brake Timeout
    entry(0x2101, 0, U8, Ro, 3), // Internal Number of Entries
    entry(0x2101, 1, U16, Rw, 30), // Standstill Window
    entry(0x2101, 2, U16, Rw, 50), // Standstill Window Time
    entry(0x2101, 3, U16, Rw, 1000), // Standstill Timeout
    entry(0x2210, 0, U8, Ro, 4), // Internal Number of Entries
    entry(0x2210, 1, U32, Rw, 500).within(16, 2_500_000), // Pulse Number Incremental Encoder 1
    entry(0x2210, 2, U16, Rw, 1), // Position Sensor Type
    entry(0x2210, 3, U16, Rw, 0), // Internal Absolute Position Offset
    entry(0x2210, 4, U16, Rw, 0), // Position Sensor Polarity
    entry(0x2211, 0, U8, Ro, 4), // Internal Number of Entries
    entry(0x2211, 1, U16, Rw, 0x01F4), // SSI Encoder Data Rate
    entry(0x2211, 2, U16, Rw, 0x0C0D), // SSI Encoder Number of Data Bits
    entry(0x2211, 3, I32, Ro, 0), // SSI Encoder Actual Position
    entry(0x2211, 4, U16, Rw, 0), // SSI Encoder Encoding Type
    entry(0x2212, 0, U8, Ro, 3), // Internal Number of Entries
    entry(0x2212, 1, U32, Rw, 500).within(16, 2_500_000), // Incremental Encoder 2 Pulse Number
    entry(0x2212, 2, U32, Ro, 0).mappable(), // Incremental Encoder 2 Counter
    entry(0x2212, 3, U32, Ro, 0).mappable(), // Incremental Encoder 2 Counter at Index Pulse
    entry(0x2213, 0, U8, Ro, 3), // Internal Number of Entries
    entry(0x2213, 1, U32, Rw, 524292).within(64, 10_000_000), // Sinus Incremental Encoder 2 Resolution
    entry(0x2213, 2, I32, Ro, 0), // Sinus Incremental Encoder 2 Actual Position
    entry(0x2213, 3, U16, Ro, 0), // Internal Sinus Incremental Encoder 2 Actual Angle
    entry(0x2220, 0, U16, Rw, 0), // Controller Structure
    entry(0x2230, 0, U8, Ro, 3), // Internal Number of Entries
    entry(0x2230, 1, U32, Rw, 0), // Gear Ratio Numerator
    entry(0x2230, 2, U16, Rw, 1), // Gear Ratio Denominator
    entry(0x2230, 3, U32, Rw, 0x0001_86A0), // Gear Maximal Speed
    entry(0x2240, 0, U8, Ro, 2), // Internal Number of Entries
    entry(0x2240, 1, U16, Rw, 0), // Internal SSI Encoder State
    entry(0x2240, 2, I32, Ro, 0), // Internal SSI Encoder Zero Position Reference
    entry(0x2300, 0, U8, Ro, 5), // Internal Number of Entries
    entry(0x2300, 1, I32, Ro, 0), // Digital Position Desired Value
    entry(0x2300, 2, U16, Rw, 1), // Digital Position Scaling Numerator
    entry(0x2300, 3, U16, Rw, 1), // Digital Position Scaling Denominator
    entry(0x2300, 4, U8, Rw, 0), // Digital Position Polarity
    entry(0x2300, 5, I32, Rw, 0), // Digital Position Offset
    entry(0x2301, 0, U8, Ro, 4), // Internal Number of Entries
    entry(0x2301, 1, I16, Rw, 0), // Analog Current Setpoint Scaling
    entry(0x2301, 2, I16, Rw, 0), // Analog Current Setpoint Offset
    entry(0x2301, 3, I8, Rw, 0), // Analog Current Setpoint Notation Index
    entry(0x2301, 4, I16, Ro, 0), // Analog Current Setpoint
    entry(0x2302, 0, U8, Ro, 4), // Internal Number of Entries
    entry(0x2302, 1, I16, Rw, 0), // Analog Velocity Setpoint Scaling
    entry(0x2302, 2, I32, Rw, 0), // Analog Velocity Setpoint Offset
    entry(0x2302, 3, I8, Rw, 0), // Analog Velocity Setpoint Notation Index
    entry(0x2302, 4, I32, Ro, 0), // Analog Velocity Setpoint
    entry(0x2303, 0, U8, Ro, 4), // Internal Number of Entries
    entry(0x2303, 1, I16, Rw, 0), // Analog Position Setpoint Scaling
    entry(0x2303, 2, I32, Rw, 0), // Analog Position Setpoint Offset
    entry(0x2303, 3, I8, Rw, 0), // Analog Position Setpoint Notation Index
    entry(0x2303, 4, I32, Ro, 0), // Analog Position Setpoint
    entry(0x2400, 0, U8, Ro, 3), // Internal Number of Entries
    entry(0x2400, 1, U16, Rw, 0), // Internal Cut-off Frequency of Oscillator
    entry(0x2400, 2, U32, Rw, 0), // Internal Target Amplitude of Oscillation
    entry(0x2400, 3, U16, Rw, 0), // Internal Oscillation Control
    entry(0x2401, 0, U8, Ro, 9), // Internal Number of Entries
    entry(0x2401, 1, U32, Ro, 0), // Internal Cycle Duration
    entry(0x2401, 2, U32, Ro, 0), // Internal Phase Delay
    entry(0x2401, 3, U16, Ro, 0), // Internal Set Value Ramp Current
    entry(0x2401, 4, U32, Ro, 0), // Internal Actual Position Peak Value
    entry(0x2401, 5, U32, Ro, 0), // Internal Actual Value of Dynamic Friction
    entry(0x2401, 6, U16, Ro, 0), // Internal Number of Oscillation Cycles
    entry(0x2401, 7, U16, Ro, 0), // Internal Maximum Friction Current
    entry(0x2401, 8, U32, Ro, 0), // Internal Actual Position Peak Value Aux
    entry(0x2401, 9, U32, Ro, 0), // Internal Actual Position Peak Value Difference
    entry(0x2410, 0, U8, Ro, 2), // Internal Number of Entries
    entry(0x2410, 1, U16, Rw, 0), // Internal LR Identification Control
    entry(0x2410, 2, U16, Rw, 0), // Internal LR Identification Current
    entry(0x2411, 0, U8, Ro, 3), // Internal Number of Entries
    entry(0x2411, 1, U16, Ro, 0).to_sub(3), // Internal Resistance to Frequency
    entry(0x2FFF, 0, U8, Ro, 6), // Internal Number of Entries
    entry(0x2FFF, 1, U32, Wo, 0), // Internal Download Start
    entry(0x2FFF, 2, U16, Rw, 0), // Internal Download Number of SubSections
    entry(0x2FFF, 3, Domain, Wo, 0), // Internal Download Code SubSection
    entry(0x2FFF, 4, U16, Ro, 0x2DB6), // Internal Download Boot Code Version
    entry(0x2FFF, 5, U32, Const, 0x6620), // Internal Download Serial Number HighWord
    entry(0x2FFF, 6, U32, Const, 0), // Internal Download Serial Number LowWord
];
