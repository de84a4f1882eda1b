//! Limits of requests, connections and times, as docs/src/daemon.md states them.

use std::time::Duration;

#[cfg(devices)]
pub use engine::service::events::{QUEUE, SUBSCRIBERS};
#[cfg(devices)]
pub use engine::service::live_preview::{FRAME_POINTS, WAITING_RECORDS};
#[cfg(devices)]
pub use engine::service::scan_record::{NAME_BYTES, NAME_CHARS, NOTES_CHARS};

/// Largest body of a request, bytes.
pub const BODY_BYTES: usize = 16 << 10;
/// Longest path with its query, bytes.
pub const TARGET_BYTES: usize = 2 << 10;
/// All headers of a request, bytes.
pub const HEAD_BYTES: usize = 16 << 10;
/// Headers of a request.
pub const HEADERS: usize = 64;
/// Connections over TCP; one more revokes the oldest without the token, or is closed.
pub const CONNECTIONS: usize = 64;
/// Connections of one other host without the token; one more revokes the oldest of them.
pub const SHARE: usize = CONNECTIONS / 4;
/// Connections over the Unix socket; one more revokes the oldest.
pub const LOCAL_CONNECTIONS: usize = 32;
/// Longest message of a WebSocket client, bytes.
pub const CLIENT_MESSAGE_BYTES: usize = 1 << 10;
/// Clouds made for downloads at once.
pub const MAKING: usize = 2;
/// Downloads at once.
pub const DOWNLOADS: usize = 8;
/// Browsers signed in.
pub const SIGNED_IN: usize = 64;
/// Wrong tokens of a host in [`WRONG_TOKENS_WITHIN`]; then its tokens are refused unread.
pub const WRONG_TOKENS: usize = 10;
/// Time over which wrong tokens are counted.
pub const WRONG_TOKENS_WITHIN: Duration = Duration::from_secs(60);
/// Time for which a scan that was deleted with undo can be restored.
pub const UNDO: Duration = Duration::from_secs(10);
/// Messages kept of a scan.
pub const MESSAGES: usize = 100;

/// Time limits. Tests take shorter ones.
#[derive(Clone, Copy, Debug)]
pub struct Waits {
    /// Headers of a request, from when the connection is free for one.
    pub headers: Duration,
    /// Body of a request.
    pub body: Duration,
    /// Between pings of a WebSocket client.
    pub ping: Duration,
    /// Silence of a WebSocket client.
    pub silence: Duration,
    /// Writes to a client that has proved no authorisation and takes nothing.
    pub write: Duration,
    /// Writes to any other client that takes nothing.
    pub download: Duration,
}

impl Default for Waits {
    fn default() -> Self {
        Self {
            headers: Duration::from_secs(10),
            body: Duration::from_secs(10),
            ping: Duration::from_secs(20),
            silence: Duration::from_secs(60),
            write: Duration::from_secs(5),
            download: Duration::from_secs(60),
        }
    }
}
