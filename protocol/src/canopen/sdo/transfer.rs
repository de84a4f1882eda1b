//! The rules of one SDO transfer (CiA 301): which request follows which response, without time or
//! I/O.

use super::{
    Expedited, GenericSdoRequest, GenericSdoResponse, GenericSdoSegment, Initiate, SEGMENT_LEN,
    TransferError,
};
use crate::BoundedVec;
use crate::canopen::Address;

/// A transfer of up to `N` bytes in segments of up to `L`.
#[derive(Clone, Copy, Debug)]
pub struct SdoTransfer<const N: usize, const L: usize = SEGMENT_LEN> {
    address: Address,
    state: TransferState,
    /// Data to write, or read so far.
    data: BoundedVec<u8, N>,
    segment_len: usize,
}

/// The expected response.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum TransferState {
    InitiateUpload,
    UploadSegment {
        toggle: bool,
        size: Option<u32>,
    },
    InitiateDownload,
    /// `sent` bytes are out, those of the outstanding segment included.
    DownloadSegment {
        toggle: bool,
        sent: usize,
    },
}

/// The step after a response.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TransferStep<const N: usize, const L: usize = SEGMENT_LEN> {
    /// Send the next request.
    Send(GenericSdoRequest<L>),
    /// The transfer is complete, with the data read. The last bytes of a value whose size the node
    /// does not indicate (four bytes in one exchange) may be unused.
    Done(BoundedVec<u8, N>),
}

impl<const N: usize, const L: usize> SdoTransfer<N, L> {
    /// Starts reading an object; returns the transfer and its first request.
    #[must_use]
    pub fn upload(address: Address) -> (Self, GenericSdoRequest<L>) {
        let transfer = Self {
            address,
            state: TransferState::InitiateUpload,
            data: BoundedVec::new(),
            segment_len: L,
        };
        (transfer, GenericSdoRequest::InitiateUpload { address })
    }

    /// Starts writing an object; returns the transfer and its first request. One to four bytes take
    /// one exchange, any other length segments of up to `segment_len` bytes.
    ///
    /// # Errors
    /// [`TransferError::TooLong`].
    pub fn download(
        address: Address,
        data: &[u8],
        segment_len: usize,
    ) -> Result<(Self, GenericSdoRequest<L>), TransferError> {
        let bytes = BoundedVec::from_slice(data).map_err(|full| TransferError::TooLong {
            max: full.capacity,
            got: data.len(),
        })?;
        let initiate = Expedited::new(data).map_or(
            Initiate::Segmented {
                size: u32::try_from(data.len()).ok(),
            },
            Initiate::Expedited,
        );
        let transfer = Self {
            address,
            state: TransferState::InitiateDownload,
            data: bytes,
            segment_len,
        };
        let request = GenericSdoRequest::InitiateDownload {
            address,
            transfer: initiate,
        };
        Ok((transfer, request))
    }

    /// The object.
    #[must_use]
    pub const fn address(&self) -> Address {
        self.address
    }

    /// Description of the expected response, for messages.
    const fn expected(&self) -> &'static str {
        match self.state {
            TransferState::InitiateUpload => "an upload response (4x)",
            TransferState::UploadSegment { .. } => "an upload segment (0x, 1x)",
            TransferState::InitiateDownload => "a download response (60)",
            TransferState::DownloadSegment { .. } => "a download segment response (20, 30)",
        }
    }

    /// Processes the response to the last request.
    ///
    /// # Errors
    /// [`TransferError`]; the transfer has then ended, and the node expects an abort where
    /// [`TransferError::abort_code`] gives one.
    pub fn handle_response(
        &mut self,
        response: &GenericSdoResponse<L>,
    ) -> Result<TransferStep<N, L>, TransferError> {
        if let Some(got) = response.address().filter(|got| *got != self.address) {
            return Err(TransferError::OtherObject {
                expected: self.address,
                got,
            });
        }
        match (self.state, response) {
            (_, GenericSdoResponse::Abort { error, .. }) => Err(TransferError::Aborted(*error)),
            (
                TransferState::InitiateUpload,
                GenericSdoResponse::InitiateUpload { transfer, .. },
            ) => self.begin_upload(transfer),
            (
                TransferState::UploadSegment { toggle, size },
                GenericSdoResponse::UploadSegment(segment),
            ) => {
                check_toggle(toggle, segment.toggle)?;
                self.append(size, segment)
            }
            (TransferState::InitiateDownload, GenericSdoResponse::InitiateDownload { .. }) => {
                if Expedited::new(&self.data).is_some() {
                    return Ok(TransferStep::Done(BoundedVec::new()));
                }
                Ok(self.send_segment(0, false))
            }
            (
                TransferState::DownloadSegment { toggle, sent },
                GenericSdoResponse::DownloadSegment { toggle: got },
            ) => {
                check_toggle(toggle, *got)?;
                if sent >= self.data.len() {
                    return Ok(TransferStep::Done(BoundedVec::new()));
                }
                Ok(self.send_segment(sent, !toggle))
            }
            (_, response) => {
                let [got, ..] = response.to_bytes();
                Err(TransferError::Unexpected {
                    expected: self.expected(),
                    got,
                })
            }
        }
    }

    fn begin_upload(&mut self, initiate: &Initiate) -> Result<TransferStep<N, L>, TransferError> {
        let size = match initiate {
            Initiate::Expedited(data) => {
                self.data.extend(data.as_slice().iter().copied());
                return Ok(TransferStep::Done(self.data));
            }
            Initiate::Unsized(bytes) => {
                self.data.extend(*bytes);
                return Ok(TransferStep::Done(self.data));
            }
            Initiate::Segmented { size } => *size,
        };
        match size.map(|size| size as usize) {
            Some(got) if got > N => Err(TransferError::TooLong { max: N, got }),
            _ => Ok(self.request_segment(false, size)),
        }
    }

    fn append(
        &mut self,
        size: Option<u32>,
        segment: &GenericSdoSegment<L>,
    ) -> Result<TransferStep<N, L>, TransferError> {
        let got = self.data.len() + segment.bytes.len();
        let is_wrong = |expected: usize| {
            if segment.last {
                got != expected
            } else {
                got > expected
            }
        };
        let indicated = size.map(|size| size as usize);
        if let Some(expected) = indicated.filter(|&expected| is_wrong(expected)) {
            return Err(TransferError::Size { expected, got });
        }
        if got > N {
            return Err(TransferError::TooLong { max: N, got });
        }
        // CiA 301 allows an empty last segment, but no object of a drive needs one. Without a size,
        // a value whose bytes were lost would count as complete.
        if segment.bytes.is_empty() && !(segment.last && size.is_some()) {
            return Err(TransferError::EmptySegment);
        }
        self.data.extend(segment.bytes.iter().copied());
        if segment.last {
            Ok(TransferStep::Done(self.data))
        } else {
            Ok(self.request_segment(!segment.toggle, size))
        }
    }

    fn request_segment(&mut self, toggle: bool, size: Option<u32>) -> TransferStep<N, L> {
        self.state = TransferState::UploadSegment { toggle, size };
        TransferStep::Send(GenericSdoRequest::UploadSegment { toggle })
    }

    fn send_segment(&mut self, offset: usize, toggle: bool) -> TransferStep<N, L> {
        let segment = GenericSdoSegment::cut(&self.data, offset, toggle, self.segment_len);
        let sent = offset + segment.bytes.len();
        self.state = TransferState::DownloadSegment { toggle, sent };
        TransferStep::Send(GenericSdoRequest::DownloadSegment(segment))
    }
}

fn check_toggle(expected: bool, got: bool) -> Result<(), TransferError> {
    if expected == got {
        Ok(())
    } else {
        Err(TransferError::Toggle { expected, got })
    }
}
