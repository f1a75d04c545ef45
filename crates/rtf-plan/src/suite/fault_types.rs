//! The declarations of faults, before any name is resolved.

use rtf_model::{FaultAmount, FaultTime, NetworkFault, ValuesFault};

use super::{Span, Spanned};

#[derive(Clone, Debug)]
pub struct DeclaredFault {
    /// The position of the tag.
    pub span: Span,
    pub name: Spanned<String>,
    pub effect: DeclaredEffect,
    /// When it is injected, since the start of the test; `None`: when a test does it.
    pub at: Option<FaultTime>,
    /// How long it lasts; `None`: until the end of the test.
    pub duration: Option<FaultTime>,
    /// The seed for random times.
    pub seed: u32,
}

#[derive(Clone, Debug)]
pub enum DeclaredEffect {
    Kill(DeclaredTarget),
    Stop(DeclaredTarget),
    /// Stops processes for a part of the time.
    Slow {
        target: DeclaredTarget,
        /// The share of the time in which they may run, from 1 to 99.
        percent: u32,
    },
    /// Allocates memory.
    Memory(FaultAmount),
    /// Allocates space of a file system.
    Disk {
        /// A directory on it.
        dir: Spanned<String>,
        amount: FaultAmount,
    },
    /// Impairs the packets of the suite's private network.
    Network {
        fault: NetworkFault,
        /// The port from or to which they are; `None`: all.
        port: Option<Spanned<String>>,
    },
    /// Changes the messages that a proxy passes on.
    Values {
        /// The name of the proxy.
        fixture: Spanned<String>,
        fault: ValuesFault,
    },
}

/// The processes of a fixture that a fault affects.
#[derive(Clone, Debug)]
pub struct DeclaredTarget {
    pub fixture: Spanned<String>,
    /// The name of the processes; `None`: all.
    pub process: Option<String>,
}

impl DeclaredEffect {
    #[must_use]
    pub fn target(&self) -> Option<&DeclaredTarget> {
        match self {
            Self::Kill(target) | Self::Stop(target) | Self::Slow { target, .. } => Some(target),
            Self::Memory(_) | Self::Disk { .. } | Self::Network { .. } | Self::Values { .. } => {
                None
            }
        }
    }
}
