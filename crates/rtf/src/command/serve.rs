//! `rtf serve`: past runs, and those that go on, until a signal ends it.

use std::io::Write;
use std::process::ExitCode;
use std::sync::Arc;

use rtf_engine::signal::Signals;
use rtf_web::{Capabilities, ShutdownHandle};

use super::Outcome;
use super::rerun::Reruns;
use super::web::{bind, serve};
use crate::cli::ServeArgs;
use crate::error::Failure;
use crate::exit;

/// Serves.
pub fn run(args: &ServeArgs) -> Outcome {
    let results = &args.results.results;
    if !results.is_dir() {
        let message = format!("there is no results folder `{}`", results.display());
        let hint = "name one with `--results DIR`, or run something first";
        return Err(Failure::input(message).hint(hint.to_owned()));
    }
    let bound = bind(args.web, &args.access)?;
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let runtime = runtime.map_err(Failure::own)?;
    let reruns = Arc::new(Reruns::new(results.canonicalize().map_err(Failure::own)?));
    // From now on a signal ends what was started, too.
    let signals = {
        let _inside = runtime.enter();
        Signals::install().map_err(Failure::own)?
    };
    let server = serve(bound, results, Capabilities::Viewer(reruns.clone()))?;
    let ender = server.ender();
    let ending = std::thread::Builder::new().name("signals".into());
    let ending = ending.spawn(move || runtime.block_on(end(signals, &reruns, ender)));
    let ending = ending.map_err(Failure::own)?;
    server.wait().map_err(Failure::own)?;
    // It is what has ended the server.
    let code = ending.join().unwrap_or(exit::BROKEN);
    Ok(ExitCode::from(code))
}

/// Waits for a signal, and ends the run that was started, then the server; the
/// exit code.
async fn end(mut signals: Signals, reruns: &Reruns, ender: ShutdownHandle) -> u8 {
    let (number, _) = signals.next().await;
    let mut waits = reruns.end(number);
    while let Some(name) = waits {
        // Whoever has left needs no word.
        let mut err = anstream::stderr();
        let _ = writeln!(err, "rtf serve: waiting for the end of the run {name}");
        tokio::select! {
            () = reruns.ended() => break,
            (number, _) = signals.next() => waits = reruns.end(number),
        }
    }
    ender.end();
    u8::try_from(128 + number).unwrap_or(exit::BROKEN)
}
