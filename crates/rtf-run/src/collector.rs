//! A collector of OpenTelemetry, which gets the trace of a run after the run has ended. Nothing here
//! changes the verdict or the exit code of a run.

use std::io;
use std::sync::Arc;
use std::time::Duration;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use percent_encoding::percent_decode_str;
use rtf_model::Record;
use rtf_report::otlp;
use serde_json::Value;
use ureq::http::{HeaderMap, HeaderName, HeaderValue, header};
use ureq::tls::{Certificate, RootCerts, TlsConfig};
use url::Url;

use crate::error::Failure;
use crate::terminal;

/// How long the end of a run may be delayed.
const LIMIT: Duration = Duration::from_secs(3);

/// The variable with further headers, as OpenTelemetry specifies it.
const HEADERS: &str = "OTEL_EXPORTER_OTLP_HEADERS";

/// The most that is read of an answer.
const ANSWER_LIMIT: u64 = 64 << 10;

/// A collector. Its address contains no password, and is printed; its headers are not.
#[derive(Clone)]
pub struct Collector {
    address: Url,
    headers: HeaderMap,
}

impl Collector {
    /// Resolves an address, and the headers in the environment.
    pub fn resolve(address: &str) -> Result<Self, Failure> {
        let headers = match std::env::var(HEADERS) {
            Ok(text) => parse_headers(&text),
            Err(std::env::VarError::NotPresent) => Some(HeaderMap::new()),
            Err(_) => None,
        };
        let headers = headers.ok_or_else(|| {
            let error = format!("`{HEADERS}` is not a list of headers");
            Failure::input(error)
                .hint("write `NAME=VALUE,NAME=VALUE`, with values in percent-encoding")
        })?;
        Self::new(address, headers).map_err(|error| {
            // The address may contain a password.
            let hint = format!("write `otlp=http://HOST:4318`; keys belong in `{HEADERS}`");
            Failure::input(format!("the address of the collector {error}")).hint(hint)
        })
    }

    fn new(address: &str, mut headers: HeaderMap) -> Result<Self, &'static str> {
        let mut address = Url::parse(address).map_err(|_| "is invalid")?;
        if !matches!(address.scheme(), "http" | "https") {
            return Err("is neither `http://` nor `https://`");
        }
        if address.query().is_some() || address.fragment().is_some() {
            return Err("has a query or a fragment");
        }
        if let Some(credentials) = basic_credentials(&address) {
            headers.entry(header::AUTHORIZATION).or_insert(credentials);
        }
        // These fail only for addresses without a host.
        let _ = address.set_username("");
        let _ = address.set_password(None);
        let path = address.path().trim_end_matches('/');
        if !path.ends_with("/v1/traces") {
            address.set_path(&format!("{path}/v1/traces"));
        }
        headers.insert(header::CONTENT_TYPE, HeaderValue::from_static("application/json"));
        Ok(Self { address, headers })
    }

    /// Sends the trace of a run that has ended. Prints one warning if that fails.
    pub fn push(&self, record: &Record) {
        if let Err(reason) = self.send(record) {
            terminal::notice(format!(
                "warning: the trace was not sent to `{}`: {reason} (`rtf report --format otlp` writes it to a file)",
                self.address
            ));
        }
    }

    fn send(&self, record: &Record) -> Result<(), String> {
        let mut trace = Vec::new();
        otlp::write(&mut trace, record).map_err(|error| error.to_string())?;
        let mut config = ureq::Agent::config_builder()
            .timeout_global(Some(LIMIT))
            .max_redirects(0)
            .http_status_as_error(false);
        if self.address.scheme() == "https" {
            config = config.tls_config(tls());
        }
        let agent: ureq::Agent = config.build().into();
        let mut request = agent.post(self.address.as_str());
        if let Some(headers) = request.headers_mut() {
            headers.extend(self.headers.clone());
        }
        let mut answer = request.send(&trace).map_err(|error| explain(&error))?;
        if !answer.status().is_success() {
            return Err(format!("it answered with {}", answer.status()));
        }
        let body = answer.body_mut().with_config().limit(ANSWER_LIMIT).read_to_vec();
        rejection(&body.unwrap_or_default()).map_or(Ok(()), Err)
    }
}

/// Why it could not be sent, without addresses.
fn explain(error: &ureq::Error) -> String {
    match error {
        ureq::Error::Timeout(_) => format!("no answer within {} s", LIMIT.as_secs()),
        ureq::Error::Io(error) if error.kind() == io::ErrorKind::ConnectionRefused => {
            "connection refused".to_owned()
        }
        ureq::Error::BadUri(_) => "the address is invalid".to_owned(),
        error => error.to_string(),
    }
}

/// What a collector that accepted the request says about rejected spans.
fn rejection(answer: &[u8]) -> Option<String> {
    let answer: Value = serde_json::from_slice(answer).ok()?;
    let partial = answer.get("partialSuccess")?;
    // A 64-bit number is a string in JSON.
    let rejected = match partial.get("rejectedSpans")? {
        Value::String(text) => text.parse().ok()?,
        number => number.as_u64()?,
    };
    (rejected > 0).then(|| format!("it rejected {}", rtf_report::format_count(rejected, "span")))
}

fn basic_credentials(address: &Url) -> Option<HeaderValue> {
    if address.username().is_empty() && address.password().is_none() {
        return None;
    }
    let mut credentials: Vec<u8> = percent_decode_str(address.username()).collect();
    credentials.push(b':');
    credentials.extend(percent_decode_str(address.password().unwrap_or_default()));
    let text = format!("Basic {}", BASE64_STANDARD.encode(credentials));
    HeaderValue::try_from(text).ok()
}

/// Parses `NAME=VALUE,NAME=VALUE`; values are percent-encoded.
fn parse_headers(text: &str) -> Option<HeaderMap> {
    let pairs = text.split(',').filter(|pair| !pair.trim().is_empty());
    let header = |pair: &str| {
        let (name, value) = pair.split_once('=')?;
        let value: Vec<u8> = percent_decode_str(value.trim()).collect();
        let mut value = HeaderValue::from_bytes(&value).ok()?;
        value.set_sensitive(true);
        Some((HeaderName::try_from(name.trim()).ok()?, value))
    };
    pairs.map(header).collect()
}

/// TLS with the certificate authorities of the system.
fn tls() -> TlsConfig {
    let found = rustls_native_certs::load_native_certs();
    let roots: Vec<_> =
        found.certs.iter().map(|found| Certificate::from_der(found).to_owned()).collect();
    TlsConfig::builder()
        .unversioned_rustls_crypto_provider(Arc::new(rustls::crypto::ring::default_provider()))
        .root_certs(RootCerts::Specific(Arc::new(roots)))
        .build()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn address(text: &str) -> Result<String, &'static str> {
        Collector::new(text, HeaderMap::new()).map(|collector| collector.address.to_string())
    }

    #[test]
    fn the_path_of_traces_is_added_once() {
        let expect = |text, expected: &str| assert_eq!(address(text).as_deref(), Ok(expected));
        expect("http://localhost:4318", "http://localhost:4318/v1/traces");
        expect("https://example.org/otlp/", "https://example.org/otlp/v1/traces");
        expect("http://localhost:4318/v1/traces", "http://localhost:4318/v1/traces");
    }

    #[test]
    fn only_addresses_that_can_be_printed_are_accepted() {
        assert_eq!(address("http://localhost/?key=secret"), Err("has a query or a fragment"));
        assert_eq!(address("grpc://localhost"), Err("is neither `http://` nor `https://`"));
        assert_eq!(address("http://"), Err("is invalid"));
    }

    #[test]
    fn a_password_becomes_a_header() {
        let collector = Collector::new("http://me:p%40ss@localhost", HeaderMap::new()).unwrap();
        assert_eq!(collector.address.as_str(), "http://localhost/v1/traces");
        // me:p@ss
        assert_eq!(collector.headers[header::AUTHORIZATION], "Basic bWU6cEBzcw==");
        let given = parse_headers("authorization=Bearer%20key").unwrap();
        let collector = Collector::new("http://me:pass@localhost", given).unwrap();
        assert_eq!(collector.headers[header::AUTHORIZATION], "Bearer key");
    }

    #[test]
    fn headers_are_those_of_the_specification() {
        let headers = parse_headers("api-key=a%2Cb, other = c=d ,").unwrap();
        assert_eq!(
            (headers["api-key"].as_bytes(), headers["other"].as_bytes()),
            (&b"a,b"[..], &b"c=d"[..])
        );
        assert!(parse_headers("api-key").is_none());
        assert!(parse_headers("api key=a").is_none());
        assert!(parse_headers("key=a%0Ab").is_none());
        assert!(parse_headers("").is_some_and(|headers| headers.is_empty()));
    }

    #[test]
    fn rejected_spans_are_counted() {
        let rejection = |answer: &str| rejection(answer.as_bytes());
        assert_eq!(rejection("{}"), None);
        assert_eq!(rejection(r#"{"partialSuccess":{}}"#), None);
        assert_eq!(
            rejection(r#"{"partialSuccess":{"rejectedSpans":"2"}}"#),
            Some("it rejected 2 spans".to_owned())
        );
    }
}
