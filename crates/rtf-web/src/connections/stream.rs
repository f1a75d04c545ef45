//! A connection that ends when nothing moves on it for too long.

use std::io;
use std::pin::Pin;
use std::task::{Context, Poll, ready};
use std::time::Duration;

use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::TcpStream;
use tokio::time::{Instant, Sleep, sleep_until};

use super::Limits;
use super::budget::ConnectionSlot;

/// A connection within its limits. The first bytes are expected within the time
/// for a head; after that, something has to be sent or received now and then.
#[derive(Debug)]
pub struct Limited {
    stream: TcpStream,
    /// Given back with the connection.
    _place: ConnectionSlot,
    idle: Duration,
    /// When the connection ends if nothing moves until then.
    due: Instant,
    timer: Pin<Box<Sleep>>,
}

impl Limited {
    #[must_use]
    pub fn new(stream: TcpStream, place: ConnectionSlot, limits: &Limits) -> Self {
        let due = Instant::now() + limits.head;
        let timer = Box::pin(sleep_until(due));
        Self { stream, _place: place, idle: limits.idle, due, timer }
    }

    /// A call that was ready made progress; one that was not may be late.
    fn within_limits<T>(
        &mut self,
        context: &mut Context<'_>,
        result: Poll<io::Result<T>>,
    ) -> Poll<io::Result<T>> {
        if result.is_ready() {
            self.due = Instant::now() + self.idle;
            return result;
        }
        loop {
            ready!(self.timer.as_mut().poll(context));
            if self.due <= Instant::now() {
                return Poll::Ready(Err(io::ErrorKind::TimedOut.into()));
            }
            let due = self.due;
            self.timer.as_mut().reset(due);
        }
    }
}

impl AsyncRead for Limited {
    fn poll_read(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        let result = Pin::new(&mut self.stream).poll_read(context, buffer);
        self.within_limits(context, result)
    }
}

impl AsyncWrite for Limited {
    fn poll_write(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<io::Result<usize>> {
        let result = Pin::new(&mut self.stream).poll_write(context, bytes);
        self.within_limits(context, result)
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        parts: &[io::IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        let result = Pin::new(&mut self.stream).poll_write_vectored(context, parts);
        self.within_limits(context, result)
    }

    fn is_write_vectored(&self) -> bool {
        self.stream.is_write_vectored()
    }

    fn poll_flush(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_flush(context)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_shutdown(context)
    }
}
