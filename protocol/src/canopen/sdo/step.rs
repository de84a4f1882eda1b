//! What an answer does to a transfer: the rules of CiA 301 without time and without sending.

use super::outcome::{Access, TransferError};
use super::{Answer, Expedited, Initiate, Request, Segment};
use crate::epos2::Bounded;
use crate::epos2::objects::Address;

/// The transfer under way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Transfer<const N: usize> {
    pub address: Address,
    pub step: Step,
    /// To write, or read so far.
    pub data: Bounded<u8, N>,
}

/// Which answer is waited for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Step {
    InitiateUpload,
    UploadSegment {
        toggle: bool,
        size: Option<u32>,
    },
    InitiateDownload,
    /// `sent` bytes of the data are out, this segment's included.
    DownloadSegment {
        toggle: bool,
        sent: usize,
    },
}

impl Step {
    pub const fn access(self) -> Access {
        match self {
            Self::InitiateUpload | Self::UploadSegment { .. } => Access::Read,
            Self::InitiateDownload | Self::DownloadSegment { .. } => Access::Write,
        }
    }

    /// Nothing has been answered yet.
    pub const fn is_first(self) -> bool {
        matches!(self, Self::InitiateUpload | Self::InitiateDownload)
    }

    /// The answer waited for, in words.
    pub const fn expected(self) -> &'static str {
        match self {
            Self::InitiateUpload => "the answer to an upload (4x)",
            Self::UploadSegment { .. } => "an upload segment (0x, 1x)",
            Self::InitiateDownload => "the answer to a download (60)",
            Self::DownloadSegment { .. } => "the answer to a download segment (20, 30)",
        }
    }
}

/// What an answer leads to.
pub(super) enum Next {
    Ask(Step, Request),
    Done { sized: bool },
}

/// What follows from an answer that came while `transfer` waited for one.
pub(super) fn advance<const N: usize>(
    transfer: &mut Transfer<N>,
    answer: &Answer,
) -> Result<Next, TransferError> {
    if let Some(got) = answer.address().filter(|got| *got != transfer.address) {
        return Err(TransferError::OtherObject {
            expected: transfer.address,
            got,
        });
    }
    match (transfer.step, answer) {
        (_, Answer::Abort { error, .. }) => Err(TransferError::Aborted(*error)),
        (Step::InitiateUpload, Answer::InitiateUpload { transfer: how, .. }) => {
            begin_upload(transfer, how)
        }
        (Step::UploadSegment { toggle, size }, Answer::UploadSegment(segment)) => {
            same_toggle(toggle, segment.toggle)?;
            append(transfer, size, segment)
        }
        (Step::InitiateDownload, Answer::InitiateDownload { .. }) => {
            if Expedited::new(&transfer.data).is_some() {
                return Ok(Next::Done { sized: true });
            }
            Ok(next_segment(&transfer.data, 0, false))
        }
        (Step::DownloadSegment { toggle, sent }, Answer::DownloadSegment { toggle: got }) => {
            same_toggle(toggle, *got)?;
            if sent >= transfer.data.len() {
                return Ok(Next::Done { sized: true });
            }
            Ok(next_segment(&transfer.data, sent, !toggle))
        }
        (step, answer) => {
            let [got, ..] = answer.to_bytes();
            Err(TransferError::Unexpected {
                expected: step.expected(),
                got,
            })
        }
    }
}

/// The first answer to a read.
fn begin_upload<const N: usize>(
    transfer: &mut Transfer<N>,
    how: &Initiate,
) -> Result<Next, TransferError> {
    let size = match how {
        Initiate::Expedited(data) => {
            transfer.data.extend(data.as_slice().iter().copied());
            return Ok(Next::Done { sized: true });
        }
        Initiate::Unsized(bytes) => {
            transfer.data.extend(*bytes);
            return Ok(Next::Done { sized: false });
        }
        Initiate::Segmented { size } => *size,
    };
    match size.map(|size| size as usize) {
        Some(got) if got > N => Err(TransferError::TooLong { max: N, got }),
        _ => Ok(ask_segment(false, size)),
    }
}

/// A segment that was read.
fn append<const N: usize>(
    transfer: &mut Transfer<N>,
    size: Option<u32>,
    segment: &Segment,
) -> Result<Next, TransferError> {
    let announced = size.map(|size| size as usize);
    let got = transfer.data.len() + segment.bytes.len();
    let wrong = |expected: usize| {
        if segment.last {
            got != expected
        } else {
            got > expected
        }
    };
    if let Some(expected) = announced.filter(|&expected| wrong(expected)) {
        return Err(TransferError::Size { expected, got });
    }
    if got > N {
        return Err(TransferError::TooLong { max: N, got });
    }
    transfer.data.extend(segment.bytes.iter().copied());
    if segment.last {
        Ok(Next::Done { sized: true })
    } else if segment.bytes.is_empty() {
        Err(TransferError::EmptySegment)
    } else {
        Ok(ask_segment(!segment.toggle, size))
    }
}

fn ask_segment(toggle: bool, size: Option<u32>) -> Next {
    Next::Ask(
        Step::UploadSegment { toggle, size },
        Request::UploadSegment { toggle },
    )
}

fn next_segment(data: &[u8], offset: usize, toggle: bool) -> Next {
    let segment = Segment::cut(data, offset, toggle);
    let sent = offset + segment.bytes.len();
    Next::Ask(
        Step::DownloadSegment { toggle, sent },
        Request::DownloadSegment(segment),
    )
}

fn same_toggle(expected: bool, got: bool) -> Result<(), TransferError> {
    if expected == got {
        Ok(())
    } else {
        Err(TransferError::Toggle { expected, got })
    }
}
