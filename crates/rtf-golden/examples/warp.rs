//! Prints the distance of two sequences for each line `RADIUS;VALUE,VALUE,…;VALUE,…` of the standard
//! input, or `none`. For `tests/golden/warping.py`.

use std::io::{BufRead, Error, Write};

fn main() -> Result<(), Error> {
    let mut out = std::io::stdout().lock();
    for line in std::io::stdin().lock().lines() {
        let line = line?;
        let mut parts = line.split(';');
        let radius = parts.next().and_then(|text| text.parse().ok()).unwrap_or_default();
        let mut values = || -> Vec<f64> {
            let text = parts.next().unwrap_or_default();
            text.split(',').filter_map(|number| number.parse().ok()).collect()
        };
        let (first, second) = (values(), values());
        match rtf_golden::warp(&first, &second, radius) {
            Some(warp) => writeln!(out, "{:?}", warp.distance)?,
            None => writeln!(out, "none")?,
        }
    }
    Ok(())
}
