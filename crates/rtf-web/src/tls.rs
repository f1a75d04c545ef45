//! TLS: with a certificate that is given, or one that this server signs itself.

use std::net::IpAddr;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use axum_server::tls_rustls::RustlsConfig;
use rustls::ServerConfig;
use rustls::pki_types::pem::PemObject;
use rustls::pki_types::{CertificateDer, PrivateKeyDer};
use sha2::{Digest, Sha256};

#[derive(Debug, thiserror::Error)]
pub enum TlsError {
    /// A file cannot be read, or is not PEM.
    #[error("cannot read {what} from `{}`", path.display())]
    Read {
        /// What it should hold.
        what: &'static str,
        path: PathBuf,
        #[source]
        source: rustls::pki_types::pem::Error,
    },
    #[error("the certificate and the key cannot be used")]
    Unusable(#[source] rustls::Error),
    #[error("cannot make a certificate")]
    Make(#[source] rcgen::Error),
}

#[derive(Debug)]
pub struct Tls {
    /// For the listener.
    pub config: RustlsConfig,
    /// The SHA-256 of the certificate that this server signed itself.
    pub fingerprint: Option<String>,
}

/// A certificate and its key from PEM files.
///
/// # Errors
/// They cannot be read or used.
pub fn given(certificate: &Path, key: &Path) -> Result<Tls, TlsError> {
    let failed = |what, path: &Path| {
        let path = path.to_owned();
        move |source| TlsError::Read { what, path, source }
    };
    let chain = CertificateDer::pem_file_iter(certificate).and_then(Iterator::collect);
    let chain: Vec<_> = chain.map_err(failed("a certificate", certificate))?;
    let key = PrivateKeyDer::from_pem_file(key).map_err(failed("a private key", key))?;
    Ok(Tls { config: config(chain, key)?, fingerprint: None })
}

/// A new certificate for this machine, signed by itself.
///
/// # Errors
/// It cannot be made.
pub fn self_signed(address: IpAddr, names: &[String]) -> Result<Tls, TlsError> {
    let known = ["localhost", "127.0.0.1", "::1"].map(str::to_owned);
    let mut subjects: Vec<_> = known.into_iter().chain(names.iter().cloned()).collect();
    if !address.is_unspecified() {
        subjects.push(address.to_string());
    }
    subjects.sort();
    subjects.dedup();
    let made = rcgen::generate_simple_self_signed(subjects).map_err(TlsError::Make)?;
    let certificate = made.cert.der().clone();
    let digest = Sha256::digest(&certificate);
    let bytes: Vec<_> = digest.iter().map(|byte| format!("{byte:02X}")).collect();
    let key = PrivateKeyDer::Pkcs8(made.signing_key.serialize_der().into());
    Ok(Tls { config: config(vec![certificate], key)?, fingerprint: Some(bytes.join(":")) })
}

fn config(
    chain: Vec<CertificateDer<'static>>,
    key: PrivateKeyDer<'static>,
) -> Result<RustlsConfig, TlsError> {
    // Named here, so that it does not matter what else of the program uses TLS.
    let provider = Arc::new(rustls::crypto::ring::default_provider());
    let builder =
        ServerConfig::builder_with_provider(provider).with_safe_default_protocol_versions();
    let builder = builder.map_err(TlsError::Unusable)?.with_no_client_auth();
    let mut config = builder.with_single_cert(chain, key).map_err(TlsError::Unusable)?;
    config.alpn_protocols = vec![b"h2".to_vec(), b"http/1.1".to_vec()];
    Ok(RustlsConfig::from_config(Arc::new(config)))
}
