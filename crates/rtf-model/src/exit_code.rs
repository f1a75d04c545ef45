//! Exit codes of `rtf`, which `spec/exit-codes.md` and `rtf --help` list.

/// Everything passed.
pub const PASSED: u8 = 0;
/// A test did not pass, or a fixture collapsed or broke.
pub const FAILED: u8 = 1;
/// Bad input, or no tests: nothing was started.
pub const BAD_INPUT: u8 = 2;
/// `rtf` itself failed.
pub const BROKEN: u8 = 3;
/// A hook failed: the robot may not be in a safe state. Takes precedence over the
/// codes of tests, signals and the runner's death.
pub const HOOK_FAILED: u8 = 4;
/// The runner died; the guard stopped everything.
pub const RUNNER_DIED: u8 = 5;
/// `rtf campaign`: more episodes are necessary to decide about the claim.
pub const UNDECIDED: u8 = 6;
