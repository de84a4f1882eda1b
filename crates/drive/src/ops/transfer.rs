//! Transfers of objects of any length, with the rules of SDO on every link.

use protocol::BoundedVec;
use protocol::canopen::sdo::{Expedited, SdoTransfer, TransferStep};
use protocol::epos2::AbortCode;
use protocol::epos2::objects::Address;

use crate::command::ObjectBytes;
use crate::error::{DriveError, Operation, WrittenData};
use crate::exchange::{MAX_SEGMENT, ObjectAccess, TransferRequest};

use super::{Ops, lock};

/// Bytes of the longest object that can be read.
const MAX_OBJECT: usize = 256;

type ObjectTransfer = SdoTransfer<MAX_OBJECT, MAX_SEGMENT>;

impl Ops {
    /// Reads an object of any length. A transfer with a lost reply is restarted.
    ///
    /// # Errors
    /// [`DriveError::Transfer`] in addition to those of any read.
    pub async fn read_bytes(&self, address: Address) -> Result<Vec<u8>, DriveError> {
        let mut retries = self.config.timing.read_retries;
        loop {
            let (transfer, request) = ObjectTransfer::upload(address);
            let read = self.run_transfer(Operation::read(address), transfer, request);
            match read.await {
                Err(DriveError::NoAnswer { .. }) if retries > 0 => retries -= 1,
                result => return result.map(|value| value.to_vec()),
            }
        }
    }

    /// Writes an object of any length: one to four bytes in one exchange, more in segments. Nothing
    /// is repeated, because a write whose reply is lost may have been executed.
    ///
    /// # Errors
    /// [`DriveError::Transfer`] in addition to those of any write.
    pub async fn write_bytes(
        &self,
        address: Address,
        bytes: &ObjectBytes,
    ) -> Result<(), DriveError> {
        if let Some(data) = Expedited::new(bytes) {
            let width = bytes.len() as u8; // 1 to 4
            return self.write_raw(address, data.to_u32(), width).await;
        }
        let operation = Operation {
            address,
            written: Some(WrittenData::Bytes(bytes.len())),
        };
        let segment_len = lock(&self.core).link.segment_len();
        let (transfer, request) = ObjectTransfer::download(address, bytes, segment_len)
            .map_err(|error| DriveError::Transfer { operation, error })?;
        let written = self.run_transfer(operation, transfer, request).await;
        if let Err(DriveError::NoAnswer { .. }) = written {
            self.abort_transfer(address, AbortCode::TIMEOUT);
        }
        written.map(drop)
    }

    async fn run_transfer(
        &self,
        operation: Operation,
        mut transfer: ObjectTransfer,
        mut request: TransferRequest,
    ) -> Result<BoundedVec<u8, MAX_OBJECT>, DriveError> {
        let address = transfer.address();
        loop {
            let exchange = self.request(address, ObjectAccess::Transfer(request));
            let reply = self.send_as(operation, exchange).await?.reply;
            match transfer.handle_response(&reply.to_sdo(&request)) {
                Ok(TransferStep::Send(next)) => request = next,
                Ok(TransferStep::Done(value)) => return Ok(value),
                Err(error) => {
                    if let Some(code) = error.abort_code() {
                        self.abort_transfer(address, code);
                    }
                    return Err(DriveError::Transfer { operation, error });
                }
            }
        }
    }

    /// Aborts a transfer on CAN. On a serial link the next transfer does that.
    fn abort_transfer(&self, address: Address, error: AbortCode) {
        self.on_can(|can, _| can.abort_transfer(address, error));
    }
}
