//! The SDO server: reads and writes of the object dictionary, in one exchange or in segments (CiA
//! 301, "SDO services").

use protocol::canopen::sdo::{
    Expedited, Initiate, SEGMENT_LEN, SdoRequest, SdoResponse, SdoSegment,
};
use protocol::epos2::objects::Address;
use protocol::epos2::{AbortCode, BoundedVec};

use crate::epos2::dictionary::Dictionary;
use crate::epos2::node::SimulatedDrive;
use crate::epos2::value::ObjectValue;

/// Longest silence of a client within a transfer; that of a real drive is not documented.
const TRANSFER_TIMEOUT_US: u64 = 1_000_000;
/// The longest value that can be written.
const MAX_BYTES: usize = 8;

/// SDO server of the drive.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SdoServer {
    transfer: Option<ServerTransfer>,
    /// Time of the last request.
    last_request_us: u64,
}

/// A segmented transfer under way.
#[derive(Clone, Copy, Debug)]
struct ServerTransfer {
    address: Address,
    toggle: bool,
    content: TransferContent,
}

#[derive(Clone, Copy, Debug)]
enum TransferContent {
    Upload {
        value: ObjectValue,
        sent: usize,
    },
    Download {
        bytes: BoundedVec<u8, MAX_BYTES>,
        /// Bytes announced.
        size: Option<u32>,
    },
}

impl SdoServer {
    /// Executes a request; an abort by the client has no answer.
    pub fn execute(
        &mut self,
        node: &mut SimulatedDrive,
        request: &SdoRequest,
        now_us: u64,
    ) -> Option<SdoResponse> {
        self.last_request_us = now_us;
        let transfer = self.transfer.take();
        let current = transfer.map_or(Address::default(), |transfer| transfer.address);
        let (address, outcome) = match request {
            SdoRequest::InitiateUpload { address } => (*address, self.upload(node, *address)),
            SdoRequest::InitiateDownload { address, transfer } => {
                (*address, self.download(node, *address, transfer))
            }
            SdoRequest::UploadSegment { toggle } => {
                (current, self.upload_segment(transfer, *toggle))
            }
            SdoRequest::DownloadSegment(segment) => {
                (current, self.download_segment(node, transfer, segment))
            }
            SdoRequest::Abort { .. } => return None,
            // Block transfer has the address in the same place.
            SdoRequest::Unknown([_, low, high, sub, ..]) => {
                let index = u16::from_le_bytes([*low, *high]);
                (Address::new(index, *sub), Err(AbortCode::COMMAND))
            }
        };
        Some(outcome.unwrap_or_else(|error| SdoResponse::Abort { address, error }))
    }

    /// Aborts a transfer whose client is silent.
    pub fn expire(&mut self, now_us: u64) -> Option<SdoResponse> {
        let silent = now_us.saturating_sub(self.last_request_us) > TRANSFER_TIMEOUT_US;
        let transfer = self.transfer.take_if(|_| silent)?;
        Some(SdoResponse::Abort {
            address: transfer.address,
            error: AbortCode::TIMEOUT,
        })
    }

    fn upload(
        &mut self,
        node: &SimulatedDrive,
        address: Address,
    ) -> Result<SdoResponse, AbortCode> {
        let value = node.read(address)?;
        let transfer = match Expedited::new(value.bytes()) {
            Some(data) => Initiate::Expedited(data),
            None => {
                self.begin(address, TransferContent::Upload { value, sent: 0 });
                Initiate::Segmented {
                    size: u32::try_from(value.bytes().len()).ok(),
                }
            }
        };
        Ok(SdoResponse::InitiateUpload { address, transfer })
    }

    fn upload_segment(
        &mut self,
        transfer: Option<ServerTransfer>,
        toggle: bool,
    ) -> Result<SdoResponse, AbortCode> {
        let mut transfer = transfer.ok_or(AbortCode::COMMAND)?;
        let TransferContent::Upload { value, sent } = &mut transfer.content else {
            return Err(AbortCode::COMMAND);
        };
        if toggle != transfer.toggle {
            return Err(AbortCode::TOGGLE);
        }
        let segment = SdoSegment::cut(value.bytes(), *sent, toggle, SEGMENT_LEN);
        *sent += segment.bytes.len();
        transfer.toggle = !toggle;
        if !segment.last {
            self.transfer = Some(transfer);
        }
        Ok(SdoResponse::UploadSegment(segment))
    }

    fn begin(&mut self, address: Address, content: TransferContent) {
        self.transfer = Some(ServerTransfer {
            address,
            toggle: false,
            content,
        });
    }

    fn download(
        &mut self,
        node: &mut SimulatedDrive,
        address: Address,
        transfer: &Initiate,
    ) -> Result<SdoResponse, AbortCode> {
        match transfer {
            Initiate::Expedited(data) => node.write_bytes(address, data.as_slice())?,
            // The type of the object determines how many of the four bytes count.
            Initiate::Unsized(bytes) => {
                let len = Dictionary::entry(address)?.ty.bytes();
                let bytes = bytes.get(..len).ok_or(AbortCode::TOO_SHORT)?;
                node.write_bytes(address, bytes)?;
            }
            Initiate::Segmented { size } => {
                match size {
                    Some(size) => node.check_download(address, *size as usize)?,
                    None => Dictionary::entry(address)?.check_access()?,
                }
                let (bytes, size) = (BoundedVec::new(), *size);
                self.begin(address, TransferContent::Download { bytes, size });
            }
        }
        Ok(SdoResponse::InitiateDownload { address })
    }

    fn download_segment(
        &mut self,
        node: &mut SimulatedDrive,
        transfer: Option<ServerTransfer>,
        segment: &SdoSegment,
    ) -> Result<SdoResponse, AbortCode> {
        let mut transfer = transfer.ok_or(AbortCode::COMMAND)?;
        let TransferContent::Download { bytes, size } = &mut transfer.content else {
            return Err(AbortCode::COMMAND);
        };
        let toggle = segment.toggle;
        if toggle != transfer.toggle {
            return Err(AbortCode::TOGGLE);
        }
        let len = bytes.len() + segment.bytes.len();
        if len > size.map_or(MAX_BYTES, |size| size as usize).min(MAX_BYTES) {
            return Err(AbortCode::TOO_LONG);
        }
        bytes.extend(segment.bytes.iter().copied());
        if segment.last {
            if size.is_some_and(|size| len < size as usize) {
                return Err(AbortCode::TOO_SHORT);
            }
            node.write_bytes(transfer.address, bytes)?;
        } else {
            transfer.toggle = !toggle;
            self.transfer = Some(transfer);
        }
        Ok(SdoResponse::DownloadSegment { toggle })
    }
}
