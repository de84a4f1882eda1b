//! TLS of the daemon's TCP connections, by rustls.

use std::path::Path;
use std::sync::Arc;

use engine::config::daemon::{DaemonConfig, warn_if_exposed};
use engine::failure::{Failure, Kind};
use tokio_rustls::TlsAcceptor;
use tokio_rustls::rustls::ServerConfig;
use tokio_rustls::rustls::crypto::ring;
use tokio_rustls::rustls::pki_types::pem::PemObject;
use tokio_rustls::rustls::pki_types::{CertificateDer, PrivateKeyDer};

/// TLS acceptor of connections with the configured certificate; `None` without one.
///
/// # Errors
/// [`Kind::Usage`] for a certificate without a key or the reverse, [`Kind::BadInput`] for unusable
/// files.
pub fn acceptor(config: &DaemonConfig) -> Result<Option<TlsAcceptor>, Failure> {
    let (certificate, key) = match (&config.certificate, &config.certificate_key) {
        (None, None) => return Ok(None),
        (Some(certificate), Some(key)) => (certificate, key),
        (Some(_), None) => return Err(half("certificate without certificate_key")),
        (None, Some(_)) => return Err(half("certificate_key without certificate")),
    };
    warn_if_exposed("private key", key);
    let chain = CertificateDer::pem_file_iter(certificate)
        .and_then(Iterator::collect::<Result<Vec<_>, _>>)
        .map_err(|error| unusable("certificate", certificate, &error))?;
    let secret = PrivateKeyDer::from_pem_file(key)
        .map_err(|error| unusable("certificate_key", key, &error))?;
    let server = ServerConfig::builder_with_provider(Arc::new(ring::default_provider()))
        .with_safe_default_protocol_versions()
        .map(|builder| builder.with_no_client_auth())
        .and_then(|builder| builder.with_single_cert(chain, secret));
    let mut server = server.map_err(|error| unusable("certificate", certificate, &error))?;
    server.alpn_protocols = vec![b"http/1.1".to_vec()];
    Ok(Some(TlsAcceptor::from(Arc::new(server))))
}

fn half(what: &str) -> Failure {
    Failure::new(Kind::Usage, format!("[daemon] {what}")).help("TLS needs both, as files in PEM")
}

fn unusable(name: &str, path: &Path, error: &dyn std::fmt::Display) -> Failure {
    Failure::new(
        Kind::BadInput,
        format!("[daemon] {name} = {}: {error}", path.display()),
    )
    .help("expected PEM: the certificate and its chain in one file, their private key in the other")
}
