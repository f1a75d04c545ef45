//! The command that replays the recording of a failed test.

use insta::assert_snapshot;

use crate::support::Folder;

/// Attaches a recording, and fails unless it is told which one to replay.
const RECORDED: &str = "function TestCase.run()
  rtf.attach('data.mcap')
  rtf.check(false, 'replaying ' .. rtf.param())
end
";
const SUITE: &str = "<suite name='arm'>
  <test type='lua' name='recorded'>recorded.lua</test>
</suite>";
const REPLAY: &str = "<suite name='arm'>
  <test type='lua' name='recorded' param='${param:recording} ${param:speed=1}'>recorded.lua</test>
</suite>";

fn folder() -> Folder {
    let folder = Folder::new();
    folder.file("recorded.lua", RECORDED).file("data.mcap", "data").file("my arm.xml", SUITE);
    folder
}

/// The command in the summary, as words.
fn replay_command(stdout: &str) -> Option<Vec<String>> {
    let line = stdout.lines().find_map(|line| line.strip_prefix("    replay  "))?;
    Some(shell_words::split(line).expect("words"))
}

#[test]
fn a_recording_is_replayed_by_the_suite_next_to_that_of_the_test() {
    let folder = folder();
    folder.file("my arm.replay.xml", REPLAY);
    let run = folder.rtf(&["run", "my arm.xml"]);
    assert_eq!(run.code, Some(1));
    let command = replay_command(&run.stdout).expect("a command");
    let words: Vec<&str> = command.iter().map(String::as_str).collect();
    assert_eq!(words[..4], ["rtf", "run", "my arm.replay.xml::recorded", "--set"]);
    let recording = words[4].strip_prefix("recording=").expect("a recording");
    assert_eq!(folder.read(recording), "data");
    let replay = folder.rtf(&words[1..]);
    assert!(replay.stdout.contains(&format!("replaying {recording} 1")), "{}", replay.stdout);
    // So does the summary for a CI job.
    let summary = folder.rtf(&["run", "my arm.xml", "--report", "markdown=summary.md"]);
    assert_eq!(summary.code, Some(1));
    let summary = folder.read("summary.md");
    let line = summary.lines().find(|line| line.starts_with("- replay ")).expect("a command");
    assert!(line.contains("my arm.replay.xml::recorded"), "{line}");
    // `rtf show` prints it, too, with the options without which it would be another test.
    let shown = folder.rtf(&["run", "my arm.xml", "--set", "speed=2"]).stdout;
    let command = replay_command(&shown).expect("a command");
    assert_eq!(command[3..5], ["--set", "speed=2"]);
    assert!(replay_command(&folder.rtf(&["show"]).stdout).is_some());
}

#[test]
fn without_such_a_suite_there_is_no_command() {
    let run = folder().rtf(&["run", "my arm.xml"]);
    assert!(run.stdout.contains("    rerun   "), "{}", run.stdout);
    assert_eq!(replay_command(&run.stdout), None);
}

#[test]
fn a_suite_that_replays_is_not_one_of_its_directory() {
    let folder = folder();
    folder.file("my arm.replay.xml", REPLAY);
    assert_snapshot!(folder.shown(&folder.rtf(&["list", "."])), @"
    exit code 0
    ----- stdout
    arm/recorded
    ----- stderr
    ");
}
