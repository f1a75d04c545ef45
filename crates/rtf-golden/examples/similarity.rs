//! Prints the difference of two pictures for each line `PICTURE;REFERENCE` of the standard input. For
//! `tests/golden/pictures.py`.

use std::error::Error;
use std::io::{BufRead, Write};

use rtf_golden::{Picture, PictureDifference};

fn main() -> Result<(), Box<dyn Error>> {
    let mut out = std::io::stdout().lock();
    for line in std::io::stdin().lock().lines() {
        let line = line?;
        let (got, expected) = line.split_once(';').ok_or("expected two paths")?;
        let read = |path: &str| -> Result<Picture, Box<dyn Error>> {
            Ok(Picture::decode(&std::fs::read(path)?)?)
        };
        let difference = PictureDifference::of(&read(got)?, &read(expected)?)?;
        writeln!(out, "{:?}", difference.size)?;
    }
    Ok(())
}
