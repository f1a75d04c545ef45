//! The shared libraries that a program or a library needs: the dynamic section of an ELF file of
//! 64 bits, little-endian. Other files need none.

use std::fs::File;
use std::io::{Read as _, Seek as _, SeekFrom};
use std::path::{Path, PathBuf};

use rtf_plan::plan::SuitePlan;

use super::scripts::variable;

/// The longest table that is read.
const MAX_TABLE: u64 = 16 * 1024 * 1024;

/// Types of segments, and tags of the dynamic section.
const LOAD: u64 = 1;
const DYNAMIC: u64 = 2;
const NEEDED: u64 = 1;
const STRING_TABLE: u64 = 5;
const STRING_TABLE_SIZE: u64 = 10;
const RPATH: u64 = 15;
const RUNPATH: u64 = 29;

/// The directories in which libraries are searched for, apart from those of the system.
#[derive(Debug, Default)]
pub(super) struct Libraries {
    dirs: Vec<PathBuf>,
}

impl Libraries {
    pub fn of_suite(suite: &SuitePlan) -> Self {
        let value = variable(suite, "LD_LIBRARY_PATH");
        let dirs = value.iter().flat_map(|dirs| std::env::split_paths(dirs));
        let dirs = dirs.filter(|dir| !dir.as_os_str().is_empty());
        Self { dirs: dirs.map(|dir| suite.folder.join(dir)).collect() }
    }

    /// The libraries that a file needs and that are not the system's.
    pub fn needed_by(&self, file: &Path) -> Vec<PathBuf> {
        let Some(Dynamic { needed, paths }) = read(file) else { return Vec::new() };
        let origin = file.canonicalize().unwrap_or_else(|_| file.to_owned());
        let origin = origin.parent().unwrap_or(Path::new("/")).to_string_lossy();
        let of_file = paths.iter().flat_map(|dirs| dirs.split(':')).map(|dir| {
            PathBuf::from(dir.replace("${ORIGIN}", &origin).replace("$ORIGIN", &origin))
        });
        let dirs: Vec<_> = of_file.chain(self.dirs.iter().cloned()).collect();
        let find =
            |name: &String| dirs.iter().map(|dir| dir.join(name)).find(|file| file.is_file());
        needed.iter().filter_map(find).collect()
    }
}

#[derive(Debug, Default)]
struct Dynamic {
    /// Names of libraries.
    needed: Vec<String>,
    /// Directories, separated by colons.
    paths: Vec<String>,
}

/// Reads the dynamic section; `None` if there is none.
fn read(path: &Path) -> Option<Dynamic> {
    let mut file = File::open(path).ok()?;
    let mut header = [0; 64];
    file.read_exact(&mut header).ok()?;
    if !header.starts_with(b"\x7fELF\x02\x01") {
        return None;
    }
    let (entry, count) = (number(&header, 54, 2)?, number(&header, 56, 2)?);
    let segments = table(&mut file, number(&header, 32, 8)?, entry * count)?;
    // Type, offset in the file, address, size in the file.
    let segments: Vec<_> = segments
        .chunks_exact(usize::try_from(entry).ok().filter(|entry| *entry > 0)?)
        .filter_map(|it| {
            Some([number(it, 0, 4)?, number(it, 8, 8)?, number(it, 16, 8)?, number(it, 32, 8)?])
        })
        .collect();
    let [_, offset, _, size] = segments.iter().find(|it| it[0] == DYNAMIC)?;
    let dynamic = table(&mut file, *offset, *size)?;
    let tags =
        || dynamic.chunks_exact(16).filter_map(|it| Some((number(it, 0, 8)?, number(it, 8, 8)?)));
    let value = |wanted| tags().find(|(tag, _)| *tag == wanted).map(|(_, value)| value);
    let address = value(STRING_TABLE)?;
    let in_file = |[kind, offset, start, size]: &[u64; 4]| {
        let inside = address.checked_sub(*start).filter(|inside| *kind == LOAD && inside < size)?;
        offset.checked_add(inside)
    };
    let strings = segments.iter().find_map(in_file)?;
    let strings = table(&mut file, strings, value(STRING_TABLE_SIZE)?)?;
    let text = |at: u64| {
        let rest = strings.get(usize::try_from(at).ok()?..)?;
        let text = rest.split(|byte| *byte == 0).next()?;
        Some(String::from_utf8_lossy(text).into_owned())
    };
    let texts = |wanted: &[u64]| {
        let found = tags().filter(|(tag, _)| wanted.contains(tag));
        found.filter_map(|(_, value)| text(value)).collect()
    };
    Some(Dynamic { needed: texts(&[NEEDED]), paths: texts(&[RUNPATH, RPATH]) })
}

fn table(file: &mut File, offset: u64, size: u64) -> Option<Vec<u8>> {
    let size = usize::try_from(size).ok().filter(|_| size <= MAX_TABLE)?;
    let mut bytes = vec![0; size];
    file.seek(SeekFrom::Start(offset)).ok()?;
    file.read_exact(&mut bytes).ok()?;
    Some(bytes)
}

/// A little-endian number of up to 8 bytes.
fn number(bytes: &[u8], at: usize, size: usize) -> Option<u64> {
    let bytes = bytes.get(at..at.checked_add(size)?)?;
    Some(bytes.iter().rev().fold(0, |number, byte| number << 8 | u64::from(*byte)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_program_needs_the_c_library() {
        let program = std::env::current_exe().unwrap();
        let found = read(&program).expect("a dynamic section");
        assert!(found.needed.iter().any(|name| name.starts_with("libc.so")), "{found:?}");
    }

    #[test]
    fn other_files_need_nothing() {
        let dir = tempfile::tempdir().unwrap();
        let header = [b"\x7fELF\x02\x01".as_slice(), &[0xff; 200]].concat();
        for bytes in [&b"#!/bin/sh\n"[..], &header[..40], &header] {
            let file = dir.path().join("file");
            std::fs::write(&file, bytes).unwrap();
            assert!(read(&file).is_none());
            assert_eq!(Libraries::default().needed_by(&file), Vec::<PathBuf>::new());
        }
    }
}
