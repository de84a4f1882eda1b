//! The VLP-16 family's two UDP packets and the tables of its models.
//!
//! One packet layout serves VLP-16, Puck LITE, Puck Hi-Res, HDL-32E and VLP-32C; what differs is a [`models::Model`].
//! Source: VLP-16 user manual 63-9243 chapter 9, VLP-32C user manual 63-9325 chapter 9, HDL-32E user manual.
//! Left out on purpose: times, azimuths between blocks, coordinates, and anything that needs more than one packet;
//! also HDL-64E and VLS-128, whose blocks carry other flags and are refused here.

mod data;
mod error;
pub mod models;
mod position;

pub use data::{
    BLOCK_LEN, BLOCKS, Block, CHANNELS, Channel, DATA_LEN, DataPacket, Product, ReturnMode,
};
pub use error::PacketError;
pub use models::{Laser, Model};
pub use position::{NmeaError, POSITION_LEN, PositionPacket, Pps, Rmc, UtcTime};
