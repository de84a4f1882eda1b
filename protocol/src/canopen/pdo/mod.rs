//! PDO, process data objects (CiA 301, "PDO services"): objects of a node in one frame, by a
//! configured mapping.
//!
//! This module has the values of the configuration objects ([`CommunicationId`],
//! [`TransmissionType`], [`MappedObject`]), the order of their writes ([`configuration`]), and the
//! packing of data by a mapping ([`PdoLayout`]).

mod communication;
mod configuration;
mod layout;

pub use communication::{CommunicationId, TransmissionType};
pub use configuration::{Configuration, Pdo, Write, configuration};
pub use layout::{LayoutError, MAX_ENTRIES, MappedObject, PdoError, PdoLayout};
