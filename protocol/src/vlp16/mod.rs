//! The two UDP packets of the VLP-16 family and the tables of its models.
//!
//! VLP-16, Puck LITE, Puck Hi-Res, HDL-32E and VLP-32C share one packet layout and differ in their
//! [`models::LidarModel`]. Blocks of HDL-64E and VLS-128 carry other flags and are rejected.
//! Sources: VLP-16 user manual 63-9243 chapter 9, VLP-32C user manual 63-9325 chapter 9, HDL-32E
//! user manual.

mod data;
mod error;
pub mod models;
mod nmea;
mod position;

pub use data::{
    BLOCK_LEN, BLOCKS, CHANNELS, ChannelReturn, DATA_LEN, DataBlock, DataPacket, Product,
    ReturnMode,
};
pub use error::PacketError;
pub use models::{Laser, LidarModel};
pub use nmea::{GpsPosition, NmeaError, NmeaFault, Rmc, UtcTime};
pub use position::{POSITION_LEN, PositionPacket, Pps};
