//! Verbs that do not run tests: `list`, `check`, `completions`, `man`, `--help`.

use insta::assert_snapshot;

use crate::support::Folder;

const PASSES: &str = "TestCase = {}\nfunction TestCase.run() rtf.check(true, 'fine') end\n";

fn folder() -> Folder {
    let folder = Folder::new();
    folder.file("Encoder.lua", PASSES);
    folder.file("Driver.lua", "FixtureManager = {}\nfunction FixtureManager.setup() end\n");
    folder.file(
        "arm.xml",
        "<suite name=\"arm\" tags=\"simulation\">\n  <fixture>Driver.lua</fixture>\n  \
         <test>Encoder.lua</test>\n  \
         <test name=\"again\" tags=\"smoke slow\" repetition=\"3\">Encoder.lua</test>\n  \
         <test name=\"safe\" critical=\"true\">Encoder.lua</test>\n</suite>\n",
    );
    folder
}

#[test]
fn list_names_the_tests_with_their_tags() {
    let folder = folder();
    let finished = folder.rtf(&["list", "arm.xml", "Encoder.lua", "--repetition", "2"]);
    assert_snapshot!(folder.shown(&finished), @"
    exit code 0
    ----- stdout
    arm/Encoder  (#simulation)
    arm/again  (3 times, #simulation, #smoke, #slow)
    arm/safe  (critical, #simulation)
    plug-ins/Encoder  (2 times)
    ----- stderr
    ");
    assert!(!folder.path().join("rtf-results").exists());
}

#[test]
fn check_counts_what_is_there() {
    let folder = folder();
    let finished = folder.rtf(&["check", "arm.xml"]);
    assert_snapshot!(folder.shown(&finished), @"
    exit code 0
    ----- stdout
    1 suite, 1 fixture, 3 tests: no errors
    ----- stderr
    ");
    folder.file("one.xml", "<suite>\n  <!-- -- -->\n  <test>Encoder.lua</test>\n</suite>\n");
    let finished = folder.rtf(&["check", "one.xml"]);
    assert_snapshot!(folder.shown(&finished), @"
    exit code 0
    ----- stdout
    1 suite, 0 fixtures, 1 test: no errors, 1 warning
    ----- stderr
    warning: `--` in a comment is not legal XML; accepted
     --> one.xml:2:8
      |
    2 |   <!-- -- -->
      |        ^^
      |
      = help: remove the dashes: other programs refuse the file
    ");
    assert!(!folder.path().join("rtf-results").exists());
}

#[test]
fn options_that_have_no_effect_are_told() {
    let folder = folder();
    let finished = folder.rtf(&["check", "arm.xml", "--param", "--fast"]);
    assert_snapshot!(folder.shown(&finished), @"
    exit code 0
    ----- stdout
    1 suite, 1 fixture, 3 tests: no errors, 1 warning
    ----- stderr
    warning: the parameter string has no effect: no plug-in is given directly
     |
     = note: a suite file defines these values for its tests
    ");
}

#[test]
fn help_lists_the_exit_codes() {
    let folder = Folder::new();
    let shown = folder.shown(&folder.rtf(&["--help"]));
    let lines: Vec<&str> = shown.lines().map(str::trim_end).collect();
    assert_snapshot!(lines.join("\n"), @"
    exit code 0
    ----- stdout
    Tests of robots: plug-ins in any language, on top of fixtures that are watched while the tests run

    Usage: rtf [OPTIONS] <COMMAND>

    Commands:
      run          Run suites, plug-ins and folders
      watch        Run again whenever a suite, a plug-in or an `rtf.toml` changes
      check        Find every problem of suites and plug-ins, start nothing
      list         List the tests that `run` would run
      doctor       Tell what is missing on this machine, and how it is installed
      locks        Show who has the locks of this machine, or wait for some
      show         Show a past run, or what is there of one that was killed
      report       Write a report of a past run
      merge        Make one run of several, as of the parts that `--shard` made
      serve        Show runs in a browser, past ones and those that go on
      config       Tell what `rtf.toml` and others set
      completions  Print a shell's completions
      help         Print this message or the help of the given subcommand(s)

    Options:
          --color <WHEN>
              When to use colours

              Possible values:
              - auto:   On a terminal, unless `NO_COLOR` is set
              - always: Always
              - never:  Never

              [default: auto]

      -h, --help
              Print help (see a summary with '-h')

      -V, --version
              Print version

    Exit codes:
      0    everything passed
      1    a test did not pass, or a fixture collapsed or broke
      2    bad input, or no tests: nothing was started
      3    rtf could not do its own work, for example write a report
      4    a hook failed: the robot may not be in a safe state, whatever else happened
      5    the runner died (SIGKILL, out of memory, a defect): its guard stopped everything
      128+N  the run was ended by signal N (130 for Ctrl-C)
    ----- stderr
    ");
}

#[test]
#[expect(clippy::too_many_lines, reason = "what is shown is long")]
fn help_of_run() {
    let folder = Folder::new();
    let finished = folder.rtf(&["run", "-h"]);
    assert_snapshot!(folder.shown(&finished), @"
    exit code 0
    ----- stdout
    Run suites, plug-ins and folders

    Usage: rtf run [OPTIONS] [FILE]...

    Arguments:
      [FILE]...  Suites (.xml), plug-ins, and folders of either

    Options:
          --color <WHEN>                 When to use colours [default: auto] [possible values: auto,
                                         always, never]
      -r, --recursive                    Descend into folders
          --param <TEXT>                 The parameter string of plug-ins that are given by name
          --environment <TEXT>           The environment string of plug-ins that are given by name
          --repetition <N>               How often plug-ins that are given by name are run
          --profile <NAME>               The profile of `rtf.toml` that holds: `real`, `sim`, `ci`, …
                                         [env: RTF_PROFILE=]
          --set <NAME=VALUE>             Set a parameter: suites find it as `${param:NAME}`, tests in
                                         RTF_PARAM_NAME
          --results <DIR>                The folder of the runs' folders [env: RTF_RESULTS=] [default:
                                         rtf-results]
          --format <FORMAT>              What standard output has of the run [default: console]
                                         [possible values: console, json, tap]
          --report <FORMAT=PATH>         Also write a report: `junit=PATH`, `text=`, `tap=`,
                                         `code-quality=` or `github=`
          --annotations <HOST>           Tell a code host, on standard error or in the log, what went
                                         wrong [default: auto] [possible values: auto, github, gitlab,
                                         none]
          --shutdown-timeout <DURATION>  How long tear-downs and hooks may take altogether, once a
                                         signal ends the run; then what is left is killed [default: [TIME]]
          --end-with-stdin               End the run, as SIGTERM does, when standard input ends: for
                                         programs that start rtf, whose death it then notices
      -v, --verbose                      Show every message, measurement and output as it comes
      -j, --jobs <N>                     How many suites run at the same time, each with fixtures of its
                                         own [default: 1]
          --lock-timeout <DURATION>      How long a suite waits for the locks that it requires; for
                                         ever, unless told
          --fork <WHEN>                  Fork the hosts of C, C++, Lua and Python tests from one that is
                                         ready: `auto` (from the second test on), `always`, or `never`
                                         [env: RTF_FORK=] [default: auto]
      -h, --help                         Print help (see more with '--help')
      -V, --version                      Print version

    Choosing tests:
      -E, --filter <FILTER>   Only tests that this holds for: `tag(slow) & !type(lua)`; several add up
          --rerun <WHICH>     Only those that failed, or were interrupted, in a past run: FILE is then
                              the run, `latest` unless it is given. They get what that run gave them
                              [possible values: failed, interrupted]
          --shuffle[=<SEED>]  In a random order; the number that decides it is shown, and repeats it
          --shard <N/OF>      Only one part of the tests, of several: `2/5`
          --shard-by <WHAT>   What decides to which part a test belongs: its `hash`, its place in the
                              `count`, or its `duration` in the run that follows as `duration=RUN`
                              [default: hash]
          --dry-run           Only list the tests that would be run

    Repeating tests:
          --repeat <N>             Run each test N times as often as its suite says
          --for <DURATION>         Repeat all tests, round by round, until this time is over: `[TIME]`,
                                   `8h`
          --retries <N>            Try a test that fails up to N times again, whatever its suite says
          --flaky-result <RESULT>  What a test that passes only when it is tried again counts as
                                   [default: pass] [possible values: pass, fail]
          --max-fail <N>           Skip the rest as soon as N tests have not passed
          --until-fail             Skip the rest as soon as a test has not passed

    Web:
          --web[=<ADDR:PORT>]      Show the run live in a browser, on this address (127.0.0.1:8080) or
                                   the next free port
          --web-linger <DURATION>  Keep serving the run after it has ended, for this long or until
                                   Ctrl-C, like `10min`
          --web-token-file <FILE>  Read the token from a file, instead of making a new one
          --web-allow-remote       Let other machines connect: with the token, also for reading, and
                                   with TLS
          --web-cert <FILE>        The certificate for TLS (PEM); beyond this machine one is made when
                                   none is given
          --web-key <FILE>         The certificate's key (PEM)
          --web-host <NAME>        Another name under which the server is reached
    ----- stderr
    ");
}

#[test]
fn completions_know_every_verb() {
    let folder = Folder::new();
    for (shell, begins) in [("bash", "_rtf()"), ("zsh", "#compdef rtf"), ("fish", "# Print")] {
        let finished = folder.rtf(&["completions", shell]);
        assert_eq!((finished.code, finished.stderr.as_str()), (Some(0), ""));
        let script = finished.stdout;
        assert!(script.starts_with(begins), "{shell}: {}", &script[..80]);
        for verb in ["run", "check", "list", "show", "report", "completions"] {
            assert!(script.contains(verb), "{shell}: {verb}");
        }
        assert!(script.contains("recursive") && script.contains("junit"), "{shell}");
    }
    let finished = folder.rtf(&["completions", "tcsh"]);
    assert_snapshot!(folder.shown(&finished), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: invalid value 'tcsh' for '<SHELL>'
      [possible values: bash, elvish, fish, powershell, zsh]

      tip: a similar value exists: 'zsh'

    For more information, try '--help'.
    ");
}

/// A shell takes what is written for it.
#[test]
fn bash_reads_its_completions() {
    let folder = Folder::new();
    folder.file("rtf.bash", &folder.rtf(&["completions", "bash"]).stdout);
    let script = "source ./rtf.bash; COMP_WORDS=(rtf sh); COMP_CWORD=1; _rtf rtf sh rtf; echo \"${COMPREPLY[*]}\"";
    let mut bash = std::process::Command::new("bash");
    let output = bash.args(["-c", script]).current_dir(folder.path()).output().expect("bash");
    assert_eq!(
        String::from_utf8_lossy(&output.stdout),
        "show\n",
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
}

#[test]
fn man_writes_a_page_for_each_verb() {
    let folder = Folder::new();
    let finished = folder.rtf(&["man", "share/man1"]);
    assert_eq!((finished.code, finished.stderr.as_str()), (Some(0), ""));
    let pages = std::fs::read_dir(folder.path().join("share/man1")).expect("the folder");
    let mut names: Vec<_> = pages
        .map(|page| page.expect("a page").file_name().into_string().expect("a name"))
        .collect();
    names.sort();
    let verbs = [
        "check",
        "completions",
        "config-show",
        "config",
        "doctor",
        "list",
        "locks",
        "merge",
        "report",
        "run",
        "serve",
        "show",
        "watch",
    ];
    let wanted: Vec<_> =
        verbs.iter().map(|verb| format!("rtf-{verb}.1")).chain(["rtf.1".into()]).collect();
    assert_eq!(names, wanted);
    let page = std::fs::read_to_string(folder.path().join("share/man1/rtf.1")).expect("a page");
    assert!(page.contains(".TH rtf 1") && page.contains("Exit codes"), "{page}");
    let finished = folder.file("file", "").rtf(&["man", "file"]);
    assert_snapshot!(folder.shown(&finished), @"
    exit code 3
    ----- stdout
    ----- stderr
    error: File exists (os error 17)
    ");
}
