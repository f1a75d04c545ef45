//! Checks the `Host` header: a page of another name whose address leads here (DNS rebinding) is
//! refused, and reads nothing.

use std::net::{IpAddr, SocketAddr};

use axum::http::{HeaderMap, HeaderValue, StatusCode, Uri, header};

use crate::problem::Problem;

/// The names under which this server may be spoken to.
#[derive(Debug)]
pub struct Hosts {
    address: SocketAddr,
    /// With the server's own port.
    names: Vec<String>,
    /// With any port: what a proxy in front of this server is called.
    given: Vec<String>,
    remote: bool,
}

impl Hosts {
    /// The names of a server at this address; `given` by the user.
    #[must_use]
    pub fn new(address: SocketAddr, remote: bool, given: &[String]) -> Self {
        let mut names = vec!["localhost".to_owned()];
        if remote {
            let machine = machine();
            let short = machine.split('.').next().unwrap_or_default().to_owned();
            names.extend([format!("{short}.local"), short, machine]);
        }
        let given = given.iter().map(|name| name.to_ascii_lowercase()).collect();
        Self { address, names, given, remote }
    }

    #[must_use]
    pub fn port(&self) -> u16 {
        self.address.port()
    }

    /// What the request believes to speak to, `host:port`.
    pub(super) fn check(&self, uri: &Uri, headers: &HeaderMap) -> Result<String, Problem> {
        let text = |value: &HeaderValue| value.to_str().ok().map(str::to_ascii_lowercase);
        let told = headers.get_all(header::HOST).iter().map(text);
        let mut told: Vec<_> = told.collect();
        told.extend(uri.authority().map(|authority| Some(authority.as_str().to_ascii_lowercase())));
        let first = told.first().cloned().flatten();
        let same = told.iter().all(|host| *host == first);
        first.filter(|host| same && self.is_ours(host)).ok_or_else(|| {
            let detail = "this server is not called that";
            Problem::new(StatusCode::MISDIRECTED_REQUEST, detail)
                .hint("`--web-host NAME` tells under which other name it is reached")
        })
    }

    fn is_ours(&self, host: &str) -> bool {
        let (name, port) = split(host);
        if self.given.iter().any(|given| given == host || given == name) {
            return true;
        }
        let port_is_ours = match port {
            Some(port) => port.parse() == Ok(self.port()),
            None => [80, 443].contains(&self.port()),
        };
        let bare = name.strip_prefix('[').and_then(|name| name.strip_suffix(']')).unwrap_or(name);
        let by_address = bare.parse::<IpAddr>().is_ok_and(|address| {
            // DNS rebinding needs a name, not an address.
            self.remote || address.is_loopback() || address == self.address.ip()
        });
        port_is_ours && (by_address || self.names.iter().any(|known| known == name))
    }
}

/// The name and the port of `name:port`, `[::1]:port` or `name`.
fn split(host: &str) -> (&str, Option<&str>) {
    match host.rsplit_once(':') {
        Some((name, port)) if !port.contains(']') => (name, Some(port)),
        _ => (host, None),
    }
}

/// Whether a page at this host has this origin.
pub(super) fn is_origin_of(origin: &HeaderValue, host: &str, tls: bool) -> bool {
    let origin = origin.to_str().unwrap_or_default().to_ascii_lowercase();
    let secure = origin.strip_prefix("https://");
    // Without TLS here, a proxy in front of this server may have it.
    let plain = origin.strip_prefix("http://").filter(|_| !tls);
    secure.or(plain) == Some(host)
}

/// What this machine calls itself.
pub fn machine() -> String {
    rustix::system::uname().nodename().to_string_lossy().to_ascii_lowercase()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hosts(remote: bool) -> Hosts {
        Hosts::new("127.0.0.1:8080".parse().unwrap(), remote, &["Robot.example".to_owned()])
    }

    #[test]
    fn only_names_that_nobody_else_can_have_are_ours() {
        let hosts = hosts(false);
        for ours in [
            "localhost:8080",
            "127.0.0.1:8080",
            "[::1]:8080",
            "127.1.2.3:8080",
            "robot.example",
            "robot.example:443",
        ] {
            assert!(hosts.is_ours(ours), "{ours}");
        }
        for foreign in [
            "evil.example:8080",
            "localhost",
            "localhost:80",
            "localhost.evil.example:8080",
            "127.0.0.1.evil.example:8080",
            "192.168.0.1:8080",
            "",
            ":8080",
        ] {
            assert!(!hosts.is_ours(foreign), "{foreign}");
        }
    }

    #[test]
    fn from_beyond_this_machine_every_address_is_ours_and_no_other_name() {
        let hosts = hosts(true);
        assert!(hosts.is_ours("192.168.0.1:8080") && hosts.is_ours("[fe80::1]:8080"));
        assert!(!hosts.is_ours("evil.example:8080"));
    }

    #[test]
    fn an_origin_is_compared_as_a_whole() {
        let is = |origin: &'static str, tls| {
            is_origin_of(&HeaderValue::from_static(origin), "localhost:8080", tls)
        };
        assert!(is("http://localhost:8080", false) && is("https://localhost:8080", true));
        assert!(!is("http://localhost:8080", true), "another origin than its own");
        for foreign in
            ["null", "http://localhost", "http://localhost:8080.evil.example", "localhost:8080"]
        {
            assert!(!is(foreign, false), "{foreign}");
        }
    }
}
