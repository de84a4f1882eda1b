//! Communication objects, 1000 to 1FFF (CiA 301).

use super::super::entry::EntryAccess::{Const, Ro, Rw, Rww};
use super::super::entry::Type::{Text, U8, U16, U32};
use super::super::entry::{DictionaryEntry, entry};

#[rustfmt::skip]
pub(super) const ENTRIES: &[DictionaryEntry] = &[
    entry(0x1000, 0, U32, Ro, 0x0002_0192), // Device Type
    entry(0x1001, 0, U8, Ro, 0), // Error Register
    entry(0x1003, 0, U8, Rw, 0), // Number of Errors
    entry(0x1003, 1, U32, Ro, 0).to_sub(5), // Error History (1) to (5)
    entry(0x1005, 0, U32, Rw, 0x80).within(128, 128), // COB-ID SYNC
    entry(0x1008, 0, Text, Const, 0), // Manufacturer Device Name
    entry(0x100C, 0, U16, Rw, 0), // Guard Time
    entry(0x100D, 0, U8, Rw, 0), // Lifetime Factor
    entry(0x1010, 0, U8, Ro, 1), // Internal Largest SubIndex Supported
    entry(0x1010, 1, U32, Rw, 0), // Save All Parameters
    entry(0x1011, 0, U8, Ro, 5), // Internal Largest SubIndex Supported
    entry(0x1011, 1, U32, Rw, 0), // Restore All Default Parameters
    entry(0x1011, 4, U32, Rw, 0), // Internal Object Restore Factory Default Parameters
    entry(0x1011, 5, U32, Rw, 0), // Restore Default PDO COB-IDs
    entry(0x1012, 0, U32, Rw, 0x0100), // COB-ID Time Stamp Object
    entry(0x1013, 0, U32, Rww, 0).mappable(), // High Resolution Time Stamp
    entry(0x1014, 0, U32, Rw, 0x80).plus_node_id(), // COB-ID EMCY
    entry(0x1016, 0, U8, Ro, 2), // Internal Number of Entries
    entry(0x1016, 1, U32, Rw, 0), // Consumer 1 Heartbeat Time
    entry(0x1016, 2, U32, Rw, 0), // Consumer 2 Heartbeat Time
    entry(0x1017, 0, U16, Rw, 0), // Producer Heartbeat Time
    entry(0x1018, 0, U8, Ro, 4), // Internal Number of Entries
    entry(0x1018, 1, U32, Ro, 0xFB), // Vendor ID
    entry(0x1018, 2, U32, Ro, 0x6420_0000), // Product Code
    entry(0x1018, 3, U32, Ro, 0x2126_0000), // Revision Number
    entry(0x1018, 4, U32, Ro, 0), // Serial Number
    entry(0x1020, 0, U8, Ro, 2), // Internal Number of Entries
    entry(0x1020, 1, U32, Rw, 0), // Configuration Date
    entry(0x1020, 2, U32, Rw, 0), // Configuration Time
    entry(0x1200, 0, U8, Ro, 2), // Internal Number of Entries
    entry(0x1200, 1, U32, Ro, 0x0600).plus_node_id(), // SDO COB-ID Client->Server (rx)
    entry(0x1200, 2, U32, Ro, 0x0580).plus_node_id(), // SDO COB-ID Server->Client (tx)
    entry(0x1400, 0, U8, Ro, 2), // Internal Largest SubIndex Supported
    entry(0x1400, 1, U32, Rw, 0x0200).plus_node_id(), // COB-ID used by RxPDO 1
    entry(0x1400, 2, U8, Rw, 0xFF), // Transmission Type
    entry(0x1401, 0, U8, Ro, 2), // Internal Largest SubIndex Supported
    entry(0x1401, 1, U32, Rw, 0x0300).plus_node_id(), // COB-ID used by RxPDO 2
    entry(0x1401, 2, U8, Rw, 0xFF), // Transmission Type
    entry(0x1402, 0, U8, Ro, 2), // Internal Largest SubIndex Supported
    entry(0x1402, 1, U32, Rw, 0x0400).plus_node_id(), // COB-ID used by RxPDO 3
    entry(0x1402, 2, U8, Rw, 0xFF), // Transmission Type
    entry(0x1403, 0, U8, Ro, 2), // Internal Largest SubIndex Supported
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
    entry(0x1800, 0, U8, Ro, 3), // Internal Largest SubIndex Supported
    entry(0x1800, 1, U32, Rw, 0x4000_0180).plus_node_id(), // COB-ID used by TxPDO 1
    entry(0x1800, 2, U8, Rw, 0xFF), // Transmission Type
    entry(0x1800, 3, U16, Rw, 10), // Inhibit Time
    entry(0x1801, 0, U8, Ro, 3), // Internal Largest SubIndex Supported
    entry(0x1801, 1, U32, Rw, 0xC000_0280).plus_node_id(), // COB-ID used by TxPDO 2
    entry(0x1801, 2, U8, Rw, 0xFF), // Transmission Type
    entry(0x1801, 3, U16, Rw, 10), // Inhibit Time
    entry(0x1802, 0, U8, Ro, 3), // Internal Largest SubIndex Supported
    entry(0x1802, 1, U32, Rw, 0xC000_0380).plus_node_id(), // COB-ID used by TxPDO 3
    entry(0x1802, 2, U8, Rw, 0xFF), // Transmission Type
    entry(0x1802, 3, U16, Rw, 10), // Inhibit Time
    entry(0x1803, 0, U8, Ro, 3), // Internal Largest SubIndex Supported
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
];
