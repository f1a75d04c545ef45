//! Options of the web server.

use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::path::PathBuf;
use std::time::Duration;

use clap::Args;
use rtf_plan::suite::parse_duration;

use super::{HistoryFileArgs, ResultsArgs};

const HEADING: &str = "Web";
/// The default address.
const ADDRESS: &str = "127.0.0.1:8080";
/// The port if only an address is given.
const PORT: u16 = 8080;

/// How `rtf run` serves the run in a browser.
#[derive(Debug, Args)]
pub struct WebRunArgs {
    /// Show the run live in a browser, on ADDR:PORT (127.0.0.1:8080) or the next free port
    #[arg(help_heading = HEADING, long, value_name = "ADDR:PORT", value_parser = parse_address)]
    #[arg(num_args = 0..=1, require_equals = true, default_missing_value = ADDRESS)]
    pub web: Option<SocketAddr>,

    /// Keep serving after the run has ended, for this time or until Ctrl-C: `10min`
    #[arg(help_heading = HEADING, long, value_name = "DURATION")]
    #[arg(value_parser = parse_duration)]
    pub web_linger: Option<Duration>,

    #[command(flatten)]
    pub access: WebAccessArgs,
}

impl WebRunArgs {
    /// An option that has no effect because `--web` is missing.
    pub fn option_without_effect(&self) -> Option<&'static str> {
        let access = &self.access;
        let given = [
            ("--web-linger", self.web_linger.is_some()),
            ("--web-token-file", access.web_token_file.is_some()),
            ("--web-allow-remote", access.web_allow_remote),
            ("--web-cert", access.web_cert.is_some()),
            ("--web-host", !access.web_hosts.is_empty()),
        ];
        let given = given.into_iter().find(|(_, given)| *given);
        given.map(|(name, _)| name).filter(|_| self.web.is_none())
    }
}

/// Options of `rtf serve`.
#[derive(Debug, Args)]
pub struct ServeArgs {
    /// Results directory, or the directory of a run in it [default: that of `--results`]
    #[arg(value_name = "DIR")]
    pub dir: Option<PathBuf>,

    #[command(flatten)]
    pub results: ResultsArgs,

    #[command(flatten)]
    pub history: HistoryFileArgs,

    /// Address to listen on; if the port is in use, the next free port
    #[arg(help_heading = HEADING, long, value_name = "ADDR:PORT", default_value = ADDRESS)]
    #[arg(value_parser = parse_address)]
    pub web: SocketAddr,

    /// Show the history as metrics for Prometheus at `/metrics`
    #[arg(help_heading = HEADING, long)]
    pub web_metrics: bool,

    #[command(flatten)]
    pub access: WebAccessArgs,
}

/// How the server authenticates clients.
#[derive(Debug, Default, Args)]
pub struct WebAccessArgs {
    /// Read the access token from a file instead of generating one
    #[arg(help_heading = HEADING, long, value_name = "FILE")]
    pub web_token_file: Option<PathBuf>,

    /// Let other machines connect; requires TLS, and the token even for reading
    #[arg(help_heading = HEADING, long)]
    pub web_allow_remote: bool,

    /// TLS certificate (PEM); by default, rtf generates one if other machines may connect
    #[arg(help_heading = HEADING, long, value_name = "FILE", requires = "web_key")]
    pub web_cert: Option<PathBuf>,

    /// Private key of the TLS certificate (PEM)
    #[arg(help_heading = HEADING, long, value_name = "FILE", requires = "web_cert")]
    pub web_key: Option<PathBuf>,

    /// Additional host name of the server
    #[arg(help_heading = HEADING, long = "web-host", value_name = "NAME")]
    pub web_hosts: Vec<String>,
}

fn parse_address(text: &str) -> Result<SocketAddr, String> {
    let text = text.replace("localhost", "127.0.0.1");
    if let Ok(address) = text.parse() {
        return Ok(address);
    }
    if let Ok(port) = text.strip_prefix(':').unwrap_or(&text).parse::<u16>() {
        return Ok(SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), port));
    }
    let address = text.parse::<IpAddr>().map(|address| SocketAddr::new(address, PORT));
    address.map_err(|_| format!("expected an address and a port, like `{ADDRESS}`"))
}

#[cfg(test)]
mod tests {
    use super::parse_address;

    #[test]
    fn an_address_a_port_or_both() {
        let parsed = |text: &str| parse_address(text).map(|address| address.to_string());
        assert_eq!(parsed("127.0.0.1:9000").as_deref(), Ok("127.0.0.1:9000"));
        assert_eq!(parsed("localhost:0").as_deref(), Ok("127.0.0.1:0"));
        assert_eq!(parsed("9000").as_deref(), Ok("127.0.0.1:9000"));
        assert_eq!(parsed(":9000").as_deref(), Ok("127.0.0.1:9000"));
        assert_eq!(parsed("0.0.0.0").as_deref(), Ok("0.0.0.0:8080"));
        assert_eq!(parsed("[::1]:80").as_deref(), Ok("[::1]:80"));
        for bad in ["", "robot", "127.0.0.1:99999", "1.2.3"] {
            assert!(parsed(bad).is_err(), "{bad}");
        }
    }
}
