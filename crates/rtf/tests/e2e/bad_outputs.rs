//! Directories and reports that cannot be written are reported before anything is started.
//!
//! The paths are below a regular file, where no user, not even `root`, can write.

use insta::assert_snapshot;

use crate::bad_input::{LUA_TEST, refused};
use crate::support::Folder;

fn folder() -> Folder {
    let folder = Folder::new();
    folder.file("EncoderTest.lua", LUA_TEST).file("file", "");
    folder
}

#[test]
fn a_results_folder_that_cannot_be_written() {
    let folder = folder();
    assert_snapshot!(refused(&folder, &["run", "EncoderTest.lua", "--results", "file/results"]), @"
    error: cannot create the results directory `file/results`
    caused by: Not a directory (os error 20)
    hint: choose another directory with `--results DIR`
    ");
    assert_eq!(std::fs::read_dir(folder.path()).expect("the folder").count(), 2);
}

#[test]
fn a_report_that_cannot_be_written() {
    let folder = folder();
    assert_snapshot!(refused(&folder, &["run", "EncoderTest.lua", "--report", "junit=file/junit.xml"]), @"
    error: cannot write the JUnit report to `file/junit.xml`
    caused by: Not a directory (os error 20)
    hint: choose another path with `--report FORMAT=PATH`
    ");
    assert_snapshot!(refused(&folder, &["run", "EncoderTest.lua", "--report", "text=."]), @"
    error: cannot write the text report to `.`
    caused by: is a directory
    hint: choose another path with `--report FORMAT=PATH`
    ");
}

#[test]
fn an_address_of_a_collector_that_is_no_address() {
    let folder = folder();
    let run = |target| refused(&folder, &["run", "EncoderTest.lua", "--report", target]);
    assert_snapshot!(run("otlp=http://me:secret@localhost/?key=secret"), @"
    error: the address of the collector has a query or a fragment
    hint: write `otlp=http://HOST:4318`; keys belong in `OTEL_EXPORTER_OTLP_HEADERS`
    ");
    assert_snapshot!(run("otlp=grpc://me:secret@localhost:4317"), @"
    error: the address of the collector is neither `http://` nor `https://`
    hint: write `otlp=http://HOST:4318`; keys belong in `OTEL_EXPORTER_OTLP_HEADERS`
    ");
}

#[test]
fn an_unknown_format() {
    assert_snapshot!(refused(&folder(), &["run", "EncoderTest.lua", "--report", "pdf=report.pdf"]), @"
    error: invalid value 'pdf=report.pdf' for '--report <FORMAT=PATH>': unknown format `pdf`, expected `junit=PATH`, `text=PATH`, `tap=PATH`, `code-quality=PATH`, `github=PATH`, `markdown=PATH`, `html=PATH`, `otlp=PATH`

    For more information, try '--help'.
    ");
    assert_snapshot!(refused(&folder(), &["run", "EncoderTest.lua", "--report", "junit"]), @"
    error: invalid value 'junit' for '--report <FORMAT=PATH>': expected `junit=PATH`, `text=PATH`, `tap=PATH`, `code-quality=PATH`, `github=PATH`, `markdown=PATH`, `html=PATH`, `otlp=PATH`

    For more information, try '--help'.
    ");
    assert_snapshot!(refused(&folder(), &["report", "latest", "--format", "pdf"]), @"
    error: invalid value 'pdf' for '--format <FORMAT>'
      [possible values: junit, text, tap, code-quality, github, markdown, html, otlp, json]

    For more information, try '--help'.
    ");
}

#[test]
fn two_reports_in_one_file() {
    let folder = folder();
    let reports = ["--report", "text=report", "--report", "junit=report"];
    assert_snapshot!(refused(&folder, &[["run", "EncoderTest.lua"].as_slice(), &reports].concat()), @"
    error: two reports would be written to `report`
    hint: choose another path with `--report FORMAT=PATH`
    ");
    assert!(!folder.path().join("report").exists());
}

/// A report that fails after the run is told too, and is no success.
#[test]
fn a_report_that_fails_after_the_run() {
    let folder = folder();
    folder.file(
        "Breaks.lua",
        "TestCase = {}\nfunction TestCase.run() os.remove('out') io.open('out', 'w'):close() end\n",
    );
    let finished = folder.rtf(&["run", "Breaks.lua", "--report", "text=out/report.txt"]);
    assert_eq!(finished.code, Some(3), "{}", finished.stderr);
    assert_snapshot!(finished.stderr, @"
    error: cannot write the text report to `out/report.txt`
    caused by: Not a directory (os error 20)
    ");
    let record = folder.journal().record;
    assert!(record.is_green(), "the run itself was well");
}
