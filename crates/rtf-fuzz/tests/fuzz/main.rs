//! The fuzz targets.
//!
//! Without `RTF_FUZZ_TARGET`, every target gets the inputs of the repository. With the name of a
//! target there, libFuzzer runs it and reads the arguments; `tools/fuzz.py` does that. `--list`
//! prints the targets, each with the directories of its inputs.

#![expect(clippy::expect_used, reason = "a property that does not hold is a panic")]
#![expect(clippy::print_stdout, reason = "the list of targets is data")]

#[path = "../../../rtf-host-native/src/abi.rs"]
#[expect(dead_code, reason = "only the table is called")]
mod abi;
mod abi_texts;
mod campaign;
mod config;
mod filter;
mod frameworks;
mod history;
#[path = "../../../rtf-host-native/src/host_table.rs"]
mod host_table;
mod journal;
mod labels;
mod protocol;
mod suite;
mod web;

use std::process::ExitCode;

use rtf_fuzz::Target;

const TARGETS: &[Target] = &[
    Target { name: "abi", check: abi_texts::check, more: &[] },
    Target {
        name: "campaign",
        check: campaign::check,
        more: &["crates/rtf-campaign/tests/campaign/golden", "examples/10-campaign/campaign.xml"],
    },
    Target { name: "config", check: config::check, more: &[] },
    Target { name: "constraint", check: campaign::check_constraint, more: &[] },
    Target { name: "duration", check: suite::check_duration, more: &[] },
    Target { name: "event", check: journal::check_event, more: &[] },
    Target { name: "filter", check: filter::check, more: &[] },
    Target { name: "framework-boost", check: frameworks::boost, more: &[] },
    Target { name: "framework-cargo", check: frameworks::cargo, more: &[] },
    Target { name: "framework-catch2", check: frameworks::catch2, more: &[] },
    Target { name: "framework-ctest", check: frameworks::ctest, more: &[] },
    Target { name: "framework-doctest", check: frameworks::doctest, more: &[] },
    Target { name: "framework-go", check: frameworks::go, more: &[] },
    Target { name: "framework-gtest", check: frameworks::gtest, more: &[] },
    Target { name: "framework-junit", check: frameworks::junit, more: &[] },
    Target { name: "framework-rostest", check: frameworks::rostest, more: &[] },
    Target { name: "framework-tap", check: frameworks::tap, more: &[] },
    Target { name: "history", check: history::check, more: &[] },
    Target { name: "host-line", check: protocol::check_request, more: &[] },
    Target { name: "journal", check: journal::check, more: &["crates/rtf-report/tests/streams"] },
    Target { name: "journal-torn", check: journal::check_torn, more: &[] },
    Target { name: "runner-line", check: protocol::check_host_message, more: &[] },
    Target { name: "suite", check: suite::check, more: &["crates/rtf-plan/tests/data"] },
    Target { name: "web", check: web::check, more: &[] },
];

fn main() -> ExitCode {
    if let Ok(name) = std::env::var("RTF_FUZZ_TARGET") {
        let target = TARGETS.iter().find(|target| target.name == name);
        return rtf_fuzz::run(target.unwrap_or_else(|| panic!("there is no target `{name}`")));
    }
    if std::env::args().any(|arg| arg == "--list") {
        list();
        return ExitCode::SUCCESS;
    }
    for target in TARGETS {
        let inputs = target.replay().expect("the inputs of the repository");
        assert!(inputs > 0, "the target `{}` has no inputs", target.name);
        println!("{:<20} {inputs} inputs", target.name);
    }
    ExitCode::SUCCESS
}

/// Prints a line for each target: its name and its inputs, separated by tabs.
fn list() {
    for target in TARGETS {
        let inputs = target.inputs();
        let inputs: Vec<_> = inputs.iter().map(|input| input.to_string_lossy()).collect();
        println!("{}\t{}", target.name, inputs.join("\t"));
    }
}
