//! The runner's side of a network namespace: how processes get into it and how
//! the runner itself asks inside.

use std::io;
use std::net::SocketAddr;
use std::os::fd::AsFd;
use std::sync::Arc;
use std::time::Duration;

use rtf_model::SuiteNetwork;
use tokio::io::{AsyncWriteExt, Interest};
use tokio::net::{TcpSocket, TcpStream, UnixStream};
use tokio::sync::Mutex;

use super::holder::{FOUR, Hello, MESSAGE_BYTES, OPENED, SIX};
use super::{HOLD, Namespaces, pass};
use crate::host::spawner::{End, SpawnRequest, Spawner, Streams};
use crate::host::tree;

/// How long a namespace may take; it takes some milliseconds.
const START_LIMIT: Duration = Duration::from_secs(20);
/// How long the holder may take to end once it is not needed.
const END_LIMIT: Duration = Duration::from_secs(1);

/// Why there is no namespace.
#[derive(Debug, thiserror::Error)]
pub enum NetworkError {
    /// The system does not give it.
    #[error("{0}")]
    Refused(String),
    /// The process that is to hold it did not do its work.
    #[error("the process that is to hold it: {0}")]
    Holder(#[from] io::Error),
}

/// A network namespace. Clones stand for the same one.
#[derive(Clone, Debug)]
pub struct Network {
    namespaces: Arc<Namespaces>,
    holder: Arc<Mutex<UnixStream>>,
}

impl PartialEq for Network {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.namespaces, &other.namespaces)
    }
}

impl Eq for Network {}

impl Network {
    /// Its namespaces.
    #[must_use]
    pub fn namespaces(&self) -> &Arc<Namespaces> {
        &self.namespaces
    }

    /// A socket that was opened inside.
    async fn socket(&self, address: SocketAddr) -> io::Result<TcpSocket> {
        let holder = self.holder.clone();
        let asked = if address.is_ipv6() { SIX } else { FOUR };
        // A task of its own: who asks may be dropped between question and
        // answer, and the next one must not get this answer.
        let answer = tokio::spawn(async move {
            let mut holder = holder.lock().await;
            holder.write_all(&[asked]).await?;
            receive(&holder, &mut [0; 1]).await
        });
        let (bytes, received) = answer.await.map_err(io::Error::other)??;
        match received.into_iter().next() {
            Some(socket) if bytes == [OPENED] => {
                let socket = std::net::TcpStream::from(socket);
                socket.set_nonblocking(true)?;
                Ok(TcpSocket::from_std_stream(socket))
            }
            _ => Err(io::Error::other("no socket in the suite's network")),
        }
    }
}

async fn receive(
    channel: &UnixStream,
    bytes: &mut [u8],
) -> io::Result<(Vec<u8>, Vec<std::os::fd::OwnedFd>)> {
    let mut take = || pass::receive(channel.as_fd(), bytes);
    let (read, received) = channel.async_io(Interest::READABLE, &mut take).await?;
    if read == 0 {
        return Err(io::Error::other("the process that holds the suite's network is gone"));
    }
    Ok((bytes[..read].to_vec(), received))
}

/// Connects to `host:port`, in a network of its own if there is one.
///
/// # Errors
/// Nobody answers there.
pub async fn connect(network: Option<&Network>, address: &str) -> io::Result<TcpStream> {
    let Some(network) = network else { return TcpStream::connect(address).await };
    let mut problem = io::Error::other("the name means no address");
    for address in tokio::net::lookup_host(address).await? {
        match network.socket(address).await?.connect(address).await {
            Ok(stream) => return Ok(stream),
            Err(error) => problem = error,
        }
    }
    Err(problem)
}

/// The process that holds a namespace.
#[derive(Debug)]
pub struct Holder {
    network: Network,
    told: SuiteNetwork,
    end: End,
}

impl Holder {
    /// Starts it.
    pub async fn start(spawner: &Spawner) -> Result<Self, NetworkError> {
        let program = std::env::current_exe()?.to_string_lossy().into_owned();
        let request = SpawnRequest {
            command: vec![program, HOLD.to_owned()],
            channel: Some(Vec::new()),
            streams: Streams::None,
            ..SpawnRequest::default()
        };
        let process = spawner.spawn(request).await?;
        let gone = || io::Error::other("it has no channel");
        let channel = process.channel.ok_or_else(gone)?;
        let mut bytes = vec![0; MESSAGE_BYTES];
        let hello = tokio::time::timeout(START_LIMIT, receive(&channel, &mut bytes)).await;
        let (bytes, received) = hello.map_err(io::Error::other)??;
        let hello: Hello = serde_json::from_slice(&bytes).map_err(io::Error::other)?;
        if let Some(refused) = hello.refused {
            return Err(NetworkError::Refused(refused));
        }
        let namespaces =
            Namespaces::new(received).ok_or_else(|| io::Error::other("it passed no namespace"))?;
        let holder = Arc::new(Mutex::new(channel));
        Ok(Self {
            network: Network { namespaces: Arc::new(namespaces), holder },
            told: SuiteNetwork { pid: process.pid, user_namespace: hello.user },
            end: process.end,
        })
    }

    /// The namespace.
    pub fn network(&self) -> Network {
        self.network.clone()
    }

    /// What reports tell of it.
    pub fn told(&self) -> SuiteNetwork {
        self.told
    }

    /// Ends it. The namespace is gone with the last process in it.
    pub async fn end(mut self) {
        let _ = self.network.holder.lock().await.shutdown().await;
        if tokio::time::timeout(END_LIMIT, self.end.wait()).await.is_err() {
            tree::kill_tree(self.told.pid);
            let _ = self.end.wait().await;
        }
    }
}
