//! Whether `LD_PRELOAD` has an effect on a program.

use std::fs::File;
use std::os::unix::fs::{FileExt as _, PermissionsExt as _};
use std::path::Path;

/// Offsets and values of the ELF format: `elf.h`, for 64 bits and this machine's byte order.
const IDENTIFICATION: [u8; 5] = [0x7f, b'E', b'L', b'F', 2];
const HEADER_BYTES: usize = 64;
const MACHINE: usize = 18;
const TABLE: usize = 32;
const ENTRY_BYTES: usize = 54;
const ENTRIES: usize = 56;
const INTERPRETER: u32 = 3;

/// The bits of a program that runs with rights of its owner, in which the linker ignores
/// `LD_PRELOAD`.
const SET_ID: u32 = 0o6000;

/// Whether the GNU C library's dynamic linker starts this program, and loads libraries that
/// the environment demands. False for scripts, static programs and those of other processors.
pub fn loads_libraries(file: &Path) -> bool {
    let interpreter = || -> Option<String> {
        let program = File::open(file).ok()?;
        let has_rights = program.metadata().ok()?.permissions().mode() & SET_ID != 0;
        let (own, header) = (header(&File::open("/proc/self/exe").ok()?)?, header(&program)?);
        let is_own =
            header.starts_with(&IDENTIFICATION) && header[MACHINE..][..2] == own[MACHINE..][..2];
        if has_rights || !is_own {
            return None;
        }
        interpreter(&program, &header)
    };
    interpreter().is_some_and(|path| {
        path.rsplit('/').next().is_some_and(|name| name.starts_with("ld-linux"))
    })
}

/// Whether a program, or one that it starts, may load libraries that the environment demands: it
/// is a script, or does so itself.
pub fn may_load_libraries(file: &Path) -> bool {
    let is_elf = File::open(file).ok().and_then(|file| header(&file));
    let is_elf = is_elf.is_some_and(|header| header.starts_with(&IDENTIFICATION[..4]));
    !is_elf || loads_libraries(file)
}

fn header(file: &File) -> Option<[u8; HEADER_BYTES]> {
    let mut header = [0; HEADER_BYTES];
    file.read_exact_at(&mut header, 0).ok()?;
    Some(header)
}

/// The path of a program's interpreter.
fn interpreter(file: &File, header: &[u8; HEADER_BYTES]) -> Option<String> {
    let short = |at: usize| u16::from_ne_bytes([header[at], header[at + 1]]);
    let table = u64::from_ne_bytes(header[TABLE..][..8].try_into().ok()?);
    for index in 0..u64::from(short(ENTRIES)) {
        let mut entry = [0; 56];
        file.read_exact_at(&mut entry, table + index * u64::from(short(ENTRY_BYTES))).ok()?;
        if u32::from_ne_bytes(entry[..4].try_into().ok()?) != INTERPRETER {
            continue;
        }
        let offset = u64::from_ne_bytes(entry[8..16].try_into().ok()?);
        let length = u64::from_ne_bytes(entry[32..40].try_into().ok()?);
        let mut path = vec![0; usize::try_from(length.min(4096)).ok()?];
        file.read_exact_at(&mut path, offset).ok()?;
        return Some(String::from_utf8_lossy(&path).trim_end_matches('\0').to_owned());
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_dynamic_programs_load_libraries() {
        assert!(loads_libraries(Path::new("/bin/sh")));
        assert!(loads_libraries(&std::env::current_exe().unwrap()));
        assert!(!loads_libraries(Path::new("/etc/passwd")));
        assert!(!loads_libraries(Path::new("/no/such/program")));
        let script = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(script.path(), format!("#!/bin/sh\n{}", " ".repeat(100))).unwrap();
        assert!(!loads_libraries(script.path()));
        assert!(may_load_libraries(script.path()) && may_load_libraries(Path::new("/bin/sh")));
    }
}
