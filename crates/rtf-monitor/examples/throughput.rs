//! Prints how many samples per second monitors judge: 50 signals at 1 kHz, 10 monitors of four
//! signals each.
//!
//! `cargo run --release -p rtf-monitor --example throughput -- [SECONDS]`: the length of the
//! signals, by default 60.

use std::io::Write;
use std::time::{Duration, Instant};

use rtf_monitor::{Formula, Monitor, Verdict};

const SIGNALS: usize = 50;
const RATE_HZ: u32 = 1000;

/// What the monitors of a robot look like. `a` to `d` are noisy waves; `a` and `c` are positive for
/// half of the time.
const FORMULAS: [&str; 10] = [
    "always(abs(a - b) < 3)",
    "always(a > 0 -> eventually[0,0.5s](abs(b - d) < 2))",
    "always(rise(a > 0) -> eventually[0,2s](always[0,0.2s](abs(c) < 2)))",
    "always[0,inf](abs(rate(a)) < 900)",
    "always(a > 0.9 -> always[0,50ms](b > -3 and c > -3))",
    "always((a > 0) since (b > -3) or once[0,1s](c > 0) or d < 4)",
    "always(min(a, b) > -3 and max(c, d) < 3)",
    "always(historically[0,100ms](a > 0.5) -> (a > -3 until[0,3s] a < 0.4))",
    "always(not (a > 2.5 and b > 2.5) or fall(c > 0))",
    "eventually(a > 1 and b > 1 and c > 1 and d > 1)",
];

/// A wave with noise that makes it cross each level many times.
fn value(signal: usize, step: u32) -> f64 {
    let time = f64::from(step) / f64::from(RATE_HZ);
    let phase = signal as f64;
    let noise = f64::from(step.wrapping_mul(2_654_435_761).wrapping_add(signal as u32 * 97) >> 20);
    (time * (1.0 + phase / 50.0) + phase).sin() + (noise / 4096.0 - 0.5) * 0.1
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let seconds: u32 = std::env::args().nth(1).map_or(Ok(60), |text| text.parse())?;
    let mut monitors = Vec::new();
    for (index, text) in FORMULAS.iter().enumerate() {
        let formula = Formula::parse(text)?;
        // Each monitor watches some of the signals, whose samples do not arrive at the same time.
        let signals: Vec<usize> =
            (0..formula.signals().len()).map(|signal| (index * 5 + signal * 7) % SIGNALS).collect();
        monitors.push((signals, Monitor::new(&formula)?, *text));
    }
    let (mut fed, mut longest) = (0_u64, Duration::ZERO);
    let mut spent = vec![Duration::ZERO; monitors.len()];
    let mut violations = vec![0; monitors.len()];
    for step in 0..seconds * RATE_HZ {
        for (index, (signals, monitor, _)) in monitors.iter_mut().enumerate() {
            let started = Instant::now();
            for (id, signal) in signals.iter().enumerate() {
                let time = (f64::from(step) + *signal as f64 / SIGNALS as f64) / f64::from(RATE_HZ);
                let violation = monitor.sample(id, time, value(*signal, step));
                violations[index] += usize::from(violation.is_some());
                fed += 1;
            }
            let took = started.elapsed();
            spent[index] += took;
            longest = longest.max(took);
        }
    }
    let mut output = std::io::stdout().lock();
    let total: Duration = spent.iter().sum();
    for (index, (_, monitor, text)) in monitors.iter_mut().enumerate() {
        let outcome = monitor.finish(f64::from(seconds));
        let verdict =
            if outcome.verdict == Verdict::Violated { "violated" } else { "not violated" };
        let nanos = spent[index].as_nanos() / u128::from(seconds * RATE_HZ);
        writeln!(output, "{nanos:6} ns per step  {verdict:12}  {text}")?;
    }
    let load = total.as_secs_f64() / f64::from(seconds) * 100.0;
    let rate = fed as f64 / total.as_secs_f64();
    writeln!(output, "{rate:.0} samples/s; {load:.2} % of a core at {RATE_HZ} Hz")?;
    writeln!(output, "longest step of a monitor: {} us", longest.as_micros())?;
    Ok(())
}
