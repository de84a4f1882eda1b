//! The client's side of SDO transfers as a machine without I/O: one transfer at a time, of up to `N` bytes.
//!
//! The caller moves the frames, says what time it is when it sends one, and retries if it wants to. An answer names at
//! most its object, so a late one cannot be told from the answer to the same question asked again: see
//! [`SdoClient::owed`].

use units::{Host, Span, Stamp};

use super::outcome::{Handled, Outcome, StartError, TransferError, Value};
use super::step::{Next, Step, Transfer, advance};
use super::{Access, Answer, Expedited, Initiate, Request};
use crate::canopen::cob_id::{CommunicationObject, NodeId};
use crate::canopen::frame::CanFrame;
use crate::epos2::Bounded;
use crate::epos2::objects::{Address, Scalar};

/// The client of one node's SDO server, for objects of up to `N` bytes (at least 4).
#[derive(Clone, Debug)]
pub struct SdoClient<const N: usize> {
    node: NodeId,
    timeout: Span,
    transfer: Option<Transfer<N>>,
    /// To be sent, the abort first.
    abort: Option<Request>,
    request: Option<Request>,
    /// From when the last request was sent.
    deadline: Option<Stamp<Host>>,
    outcome: Option<Outcome<N>>,
    owed: Option<Address>,
}

impl<const N: usize> SdoClient<N> {
    /// The client of `node`, which is given `timeout` for each answer.
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
            owed: None,
        }
    }

    /// Changes the time given for each answer, from the next request on.
    pub const fn set_timeout(&mut self, timeout: Span) {
        self.timeout = timeout;
    }

    /// Begins to read an object.
    ///
    /// # Errors
    /// [`StartError::Busy`].
    pub fn read(&mut self, address: Address) -> Result<(), StartError> {
        self.start(
            address,
            Step::InitiateUpload,
            Bounded::new(),
            Request::InitiateUpload { address },
        )
    }

    /// Begins to write an object: up to four bytes in one exchange, none or more in segments.
    ///
    /// # Errors
    /// [`StartError`].
    pub fn write(&mut self, address: Address, data: &[u8]) -> Result<(), StartError> {
        let bytes = Bounded::from_slice(data).map_err(|full| StartError::TooLong {
            max: full.capacity,
            got: data.len(),
        })?;
        let transfer = Expedited::new(data).map_or(
            Initiate::Segmented {
                size: u32::try_from(data.len()).ok(),
            },
            Initiate::Expedited,
        );
        let request = Request::InitiateDownload { address, transfer };
        self.start(address, Step::InitiateDownload, bytes, request)
    }

    /// Begins to write an object of type `T`.
    ///
    /// # Errors
    /// [`StartError::Busy`].
    pub fn write_scalar<T: Scalar>(
        &mut self,
        address: Address,
        value: T,
    ) -> Result<(), StartError> {
        self.write(address, Expedited::of(value).as_slice())
    }

    fn start(
        &mut self,
        address: Address,
        step: Step,
        data: Bounded<u8, N>,
        request: Request,
    ) -> Result<(), StartError> {
        let under_way = self.transfer.map(|transfer| transfer.address);
        if let Some(address) = under_way.or(self.outcome.map(|outcome| outcome.address)) {
            return Err(StartError::Busy { address });
        }
        self.transfer = Some(Transfer {
            address,
            step,
            data,
        });
        self.request = Some(request);
        Ok(())
    }

    /// Whether a transfer is under way.
    #[must_use]
    pub const fn is_busy(&self) -> bool {
        self.transfer.is_some()
    }

    /// The object of a transfer that was given up without an answer, as long as the answer may still come.
    ///
    /// Asked the same again, the client would take the late answer for the new one. To be sure of a value, read another
    /// object first: a node's answers come in the order of its requests, so when that answer is there, the late one has
    /// come (and been dropped) or never will.
    #[must_use]
    pub const fn owed(&self) -> Option<Address> {
        self.owed
    }

    /// The next frame to send; `now` is when that is done. The time for the answer begins.
    pub fn poll_transmit(&mut self, now: Stamp<Host>) -> Option<CanFrame> {
        let message = self.abort.take().or_else(|| {
            let request = self.request.take()?;
            self.deadline = Some(now.saturating_add(self.timeout));
            Some(request)
        })?;
        Some(message.to_frame(self.node))
    }

    /// When [`SdoClient::handle_timeout`] wants to be called, if no answer comes.
    #[must_use]
    pub const fn poll_timeout(&self) -> Option<Stamp<Host>> {
        self.deadline
    }

    /// Gives the transfer up if its time is over.
    pub fn handle_timeout(&mut self, now: Stamp<Host>) {
        if self.deadline.is_none_or(|deadline| now < deadline) {
            return;
        }
        if let Some(transfer) = self.transfer.take() {
            let expected = transfer.step.expected();
            self.fail(&transfer, TransferError::Timeout { expected });
        }
    }

    /// Breaks a transfer off; the node is told.
    pub fn cancel(&mut self) {
        if let Some(transfer) = self.transfer.take() {
            self.fail(&transfer, TransferError::Cancelled);
        }
    }

    /// How the last transfer ended, once.
    pub const fn poll_outcome(&mut self) -> Option<Outcome<N>> {
        self.outcome.take()
    }

    /// Takes any frame of the bus.
    pub fn handle_frame(&mut self, frame: &CanFrame) -> Handled {
        if frame.cob_id() != Some(CommunicationObject::SdoAnswer(self.node).cob_id()) {
            return Handled::Foreign;
        }
        // Not asked yet, so this answers nothing, however well it would fit.
        let waiting = self.request.is_none();
        let Some(transfer) = self.transfer.take_if(|_| waiting) else {
            return self.unasked(frame);
        };
        let answer = match Answer::parse(frame) {
            Ok((_, answer)) => answer,
            Err(error) => {
                self.fail(&transfer, error.into());
                return Handled::Taken;
            }
        };
        if self.is_late(&transfer, &answer) {
            self.owed = None;
            self.transfer = Some(transfer);
            return Handled::Late;
        }
        self.take(transfer, &answer);
        Handled::Taken
    }

    fn unasked(&mut self, frame: &CanFrame) -> Handled {
        let late = match (self.owed, Answer::parse(frame)) {
            (Some(owed), Ok((_, answer))) => answer.address().is_none_or(|got| got == owed),
            _ => false,
        };
        if late {
            self.owed = None;
            Handled::Late
        } else {
            Handled::Unasked
        }
    }

    /// Whether `answer` is the one owed by an earlier transfer and cannot be this one's.
    fn is_late(&self, transfer: &Transfer<N>, answer: &Answer) -> bool {
        let Some(owed) = self.owed else {
            return false;
        };
        match (answer, answer.address()) {
            (Answer::Abort { .. }, Some(got)) => got == owed && got != transfer.address,
            (_, Some(got)) => {
                let kind = match answer {
                    Answer::InitiateUpload { .. } => Step::InitiateUpload,
                    _ => Step::InitiateDownload,
                };
                got == owed && (got != transfer.address || transfer.step != kind)
            }
            // Segments name no object; at the beginning of a transfer they are not its own.
            (_, None) => transfer.step.is_first(),
        }
    }

    /// Moves `transfer` on by an answer to it.
    fn take(&mut self, mut transfer: Transfer<N>, answer: &Answer) {
        let next = advance(&mut transfer, answer);
        // Answers come in order: what another request was owed before this one will not come any more.
        if matches!(next, Ok(_) | Err(TransferError::Aborted(_))) {
            self.owed = self.owed.filter(|owed| *owed == transfer.address);
        }
        match next {
            Ok(Next::Ask(step, request)) => {
                transfer.step = step;
                self.transfer = Some(transfer);
                self.request = Some(request);
                self.deadline = None;
            }
            Ok(Next::Done { sized }) => {
                let bytes = match transfer.step.access() {
                    Access::Read => transfer.data,
                    Access::Write => Bounded::new(),
                };
                self.end(&transfer, Ok(Value { bytes, sized }));
            }
            Err(error) => self.fail(&transfer, error),
        }
    }

    fn fail(&mut self, transfer: &Transfer<N>, error: TransferError) {
        let address = transfer.address;
        let outstanding = self.request.take().is_none();
        if outstanding && error.leaves_answer() {
            self.owed = Some(address);
        }
        // A node that was asked nothing yet has nothing to abort.
        if outstanding || !transfer.step.is_first() {
            self.abort = error
                .abort_code()
                .map(|error| Request::Abort { address, error });
        }
        self.end(transfer, Err(error));
    }

    fn end(&mut self, transfer: &Transfer<N>, result: Result<Value<N>, TransferError>) {
        self.deadline = None;
        self.outcome = Some(Outcome {
            address: transfer.address,
            access: transfer.step.access(),
            result,
        });
    }
}
