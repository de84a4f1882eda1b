//! TLS of the daemon, with a certificate that was made for these tests:
//!
//! ```sh
//! openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -days 36500 \
//!   -subj /CN=localhost -addext subjectAltName=DNS:localhost,IP:127.0.0.1 \
//!   -addext basicConstraints=critical,CA:FALSE -keyout key.pem -out certificate.pem
//! ```

use std::io::{Read, Write};
use std::net::TcpStream;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use daemon::Options;
use engine::failure::Kind;
use tokio_rustls::rustls::crypto::ring;
use tokio_rustls::rustls::pki_types::CertificateDer;
use tokio_rustls::rustls::pki_types::pem::PemObject;
use tokio_rustls::rustls::{ClientConfig, ClientConnection, RootCertStore, StreamOwned};

use super::rig::{Rig, raw};

const TOKEN: &str = "0123456789abcdef-secret";

fn file(name: &str) -> PathBuf {
    let folder = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../tests/realtime/daemon/tls"
    );
    Path::new(folder).join(name)
}

fn keys() -> String {
    format!(
        "certificate = '{}'\ncertificate_key = '{}'\n",
        file("certificate.pem").display(),
        file("key.pem").display()
    )
}

/// Sends a request over TLS, trusting only the certificate of the tests.
fn request(rig: &Rig, text: &str) -> String {
    let mut roots = RootCertStore::empty();
    let own = CertificateDer::from_pem_file(file("certificate.pem")).unwrap();
    roots.add(own).unwrap();
    let client = ClientConfig::builder_with_provider(Arc::new(ring::default_provider()))
        .with_safe_default_protocol_versions()
        .unwrap()
        .with_root_certificates(roots)
        .with_no_client_auth();
    let name = "localhost".try_into().unwrap();
    let connection = ClientConnection::new(Arc::new(client), name).unwrap();
    let tcp = TcpStream::connect(rig.address).unwrap();
    let mut stream = StreamOwned::new(connection, tcp);
    stream.write_all(text.as_bytes()).unwrap();
    let mut answer = Vec::new();
    stream.read_to_end(&mut answer).unwrap();
    String::from_utf8_lossy(&answer).into_owned()
}

#[test]
fn tls_serves_the_page_and_its_cookie_is_secure() {
    let rig = Rig::with(&format!("{}token = '{TOKEN}'\n", keys()), |_| {});
    let host = format!(
        "host: localhost:{}\r\nconnection: close\r\n",
        rig.address.port()
    );
    let status =
        format!("GET /api/v1/status HTTP/1.1\r\n{host}authorization: Bearer {TOKEN}\r\n\r\n");
    assert!(request(&rig, &status).starts_with("HTTP/1.1 200"));
    let sign_in = |origin: &str| {
        let origin = match origin {
            "" => String::new(),
            origin => format!("origin: {origin}\r\n"),
        };
        let body = format!("{{\"token\": \"{TOKEN}\"}}");
        let text = format!(
            "POST /login HTTP/1.1\r\n{host}{origin}content-type: application/json\r\ncontent-length: {}\r\n\r\n{body}",
            body.len()
        );
        request(&rig, &text)
    };
    let answer = sign_in(&format!("https://localhost:{}", rig.address.port()));
    assert!(answer.starts_with("HTTP/1.1 204"), "{answer}");
    assert!(answer.contains("; Secure"), "{answer}");
    // A client that names no origin came over TLS, too.
    let answer = sign_in("");
    assert!(answer.contains("; Secure"), "{answer}");
    // The same name without TLS is another server's page.
    let answer = sign_in(&format!("http://localhost:{}", rig.address.port()));
    assert!(answer.starts_with("HTTP/1.1 403"), "{answer}");
    // A client without TLS gets nothing.
    let plain = raw(rig.address, status.as_bytes());
    assert_eq!(plain.status, 0, "{plain:?}");
}

#[test]
fn unusable_certificates_are_refused_at_the_start() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("empty.pem"), "").unwrap();
    std::fs::copy(file("key.pem"), path("key.pem")).unwrap();
    std::fs::set_permissions(path("key.pem"), std::fs::Permissions::from_mode(0o600)).unwrap();
    let certificate = file("certificate.pem");
    for (certificate, key, kind) in [
        (Some(certificate.clone()), None, Kind::Usage),
        (None, Some(path("key.pem")), Kind::Usage),
        (
            Some(path("absent.pem")),
            Some(path("key.pem")),
            Kind::BadInput,
        ),
        (
            Some(path("empty.pem")),
            Some(path("key.pem")),
            Kind::BadInput,
        ),
        (
            Some(certificate.clone()),
            Some(path("empty.pem")),
            Kind::BadInput,
        ),
        (Some(path("key.pem")), Some(path("key.pem")), Kind::BadInput),
    ] {
        let mut options = Options {
            listen: Some("127.0.0.1:0".parse().unwrap()),
            runtime: Some(folder.path().to_owned()),
            ..Options::default()
        };
        options.device = Some("sim".to_owned());
        options.config.daemon.scans = Some(path("scans"));
        options.config.daemon.certificate.clone_from(&certificate);
        options.config.daemon.certificate_key = key;
        let refused = daemon::Daemon::start(options).map(drop).unwrap_err();
        assert_eq!(refused.kind, kind, "{certificate:?}: {refused}");
        assert!(refused.help.is_some_and(|help| help.contains("PEM")));
    }
}
