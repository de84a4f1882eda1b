//! PDO, process data objects (CiA 301, "PDO services"): objects of a node sent in one frame, by what is configured beforehand.
//!
//! Here are the values of the configuring objects ([`CommunicationId`], [`TransmissionType`], [`Mapping`]), the order in
//! which they are to be written ([`configuration`]), and the packing of a frame's data by its mapping ([`Layout`]).

mod communication;
mod configuration;
mod layout;

pub use communication::{CommunicationId, TransmissionType};
pub use configuration::{Configuration, Pdo, Write, configuration};
pub use layout::{Layout, LayoutError, MAX_ENTRIES, Mapping, PdoError};
