//! Stack dumps of processes that hang.

use std::path::Path;
use std::time::Duration;

use rtf_model::protocol::StackSupport;
use tokio::io::AsyncReadExt;

use crate::spawn_request::{SpawnRequest, Streams};
use crate::spawner::Spawner;
use crate::{tree, unix};

const SIGUSR2: i32 = 12;
/// A host that dumps its own stacks does so within this time, or not at all.
pub const HOST_DUMP_WAIT: Duration = Duration::from_secs(1);
/// The limit for a debugger, also for one that a host starts.
pub const DEBUGGER_WAIT: Duration = Duration::from_secs(10);
/// The longest dump, in bytes.
const DUMP_LIMIT: u64 = 256 * 1024;

/// Dumps the stacks of a process. For [`StackSupport::Message`] the caller has sent the
/// request; this is the fallback if the host does not reply.
pub async fn dump(
    pid: i32,
    (support, wait): (StackSupport, Duration),
    file: &Path,
    spawner: &Spawner,
) -> String {
    match support {
        StackSupport::Message => tokio::time::sleep(wait).await,
        StackSupport::Signal => {
            if let Some(text) = by_signal(pid, file).await {
                return text;
            }
        }
        StackSupport::None => {}
    }
    by_debugger(pid, spawner).await
}

async fn by_signal(pid: i32, file: &Path) -> Option<String> {
    unix::signal_process(pid, SIGUSR2);
    let deadline = tokio::time::Instant::now() + HOST_DUMP_WAIT;
    let mut last = Vec::new();
    while tokio::time::Instant::now() < deadline {
        tokio::time::sleep(Duration::from_millis(20)).await;
        let text = std::fs::read(file).unwrap_or_default();
        // The dump is complete when it has not grown since the last poll.
        if !text.is_empty() && text == last {
            return Some(String::from_utf8_lossy(&text).into_owned());
        }
        last = text;
    }
    None
}

async fn by_debugger(pid: i32, spawner: &Spawner) -> String {
    let pid = pid.to_string();
    let gdb = ["gdb", "-nx", "-q", "-batch", "-p", &pid, "-ex", "thread apply all backtrace 64"];
    let eu_stack = ["eu-stack", "-p", &pid];
    for command in [&gdb[..], &eu_stack[..]] {
        if let Ok(text) = run(command, spawner).await {
            let text = remove_noise(&text);
            if text.contains("#0") {
                return text;
            }
        }
    }
    "no stack dump: neither `gdb` nor `eu-stack` could read the process".to_owned()
}

async fn run(command: &[&str], spawner: &Spawner) -> std::io::Result<String> {
    let request = SpawnRequest {
        command: command.iter().map(|&word| word.to_owned()).collect(),
        streams: Streams::StdoutOnly,
        ..SpawnRequest::default()
    };
    let mut process = spawner.spawn(request).await?;
    let mut text = Vec::new();
    let reading = async {
        match process.stdout.take() {
            Some(stdout) => stdout.take(DUMP_LIMIT).read_to_end(&mut text).await.map(|_| ()),
            None => Ok(()),
        }
    };
    let outcome = tokio::time::timeout(DEBUGGER_WAIT, reading).await;
    tree::kill_tree(process.pid);
    let _ = process.end.wait().await;
    outcome.unwrap_or(Ok(()))?;
    Ok(String::from_utf8_lossy(&text).into_owned())
}

/// Removes messages of the debugger itself.
#[must_use]
pub fn remove_noise(text: &str) -> String {
    let noise =
        ["[New LWP", "[Thread debugging", "Using host", "warning:", "[Inferior", "Attaching to"];
    let is_stack = |line: &&str| noise.iter().all(|start| !line.starts_with(start));
    text.lines().filter(is_stack).collect::<Vec<_>>().join("\n").trim().to_owned()
}

#[cfg(test)]
mod tests {
    #[test]
    fn messages_of_the_debugger_are_removed() {
        let text =
            "[New LWP 7]\nwarning: x\n\nThread 1 (LWP 6):\n#0  pause ()\n[Inferior 1 detached]\n";
        assert_eq!(super::remove_noise(text), "Thread 1 (LWP 6):\n#0  pause ()");
    }
}
