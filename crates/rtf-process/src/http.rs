//! The HTTP GET of probes: requests the status, in a network namespace if there is one.
//! Plain HTTP only; reads no more than the head of a response.

use std::fmt;
use std::io;

use tokio::io::{AsyncReadExt, AsyncWriteExt};
use url::Url;

use crate::network::{Network, connect};

/// The longest head of a response.
const HEAD_BYTES: usize = 64 * 1024;
/// The number of redirects that are followed.
const REDIRECTS: usize = 5;

/// The status of a response, with the server's phrase.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HttpStatus {
    code: u16,
    phrase: String,
}

impl HttpStatus {
    /// Whether it is 2xx.
    pub fn is_success(&self) -> bool {
        (200..300).contains(&self.code)
    }
}

impl fmt::Display for HttpStatus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.code)?;
        if self.phrase.is_empty() { Ok(()) } else { write!(f, " {}", self.phrase) }
    }
}

/// `host:port` of a URL.
pub fn address(url: &Url) -> Option<String> {
    Some(format!("{}:{}", url.host_str()?, url.port_or_known_default()?))
}

/// Requests a URL and follows redirects.
///
/// # Errors
/// The connection fails, or the response is not HTTP.
pub async fn get(network: Option<&Network>, url: &str) -> io::Result<HttpStatus> {
    let mut url = Url::parse(url).map_err(io::Error::other)?;
    for _ in 0..REDIRECTS {
        let head = head(network, &url).await?;
        let answer = parse(&head).ok_or_else(|| io::Error::other("it does not answer in HTTP"))?;
        match answer {
            (status, Some(location)) if (300..400).contains(&status.code) => {
                url = url.join(&location).map_err(io::Error::other)?;
                if url.scheme() != "http" {
                    return Ok(status);
                }
            }
            (status, _) => return Ok(status),
        }
    }
    Err(io::Error::other(format!("it points elsewhere more than {REDIRECTS} times")))
}

/// Returns the head of a response: all lines before the first empty one.
async fn head(network: Option<&Network>, url: &Url) -> io::Result<String> {
    let server = address(url).ok_or_else(|| io::Error::other("no host"))?;
    let mut stream = connect(network, &server).await?;
    let query = url.query().map_or(String::new(), |query| format!("?{query}"));
    let host = match url.port() {
        Some(_) => server,
        None => url.host_str().unwrap_or_default().to_owned(),
    };
    let request = format!(
        "GET {}{query} HTTP/1.1\r\nHost: {host}\r\nAccept: */*\r\n\
         User-Agent: rtf\r\nConnection: close\r\n\r\n",
        url.path()
    );
    stream.write_all(request.as_bytes()).await?;
    let mut head = Vec::new();
    while !head.windows(4).any(|bytes| bytes == b"\r\n\r\n") && head.len() < HEAD_BYTES {
        if stream.read_buf(&mut head).await? == 0 {
            break;
        }
    }
    Ok(String::from_utf8_lossy(&head).into_owned())
}

/// Parses the status and the `Location` of a redirect.
fn parse(head: &str) -> Option<(HttpStatus, Option<String>)> {
    let mut lines = head.lines();
    let (version, rest) = lines.next()?.split_once(' ')?;
    if !version.starts_with("HTTP/1.") {
        return None;
    }
    let (code, phrase) = rest.split_once(' ').unwrap_or((rest, ""));
    let code = code.parse().ok().filter(|code| (100..1000).contains(code))?;
    let fields = lines.take_while(|line| !line.is_empty());
    let location = fields
        .filter_map(|line| line.split_once(':'))
        .find(|(name, _)| name.eq_ignore_ascii_case("location"))
        .map(|(_, value)| value.trim().to_owned());
    Some((HttpStatus { code, phrase: phrase.trim().to_owned() }, location))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::{Read as _, Write as _};
    use std::net::TcpListener;

    #[test]
    fn heads_are_read() {
        let shown = |head| parse(head).map(|(status, at)| (status.to_string(), at));
        assert_eq!(shown("HTTP/1.1 200 OK\r\n\r\nbody"), Some(("200 OK".into(), None)));
        assert_eq!(shown("HTTP/1.0 204\r\n"), Some(("204".into(), None)));
        let moved = "HTTP/1.1 302 Found\r\nLOCATION:  /there \r\n\r\nLocation: /not";
        assert_eq!(shown(moved), Some(("302 Found".into(), Some("/there".into()))));
        for none in ["", "SSH-2.0-OpenSSH", "HTTP/1.1 abc", "HTTP/1.1 7 x"] {
            assert_eq!(shown(none), None, "{none}");
        }
    }

    /// Sends these responses, one per connection.
    fn server(answers: &'static [&'static str]) -> (u16, std::thread::JoinHandle<Vec<String>>) {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let port = listener.local_addr().unwrap().port();
        let thread = std::thread::spawn(move || {
            let mut asked = Vec::new();
            for answer in answers {
                let (mut stream, _) = listener.accept().unwrap();
                let mut bytes = [0; 1024];
                let read = stream.read(&mut bytes).unwrap();
                let text = String::from_utf8_lossy(&bytes[..read]).into_owned();
                asked.push(text.lines().next().unwrap().to_owned());
                stream.write_all(answer.as_bytes()).unwrap();
            }
            asked
        });
        (port, thread)
    }

    #[test]
    fn a_redirect_is_followed() {
        let (port, thread) = server(&[
            "HTTP/1.1 301 Moved\r\nLocation: /new?b=1\r\n\r\n",
            "HTTP/1.1 503 Service Unavailable\r\n\r\n",
        ]);
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
        let status = runtime.block_on(get(None, &format!("http://127.0.0.1:{port}/old"))).unwrap();
        assert_eq!(status.to_string(), "503 Service Unavailable");
        assert!(!status.is_success());
        assert_eq!(thread.join().unwrap(), ["GET /old HTTP/1.1", "GET /new?b=1 HTTP/1.1"]);
    }
}
