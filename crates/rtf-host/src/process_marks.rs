//! Finds the processes of a fixture in `/proc`. They have its name in `RTF_OWNER`, which their
//! children inherit, also those that detach themselves.

use rtf_model::protocol::{OWNER_VARIABLE, RUN_DIR_VARIABLE};

/// The variables in the environment of a fixture's processes.
#[derive(Clone, Debug)]
pub struct ProcessMarks {
    /// Each `NAME=value`.
    marks: Vec<Vec<u8>>,
}

impl ProcessMarks {
    /// The processes of this run with this value of `RTF_OWNER`.
    #[must_use]
    pub fn new(owner: &str) -> Self {
        let mut marks = vec![format!("{OWNER_VARIABLE}={owner}").into_bytes()];
        if let Ok(run) = std::env::var(RUN_DIR_VARIABLE) {
            marks.push(format!("{RUN_DIR_VARIABLE}={run}").into_bytes());
        }
        Self { marks }
    }

    /// Whether a process has them. False if it has ended.
    #[must_use]
    pub fn are_of(&self, pid: u32) -> bool {
        let Ok(environment) = std::fs::read(format!("/proc/{pid}/environ")) else { return false };
        let mut marks = self.marks.iter();
        marks.all(|mark| environment.split(|byte| *byte == 0).any(|variable| variable == mark))
    }

    /// The processes that have them now.
    pub fn find(&self) -> impl Iterator<Item = u32> {
        let entries = std::fs::read_dir("/proc").into_iter().flatten().flatten();
        let pids = entries.filter_map(|entry| entry.file_name().to_str()?.parse().ok());
        pids.filter(|pid| self.are_of(*pid))
    }
}

/// The value of `RTF_OWNER` of another fixture of this fixture's suite.
///
/// # Errors
/// This process is not a fixture with the name `own_name`.
pub fn fixture_owner(own_name: &str, fixture: &str) -> Result<String, String> {
    let owner = std::env::var(OWNER_VARIABLE).unwrap_or_default();
    let prefix = owner.strip_suffix(own_name);
    let prefix = prefix.ok_or_else(|| format!("`{OWNER_VARIABLE}` is `{owner}`"))?;
    Ok(format!("{prefix}{fixture}"))
}
