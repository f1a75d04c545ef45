//! TLS, and the rules for those beyond this machine; tried on loopback.

use std::io::Write;
use std::net::TcpStream;
use std::sync::Arc;

use rtf_web::Settings;
use rustls::pki_types::pem::PemObject;
use rustls::pki_types::{CertificateDer, ServerName};
use rustls::{ClientConfig, ClientConnection, RootCertStore, StreamOwned};

use crate::client::Answer;
use crate::world::{World, settings};

/// A server with a given certificate, and a client that trusts only that.
fn world() -> (World, crate::world::Writer, Arc<ClientConfig>) {
    let temp = tempfile::tempdir().unwrap();
    let made = rcgen::generate_simple_self_signed(["localhost".to_owned()]).unwrap();
    let (certificate, key) = (temp.path().join("cert.pem"), temp.path().join("key.pem"));
    std::fs::write(&certificate, made.cert.pem()).unwrap();
    std::fs::write(&key, made.signing_key.serialize_pem()).unwrap();
    let mut roots = RootCertStore::empty();
    roots.add(CertificateDer::from_pem_file(&certificate).unwrap()).unwrap();
    let provider = Arc::new(rustls::crypto::ring::default_provider());
    let config =
        ClientConfig::builder_with_provider(provider).with_safe_default_protocol_versions();
    let config = config.unwrap().with_root_certificates(roots).with_no_client_auth();
    let tls = Some((certificate, key));
    let (world, run) = World::with(&Settings { allow_remote: true, tls, ..settings() });
    (world, run, Arc::new(config))
}

fn ask(world: &World, config: &Arc<ClientConfig>, first: &str, more: &str) -> Answer {
    let name = ServerName::try_from("localhost").unwrap();
    let connection = ClientConnection::new(config.clone(), name).unwrap();
    let stream = TcpStream::connect(world.address()).unwrap();
    let mut stream = StreamOwned::new(connection, stream);
    let host = format!("localhost:{}", world.address().port());
    write!(stream, "{first} HTTP/1.0\r\nHost: {host}\r\n{more}\r\n").unwrap();
    Answer::read(stream)
}

#[test]
fn from_beyond_this_machine_reading_needs_the_token_too() {
    let (world, mut run, config) = world();
    run.plan("arm", &["first"]);
    run.flush();
    assert!(world.server.url().starts_with("https://127.0.0.1:"));
    let bearer = format!("Authorization: Bearer {}\r\n", world.token());
    for path in ["/api/v1/runs", "/api/v1/runs/own/journal", "/status", "/update"] {
        let first = format!("GET {path}");
        assert_eq!(ask(&world, &config, &first, "").status, 401, "{path}");
        assert_eq!(ask(&world, &config, &first, &bearer).status, 200, "{path}");
    }
    for path in [
        "/api/v1/runs/own/files/attachments/openapi.json",
        "/api/v1/runs/openapi.json",
        "/api/v1/nowhere/openapi.json",
    ] {
        let first = format!("GET {path}");
        assert_eq!(ask(&world, &config, &first, "").status, 401, "{path}");
        assert_eq!(ask(&world, &config, &first, &bearer).status, 404, "{path}");
    }
    assert_eq!(ask(&world, &config, "GET /api/v1/openapi.json", "").status, 200);
    let server = ask(&world, &config, "GET /api/v1", "").json();
    assert_eq!((&server["token_to_read"], server.get("current")), (&true.into(), None));
    let page = ask(&world, &config, "GET /", "");
    assert_eq!(page.status, 200, "the page holds no data, and asks for the token");
    let body = format!("{{\"token\":\"{}\"}}", world.token());
    let length = format!("Content-Type: application/json\r\nContent-Length: {}\r\n", body.len());
    let session = ask(&world, &config, "POST /api/v1/session", &format!("{length}\r\n{body}"));
    assert_eq!(session.status, 204);
    assert!(session.header("set-cookie").unwrap().contains("; Secure"), "{}", session.head);
}

#[test]
fn a_certificate_is_made_when_there_is_none() {
    let (world, _run) = World::with(&Settings { allow_remote: true, ..settings() });
    let fingerprint = world.server.fingerprint.as_ref().expect("a fingerprint");
    assert_eq!(fingerprint.len(), 32 * 3 - 1, "{fingerprint}");
    let mut plain = TcpStream::connect(world.address()).unwrap();
    plain.write_all(b"GET /api/v1 HTTP/1.0\r\nHost: localhost\r\n\r\n").unwrap();
    let mut answer = Vec::new();
    // Whatever comes, it is no HTTP: a reset is as good as an alert.
    let _ = std::io::Read::read_to_end(&mut plain, &mut answer);
    assert!(!answer.starts_with(b"HTTP"), "{answer:?}");
}

#[test]
fn a_certificate_that_is_none_is_told_before_anything_starts() {
    let temp = tempfile::tempdir().unwrap();
    let path = temp.path().join("cert.pem");
    std::fs::write(&path, "not a certificate").unwrap();
    let tls = Some((path.clone(), path));
    let error = rtf_web::BoundServer::new(&Settings { tls, ..settings() }).expect_err("an error");
    let text = format!("{error}: {:?}", std::error::Error::source(&error));
    assert!(text.contains("cert.pem") || text.contains("cannot be used"), "{text}");
}
