//! How much of everything there may be at most: what docs/src/daemon.md states.

use std::time::Duration;

/// Largest body of a request, bytes.
pub const BODY_BYTES: usize = 16 << 10;
/// Longest path with its query, bytes.
pub const TARGET_BYTES: usize = 2 << 10;
/// All headers of a request, bytes.
pub const HEAD_BYTES: usize = 16 << 10;
/// Headers of a request.
pub const HEADERS: usize = 64;
/// Connections over TCP; one more takes the place of the oldest that has not shown the token, or is closed.
pub const CONNECTIONS: usize = 64;
/// Of those from one other host that have not shown the token; one more takes the place of the oldest of them.
pub const SHARE: usize = CONNECTIONS / 4;
/// Connections over the Unix socket; one more takes the place of the oldest.
pub const LOCAL_CONNECTIONS: usize = 32;
/// WebSocket clients.
pub const SUBSCRIBERS: usize = 32;
/// Messages that may wait for a client.
pub const QUEUE: usize = 256;
/// Longest message of a WebSocket client, bytes.
pub const CLIENT_MESSAGE_BYTES: usize = 1 << 10;
/// Clouds that are made for downloads at once.
pub const MAKING: usize = 2;
/// Downloads at once.
pub const DOWNLOADS: usize = 8;
/// Browsers that are signed in.
pub const SIGNED_IN: usize = 64;
/// Points of a live frame.
pub const FRAME_POINTS: usize = 16_384;
/// Longest name of a scan, bytes.
pub const NAME_BYTES: usize = 60;
/// Records that may wait for the live view.
pub const LIVE_RECORDS: usize = 8_192;

/// Sentences that are kept of a scan.
pub const MESSAGES: usize = 100;

/// What lasts too long. Tests take shorter ones.
#[derive(Clone, Copy, Debug)]
pub struct Waits {
    /// For the headers of a request, from when the connection is free for one.
    pub headers: Duration,
    /// For the body of a request.
    pub body: Duration,
    /// Between pings of a WebSocket client.
    pub ping: Duration,
    /// Silence of a WebSocket client.
    pub silence: Duration,
    /// For a client that takes nothing of what it is sent and has shown no right to more than the page that signs in.
    pub write: Duration,
    /// For any other client that takes nothing of its download, or of whatever it is sent.
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
