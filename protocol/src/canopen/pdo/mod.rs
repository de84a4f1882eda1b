//! PDO, process data objects (CiA 301, "PDO services"): objects of a node sent in one frame, by what is configured beforehand.
//!
//! Here are the values of the configuring objects ([`CommunicationId`], [`TransmissionType`], [`MappedObject`]), the order in
//! which they are to be written ([`configuration`]), and the packing of a frame's data by its mapping ([`PdoLayout`]).

mod communication;
mod configuration;
mod layout;

pub use communication::{CommunicationId, TransmissionType};
pub use configuration::{Configuration, Pdo, Write, configuration};
pub use layout::{
    LayoutError, MAX_ENTRIES, MappedObject, MappedObject as Mapping, PdoError, PdoLayout,
    PdoLayout as Layout,
};
