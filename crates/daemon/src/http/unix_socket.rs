//! The Unix socket of a service, for the user and group of its process.

use std::os::unix::fs::PermissionsExt;
use std::os::unix::net::{UnixListener as StdUnixListener, UnixStream};
use std::path::{Path, PathBuf};

use axum::Router;
use engine::failure::{Failure, Kind};
use tokio::net::UnixListener;

use super::server::{Server, cannot_listen, no_runtime};

/// A bound Unix socket. Dropping it removes its file.
pub(crate) struct UnixSocket {
    listener: StdUnixListener,
    file: SocketFile,
}

struct SocketFile(PathBuf);

impl Drop for SocketFile {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

impl UnixSocket {
    /// Binds a socket for its user and group.
    ///
    /// # Errors
    /// [`Kind::NoDevice`] where another service answers there, [`Kind::Usage`] where it cannot be
    /// bound.
    pub(crate) fn bind(path: &Path) -> Result<Self, Failure> {
        if UnixStream::connect(path).is_ok() {
            return Err(Failure::new(
                Kind::NoDevice,
                format!("another daemon has this device ({})", path.display()),
            )
            .help("use that one, or end it first"));
        }
        // A file that nothing answers at was left by a process that was killed.
        let _ = std::fs::remove_file(path);
        let bind = || {
            let listener = StdUnixListener::bind(path)?;
            let file = SocketFile(path.to_owned());
            std::fs::set_permissions(path, std::fs::Permissions::from_mode(0o660))?;
            listener.set_nonblocking(true)?;
            Ok(Self { listener, file })
        };
        bind().map_err(|error| cannot_listen(&path.display().to_string(), &error))
    }
}

impl Server {
    /// Serves a Unix socket with at most this many connections.
    pub(crate) fn accept_unix(
        &mut self,
        socket: UnixSocket,
        router: Router,
        connections: usize,
    ) -> Result<(), Failure> {
        let inside = self.runtime.enter();
        let listener = UnixListener::from_std(socket.listener).map_err(no_runtime)?;
        drop(inside);
        let acceptor = self.acceptor(connections);
        let file = socket.file;
        self.runtime.spawn(async move {
            acceptor.run(router, listener, |_| None).await;
            drop(file);
        });
        Ok(())
    }
}
