//! An SDO client as a state machine without I/O: one transfer at a time.
//!
//! The caller carries the frames, passes the time and decides about retries. A response names at
//! most its object, so a stale one looks like the response to a repeated request: see
//! [`SdoClient::pending_stale_response`].

use units::{Host, Span, Stamp};

use super::{
    FrameDisposition, SEGMENT_LEN, SdoOutcome, SdoRequest, SdoResponse, SdoTransfer, SdoValue,
    StartError, TransferError, TransferStep,
};
use crate::canopen::cob_id::{CommunicationObject, NodeId};
use crate::canopen::frame::CanFrame;
use crate::canopen::{Address, Scalar};

/// The client of one node's SDO server, for objects of up to `N` bytes (at least 4).
#[derive(Clone, Debug)]
pub struct SdoClient<const N: usize> {
    node: NodeId,
    timeout: Span,
    transfer: Option<SdoTransfer<N>>,
    /// Sent before `request`.
    abort: Option<SdoRequest>,
    request: Option<SdoRequest>,
    /// Set when a request is sent.
    deadline: Option<Stamp<Host>>,
    outcome: Option<SdoOutcome<N>>,
    stale: Option<Address>,
}

impl<const N: usize> SdoClient<N> {
    /// Creates a client of `node` that waits up to `timeout` for each response.
    #[must_use]
    pub const fn new(node: NodeId, timeout: Span) -> Self {
        const { assert!(N >= 4) };
        Self {
            node,
            timeout,
            transfer: None,
            abort: None,
            request: None,
            deadline: None,
            outcome: None,
            stale: None,
        }
    }

    /// Changes the time limit, from the next request on.
    pub const fn set_timeout(&mut self, timeout: Span) {
        self.timeout = timeout;
    }

    /// Starts reading an object.
    ///
    /// # Errors
    /// [`StartError::Busy`].
    pub fn read(&mut self, address: Address) -> Result<(), StartError> {
        self.start(SdoTransfer::upload(address))
    }

    /// Starts writing an object: one to four bytes in one exchange, any other length in segments.
    ///
    /// # Errors
    /// [`StartError`].
    pub fn write(&mut self, address: Address, data: &[u8]) -> Result<(), StartError> {
        let started = SdoTransfer::download(address, data, SEGMENT_LEN);
        self.start(started.map_err(|_| StartError::TooLong {
            max: N,
            got: data.len(),
        })?)
    }

    /// Starts writing an object of type `T`.
    ///
    /// # Errors
    /// [`StartError::Busy`].
    pub fn write_scalar<T: Scalar>(
        &mut self,
        address: Address,
        value: T,
    ) -> Result<(), StartError> {
        self.write(address, super::Expedited::of(value).as_slice())
    }

    fn start(
        &mut self,
        (transfer, request): (SdoTransfer<N>, SdoRequest),
    ) -> Result<(), StartError> {
        let active = self.transfer.map(|transfer| transfer.address());
        if let Some(address) = active.or(self.outcome.map(|outcome| outcome.address)) {
            return Err(StartError::Busy { address });
        }
        self.transfer = Some(transfer);
        self.request = Some(request);
        Ok(())
    }

    /// Whether a transfer is active.
    #[must_use]
    pub const fn is_busy(&self) -> bool {
        self.transfer.is_some()
    }

    /// The object of a transfer given up without a response, while that response may still arrive.
    ///
    /// If the same request is repeated, the client takes the stale response for the new one. To be
    /// sure of a value, read another object first: a node responds in the order of requests, so
    /// once that response is there, the stale one has been dropped or is lost.
    #[must_use]
    pub const fn pending_stale_response(&self) -> Option<Address> {
        self.stale
    }

    /// The next frame to send. `now` starts the time limit of its response.
    pub fn poll_transmit(&mut self, now: Stamp<Host>) -> Option<CanFrame> {
        let message = self.abort.take().or_else(|| {
            let request = self.request.take()?;
            self.deadline = Some(now.saturating_add(self.timeout));
            Some(request)
        })?;
        Some(message.to_frame(self.node))
    }

    /// When to call [`SdoClient::handle_timeout`] if no response arrives.
    #[must_use]
    pub const fn poll_timeout(&self) -> Option<Stamp<Host>> {
        self.deadline
    }

    /// Ends the transfer with an error if its time limit has passed.
    pub fn handle_timeout(&mut self, now: Stamp<Host>) {
        if self.deadline.is_none_or(|deadline| now < deadline) {
            return;
        }
        if let Some(transfer) = self.transfer.take() {
            let expected = transfer.expected();
            self.fail(&transfer, TransferError::Timeout { expected });
        }
    }

    /// Cancels the transfer and sends an abort to the node.
    pub fn cancel(&mut self) {
        if let Some(transfer) = self.transfer.take() {
            self.fail(&transfer, TransferError::Cancelled);
        }
    }

    /// Takes the outcome of the last transfer.
    pub const fn poll_outcome(&mut self) -> Option<SdoOutcome<N>> {
        self.outcome.take()
    }

    /// Processes any frame of the bus.
    pub fn handle_frame(&mut self, frame: &CanFrame) -> FrameDisposition {
        if frame.cob_id() != Some(CommunicationObject::SdoResponse(self.node).cob_id()) {
            return FrameDisposition::Foreign;
        }
        // A response before the request was sent matches nothing, however well it fits.
        let is_sent = self.request.is_none();
        let Some(transfer) = self.transfer.take_if(|_| is_sent) else {
            return self.unsolicited(frame);
        };
        let response = match SdoResponse::parse(frame) {
            Ok((_, response)) => response,
            Err(error) => {
                self.fail(&transfer, error.into());
                return FrameDisposition::Accepted;
            }
        };
        if self.is_stale(&transfer, &response) {
            self.stale = None;
            self.transfer = Some(transfer);
            return FrameDisposition::Stale;
        }
        self.advance(transfer, &response);
        FrameDisposition::Accepted
    }

    fn unsolicited(&mut self, frame: &CanFrame) -> FrameDisposition {
        let is_stale = match (self.stale, SdoResponse::parse(frame)) {
            (Some(stale), Ok((_, response))) => response.address().is_none_or(|got| got == stale),
            _ => false,
        };
        if is_stale {
            self.stale = None;
            FrameDisposition::Stale
        } else {
            FrameDisposition::Unsolicited
        }
    }

    /// Whether `response` belongs to the transfer given up earlier and cannot belong to this one.
    fn is_stale(&self, transfer: &SdoTransfer<N>, response: &SdoResponse) -> bool {
        let Some(stale) = self.stale else {
            return false;
        };
        let Some(got) = response.address() else {
            // Segments name no object; the first response of a transfer is none.
            return transfer.is_first();
        };
        let fits = got == transfer.address()
            && match response {
                SdoResponse::Abort { .. } => true,
                _ => transfer.awaits_initiate(response),
            };
        got == stale && !fits
    }

    fn advance(&mut self, mut transfer: SdoTransfer<N>, response: &SdoResponse) {
        let step = transfer.handle_response(response);
        // Responses arrive in order: those to requests before this one are lost.
        if matches!(step, Ok(_) | Err(TransferError::Aborted(_))) {
            self.stale = self.stale.filter(|stale| *stale == transfer.address());
        }
        match step {
            Ok(TransferStep::Send(request)) => {
                self.transfer = Some(transfer);
                self.request = Some(request);
                self.deadline = None;
            }
            Ok(TransferStep::Done(value)) => self.end(&transfer, Ok(value)),
            Err(error) => self.fail(&transfer, error),
        }
    }

    fn fail(&mut self, transfer: &SdoTransfer<N>, error: TransferError) {
        let address = transfer.address();
        let is_outstanding = self.request.take().is_none();
        if is_outstanding && error.leaves_response() {
            self.stale = Some(address);
        }
        // Before the first request is sent, the node has nothing to abort.
        if is_outstanding || !transfer.is_first() {
            self.abort = error
                .abort_code()
                .map(|error| SdoRequest::Abort { address, error });
        }
        self.end(transfer, Err(error));
    }

    fn end(&mut self, transfer: &SdoTransfer<N>, result: Result<SdoValue<N>, TransferError>) {
        self.deadline = None;
        self.outcome = Some(SdoOutcome {
            address: transfer.address(),
            direction: transfer.direction(),
            result,
        });
    }
}
