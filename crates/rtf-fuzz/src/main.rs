//! `--list` prints the targets, each with the files and directories of its inputs. With the name of a
//! target in `RTF_FUZZ_TARGET`, libFuzzer runs it and reads the arguments; `tools/fuzz.py` does that.
#![expect(clippy::print_stdout, clippy::print_stderr, reason = "the list of targets is data")]

use std::process::ExitCode;

use rtf_fuzz::TARGETS;

fn main() -> ExitCode {
    let name = std::env::var("RTF_FUZZ_TARGET").unwrap_or_default();
    if let Some(target) = TARGETS.iter().find(|target| target.name == name) {
        return rtf_fuzz::run(target);
    }
    if !std::env::args().any(|arg| arg == "--list") {
        eprintln!("error: there is no target `{name}` (RTF_FUZZ_TARGET)");
        return ExitCode::FAILURE;
    }
    for target in TARGETS {
        let inputs = target.inputs();
        let inputs: Vec<_> = inputs.iter().map(|input| input.to_string_lossy()).collect();
        println!("{}\t{}", target.name, inputs.join("\t"));
    }
    ExitCode::SUCCESS
}
