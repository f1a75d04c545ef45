//! The environment variables of processes.

#[cfg(doc)]
use super::ForkRequest;

/// The environment variable that names a host's channel: `fd:N` on Unix.
pub const CHANNEL_VARIABLE: &str = "RTF_CHANNEL";

/// The environment variable that marks every process of a test or fixture.
pub const SCOPE_VARIABLE: &str = "RTF_SCOPE";

/// The environment variable that names a process's owner for display: `test arm/EncoderTest`.
pub const OWNER_VARIABLE: &str = "RTF_OWNER";

/// The environment variable that holds the suite's environment string.
pub const ENVIRONMENT_VARIABLE: &str = "RTF_ENVIRONMENT";

/// The environment variable that names the run's directory, which contains the journal.
pub const RUN_DIR_VARIABLE: &str = "RTF_RUN_DIR";

/// The environment variable that names the file with the simulated time, for tests,
/// which follow it. If it is empty or not set, they follow the wall clock.
pub const CLOCK_VARIABLE: &str = "RTF_CLOCK";

/// The environment variable that names the same file for fixtures, one of which may
/// write it.
pub const CLOCK_FILE_VARIABLE: &str = "RTF_CLOCK_FILE";

/// The environment variable that makes a host a server that forks hosts:
/// `fd:N`, then blanks as room for the variables of a [`ForkRequest`].
pub const FORK_SERVER_VARIABLE: &str = "RTF_FORK_SERVER";

/// The environment variable with the descriptor at which a program waits to be forked for
/// each of its cases (`spec/frameworks.md`).
pub const PROGRAM_FORKS_VARIABLE: &str = "RTF_PROGRAM_FORKS";

/// Is `never` if the user wants all processes of tests to be executed.
pub const FORK_VARIABLE: &str = "RTF_FORK";

/// The environment variable that names the socket of a program of another framework:
/// `fd:N`. `spec/frameworks.md` documents it.
pub const SESSION_VARIABLE: &str = "RTF_SESSION";

/// The environment variable that names the file to which such a program writes its stacks
/// on `SIGUSR2`, if it can.
pub const STACK_FILE_VARIABLE: &str = "RTF_STACK_FILE";
