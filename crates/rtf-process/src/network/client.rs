//! The runner's side of a network namespace: starts its holder, and opens connections
//! inside.

use std::io;
use std::net::SocketAddr;
use std::os::fd::{AsFd, OwnedFd};
use std::sync::Arc;
use std::time::Duration;

use rustix::net::RecvFlags;
use tokio::io::{AsyncWriteExt, Interest};
use tokio::net::{TcpSocket, TcpStream, UnixStream};
use tokio::sync::Mutex;

use super::holder::{HOLD_ARGUMENT, Hello, MESSAGE_BYTES, OPEN_IPV4, OPEN_IPV6, OPENED};
use crate::descriptor_passing;
use crate::namespaces::Namespaces;
use crate::process::ProcessEnd;
use crate::spawn_request::{SpawnRequest, Streams};
use crate::spawner::Spawner;
use crate::tree;

/// A namespace takes some milliseconds, on a busy machine more.
const START_LIMIT: Duration = Duration::from_secs(20);
/// How long the holder may take to end.
const END_LIMIT: Duration = Duration::from_secs(1);

/// Why a namespace cannot be created.
#[derive(Debug, thiserror::Error)]
pub enum NetworkError {
    /// The system refuses.
    #[error("{0}")]
    Refused(String),
    /// The holder did not start or broke its protocol.
    #[error("the process that is to hold it: {0}")]
    Holder(#[from] io::Error),
}

/// A network namespace. Clones stand for the same one.
#[derive(Clone, Debug)]
pub struct Network {
    namespaces: Arc<Namespaces>,
    holder: Arc<Mutex<UnixStream>>,
}

impl Network {
    pub fn namespaces(&self) -> &Arc<Namespaces> {
        &self.namespaces
    }

    /// Opens a socket inside.
    async fn socket(&self, address: SocketAddr) -> io::Result<TcpSocket> {
        let holder = self.holder.clone();
        let request = if address.is_ipv6() { OPEN_IPV6 } else { OPEN_IPV4 };
        // A separate task: the caller may be dropped between request and reply, and the
        // next caller must not get this reply.
        let reply = tokio::spawn(async move {
            let mut holder = holder.lock().await;
            holder.write_all(&[request]).await?;
            receive(&holder, &mut [0; 1]).await
        });
        let (bytes, received) = reply.await.map_err(io::Error::other)??;
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

async fn receive(channel: &UnixStream, bytes: &mut [u8]) -> io::Result<(Vec<u8>, Vec<OwnedFd>)> {
    let mut receive =
        || Ok(descriptor_passing::receive(channel.as_fd(), bytes, RecvFlags::empty())?);
    let (read, received) = channel.async_io(Interest::READABLE, &mut receive).await?;
    if read == 0 {
        return Err(io::Error::other("the process that holds the suite's network has ended"));
    }
    Ok((bytes[..read].to_vec(), received))
}

/// Connects to `host:port`, in a network namespace if there is one.
///
/// # Errors
/// The connection is refused, or the name cannot be resolved.
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

/// A network namespace with the process that holds it.
#[derive(Debug)]
pub struct HeldNetwork {
    network: Network,
    /// The holder's process.
    pub pid: i32,
    /// Whether it has a user namespace, too.
    pub has_user_namespace: bool,
    end: ProcessEnd,
}

impl HeldNetwork {
    /// Creates the namespace.
    ///
    /// # Errors
    /// The system refuses, or the holder fails.
    pub async fn start(spawner: &Spawner) -> Result<Self, NetworkError> {
        let program = std::env::current_exe()?.to_string_lossy().into_owned();
        let request = SpawnRequest {
            command: vec![program, HOLD_ARGUMENT.to_owned()],
            channel: Some(Vec::new()),
            streams: Streams::None,
            ..SpawnRequest::default()
        };
        let process = spawner.spawn(request).await?;
        let channel = process.channel.ok_or_else(|| io::Error::other("it has no channel"))?;
        let mut bytes = vec![0; MESSAGE_BYTES];
        let hello = tokio::time::timeout(START_LIMIT, receive(&channel, &mut bytes)).await;
        let (bytes, received) = hello.map_err(io::Error::other)??;
        let hello: Hello = serde_json::from_slice(&bytes).map_err(io::Error::other)?;
        if let Some(refused) = hello.refused {
            return Err(NetworkError::Refused(refused));
        }
        let namespaces =
            Namespaces::new(received).ok_or_else(|| io::Error::other("it passed no namespace"))?;
        let (namespaces, holder) = (Arc::new(namespaces), Arc::new(Mutex::new(channel)));
        Ok(Self {
            network: Network { namespaces, holder },
            pid: process.pid,
            has_user_namespace: hello.has_user_namespace,
            end: process.end,
        })
    }

    pub fn network(&self) -> &Network {
        &self.network
    }

    /// Ends the holder. The namespace ends with the last process in it.
    pub async fn end(mut self) {
        let _ = self.network.holder.lock().await.shutdown().await;
        if tokio::time::timeout(END_LIMIT, self.end.wait()).await.is_err() {
            tree::kill_tree(self.pid);
            let _ = self.end.wait().await;
        }
    }
}
