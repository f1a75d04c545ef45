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
    Run tests on robots: plug-ins in any language, on fixtures that rtf monitors while the tests run

    Usage: rtf [OPTIONS] <COMMAND>

    Commands:
      run          Run suites and plug-ins
      campaign     Run a suite many times with varied parameters, and judge a claim about its pass rate
      watch        Rerun the tests whenever a suite, a plug-in or an `rtf.toml` changes
      check        Report the problems of suites and plug-ins without running them
      list         List the tests that `rtf run` would run
      doctor       Check this machine for missing dependencies
      locks        List the locks that are held on this machine, or wait for locks
      show         Show a past run, even if its runner was killed
      report       Write a report of a past run
      merge        Merge several runs into one, for example the shards of `--shard`
      history      Show results of many runs: flaky and slow tests, trends, comparisons
      golden       Store trajectories and pictures of a run, with which later runs are compared
      serve        Show active and past runs in a browser
      import       Write a suite with the tests of a build directory or workspace
      config       Show the configuration from `rtf.toml`, the command line and variables
      new          Write a small project that runs at once: a suite, a test or a fixture
      init         Add `rtf.toml`, `.gitignore` and jobs for GitHub and GitLab to a project
      cmake-dir    Print the directory of the CMake packages, for `rtf_DIR`
      ament-dir    Print the directory of `ament_cmake_rtf`, to be copied into a colcon workspace
      ada-dir      Print the directory of the Ada SDK, for `gprbuild -aP`
      completions  Print shell completions
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
      3    rtf itself failed, for example because it could not write a report
      4    a hook failed: the robot may not be in a safe state
      5    the runner died (SIGKILL, out of memory, a bug); its guard stopped everything
      6    a campaign needs more episodes to decide about its claim
      128+N  signal N ended the run (130 for Ctrl-C)
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
    Run suites and plug-ins

    Usage: rtf run [OPTIONS] [FILE]...

    Arguments:
      [FILE]...  Suites (.xml), plug-ins, and directories of either

    Options:
          --color <WHEN>                 When to use colours [default: auto] [possible values: auto,
                                         always, never]
      -r, --recursive                    Search directories recursively
          --param <TEXT>                 Parameter string of the plug-ins named by FILE
          --environment <TEXT>           Environment string of the plug-ins named by FILE
          --repetition <N>               Run the plug-ins named by FILE N times
          --profile <NAME>               Use this profile of `rtf.toml`: `real`, `sim`, `ci`, … [env:
                                         RTF_PROFILE=]
          --set <NAME=VALUE>             Set a parameter, which suites read as `${param:NAME}` and tests
                                         as RTF_PARAM_NAME
          --results <DIR>                Results directory, with one directory per run [env:
                                         RTF_RESULTS=] [default: rtf-results]
          --history <FILE>               History database, or its address [default: `history.db` in the
                                         results directory] [env: RTF_HISTORY_URL]
          --format <FORMAT>              Format of standard output [default: console] [possible values:
                                         console, json, tap]
          --report <FORMAT=PATH>         Also write a report: `junit=PATH`, `text=`, `tap=`,
                                         `code-quality=`, `github=`, `markdown=`, `html=` or `otlp=`;
                                         `otlp=http://HOST:4318` sends a trace to a collector
          --symlink <PATH>               Also make PATH a symbolic link to the directory of the run
          --annotations <HOST>           Print annotations for a code host, on standard error or in the
                                         job log [default: auto] [possible values: auto, github, gitlab,
                                         none]
          --shutdown-timeout <DURATION>  Time limit for all tear-downs and hooks after a signal; then
                                         rtf kills all leftover processes [default: [TIME]]
          --end-with-stdin               End the run, as SIGTERM does, when standard input closes: for
                                         programs that start rtf
          --no-input                     Answer no questions of tests: they get their default answers,
                                         or are errors
      -v, --verbose                      Print every message, measurement and output as it arrives
      -j, --jobs <N>                     Run up to N suites in parallel, each with separate fixtures
                                         [default: 1]
          --lock-timeout <DURATION>      How long a suite waits for its locks [default: no limit]
          --fork <WHEN>                  Fork the hosts of C, C++, Lua and Python tests from a warm
                                         host: `auto` (from the second test on), `always`, or `never`
                                         [env: RTF_FORK=] [default: auto]
          --no-history                   Do not import the run into the history
      -h, --help                         Print help (see more with '--help')
      -V, --version                      Print version

    Test selection:
      -E, --filter <FILTER>    Run only tests that match: `tag(slow) & !type(lua)`
          --rerun <VERDICT>    Run only tests that failed or were interrupted in the past run FILE, by
                               default `latest` [possible values: failed, interrupted]
          --shuffle[=<SEED>]   Run tests in random order; to repeat an order, give the seed that its run
                               printed
          --order <ORDER>      Order tests by their results in the history: as in their `file`,
                               `failed-first`, or `slowest-first`
          --shard <N/OF>       Run only one shard of the tests: `2/5` is the second of five
          --shard-by <METHOD>  Assign tests to shards by `hash` of their names, by `count`, or by past
                               durations: `duration=history`, `duration=RUN`, or `duration=FILE.json`
                               from `rtf history slow` [default: hash]
          --episode <ID>       Run only episode ID of a campaign: FILE is the campaign, or the directory
                               of its results
          --episodes <LIST>    Run the suite FILE once for each episode of the list LIST, see `rtf
                               campaign episodes`; `-` reads it from standard input while the episodes
                               run
          --slots <N>          Run N episodes at a time, instead of the `slots` of the test
          --dry-run            List the selected tests without running them

    Repetition:
          --repeat <N>             Run each test N times as often as its suite says
          --for <DURATION>         Repeat all tests, round after round, until the time is up: `[TIME]`,
                                   `8h`
          --retries <N>            Retry a failed test up to N times; overrides its suite
          --flaky-result <RESULT>  Result of a test that passes only on a retry [default: pass]
                                   [possible values: pass, fail]
          --no-skips               Fail the run if a test or a case skips itself
          --max-fail <N>           Skip the remaining tests after N tests have failed
          --until-fail             Skip the remaining tests after the first failure, as `--max-fail 1`

    Web:
          --web[=<ADDR:PORT>]      Show the run live in a browser, on ADDR:PORT (127.0.0.1:8080) or the
                                   next free port
          --web-linger <DURATION>  Keep serving after the run has ended, for this time or until Ctrl-C:
                                   `10min`
          --web-token-file <FILE>  Read the access token from a file instead of generating one
          --web-allow-remote       Let other machines connect; requires TLS, and the token even for
                                   reading
          --web-cert <FILE>        TLS certificate (PEM); by default, rtf generates one if other
                                   machines may connect
          --web-key <FILE>         Private key of the TLS certificate (PEM)
          --web-host <NAME>        Additional host name of the server

    Debugging:
          --debug               Give the terminal to the test, which must be the only one, and suspend
                                its limits: for `breakpoint()`, `binding.irb`, `io.read`
          --debugger <COMMAND>  As `--debug`, and start the test's process with this debugger: `gdb
                                --args`
          --debug-wait          Print the process of the test, which begins when a debugger is attached,
                                and suspend its limits

    Executor:
          --executor <EXECUTOR>     Where to run: on this machine (`local`), or in a cluster (`slurm`,
                                    `kubernetes`) [default: local]
          --shards <N>              Split the tests or episodes into N shards, which the executor runs
                                    as tasks
          --executor-arg <ARG>      Pass an argument to `sbatch` (`--partition=sim`) or `kubectl`
                                    (`--namespace=sim`)
          --executor-licenses       Request a licence of Slurm or an extended resource of Kubernetes for
                                    each resource that the suites require
          --executor-image <IMAGE>  Kubernetes: the container image with `rtf` and the suites
          --executor-claim <CLAIM>  Kubernetes: the PersistentVolumeClaim of the results directory
          --executor-patch <FILE>   Kubernetes: merge FILE (YAML or JSON) into the Job: resources, node
                                    selectors, variables
          --executor-print          Kubernetes: print the Job instead of submitting it
          --resume                  Follow and merge the submission whose directory is FILE, with its
                                    original options
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

/// The verbs with a page of the manual, in its order.
const VERBS: [&str; 48] = [
    "ada-dir",
    "ament-dir",
    "campaign-compare",
    "campaign-episodes",
    "campaign-invariance",
    "campaign-plan",
    "campaign-run",
    "campaign-search",
    "campaign-show",
    "campaign-shrink",
    "campaign",
    "check",
    "cmake-dir",
    "completions",
    "config-show",
    "config",
    "doctor",
    "golden-accept",
    "golden",
    "history-accept",
    "history-campaigns",
    "history-changes",
    "history-compare",
    "history-doctor",
    "history-export",
    "history-flaky",
    "history-gate",
    "history-import",
    "history-prune",
    "history-rates",
    "history-runs",
    "history-show",
    "history-slow",
    "history-trend",
    "history",
    "import-colcon",
    "import-ctest",
    "import",
    "init",
    "list",
    "locks",
    "merge",
    "new",
    "report",
    "run",
    "serve",
    "show",
    "watch",
];

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
    let wanted: Vec<_> =
        VERBS.iter().map(|verb| format!("rtf-{verb}.1")).chain(["rtf.1".into()]).collect();
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
