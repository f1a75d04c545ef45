//! The program that the kernel starts to run an executable file: the interpreter of a script, or
//! the dynamic linker. Without it, the system reports that the file itself is missing.

/// How many bytes at the start of a file [`Interpreter::of`] needs.
pub const INTERPRETER_BYTES: usize = 4096;

/// The kernel truncates the first line of a script here.
const MAX_LINE_BYTES: usize = 255;

/// What an executable file needs to start.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Interpreter {
    /// The path of the interpreter or of the dynamic linker, without a carriage return.
    pub path: String,
    /// The program that `env` searches in `PATH`.
    pub searched: Option<String>,
    /// Whether the first line ends with a carriage return, which becomes part of the path or of
    /// its argument.
    pub has_return: bool,
    is_script: bool,
}

/// Why a file cannot be started although it exists.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InterpreterProblem {
    /// The problem of the file, "its interpreter … does not exist".
    pub message: String,
    /// What to do.
    pub hint: &'static str,
}

impl Interpreter {
    /// The interpreter that the first bytes of a file name.
    #[must_use]
    pub fn of(head: &[u8]) -> Option<Self> {
        match head.strip_prefix(b"#!") {
            Some(line) => Self::of_script(line),
            None => {
                let path = std::str::from_utf8(elf_interpreter(head)?).ok()?.to_owned();
                Some(Self { path, searched: None, has_return: false, is_script: false })
            }
        }
    }

    fn of_script(line: &[u8]) -> Option<Self> {
        let end = line.iter().position(|byte| *byte == b'\n').unwrap_or(line.len());
        let line = std::str::from_utf8(&line[..end.min(MAX_LINE_BYTES)]).ok()?;
        let mut words = line.split([' ', '\t', '\r']).filter(|word| !word.is_empty());
        let path = words.next()?.to_owned();
        let is_env = path.rsplit('/').next() == Some("env");
        let searched = words.find(|word| *word != "-S").filter(|_| is_env);
        let searched = searched.filter(|word| !word.starts_with('-') && !word.contains('='));
        let has_return = line.ends_with('\r');
        Some(Self { path, searched: searched.map(str::to_owned), has_return, is_script: true })
    }

    /// Why the file cannot be started, if `exists` returns whether there is a file.
    pub fn problem(&self, exists: impl FnOnce(&str) -> bool) -> Option<InterpreterProblem> {
        let Self { path, .. } = self;
        if self.has_return {
            let message = format!(
                "its first line, which names its interpreter `{path}`, ends with a carriage \
                 return, as on Windows"
            );
            return Some(InterpreterProblem {
                message,
                hint: "remove them: `sed -i 's/\\r$//' FILE`",
            });
        }
        // The kernel resolves another path in the working directory.
        if !path.starts_with('/') || exists(path) {
            return None;
        }
        Some(match self.is_script {
            true => InterpreterProblem {
                message: format!("its interpreter `{path}` does not exist"),
                hint: "install it, or correct the first line of the file",
            },
            false => InterpreterProblem {
                message: format!("its dynamic linker `{path}` does not exist"),
                hint: "the program was built for another system or processor",
            },
        })
    }
}

/// The contents of `PT_INTERP` of an ELF file with little-endian numbers.
fn elf_interpreter(head: &[u8]) -> Option<&[u8]> {
    const PT_INTERP: usize = 3;
    let is_64_bit = match head.get(..6)? {
        [0x7f, b'E', b'L', b'F', 1, 1] => false,
        [0x7f, b'E', b'L', b'F', 2, 1] => true,
        _ => return None,
    };
    let number = |at: usize, bytes: usize| -> Option<usize> {
        let bytes = head.get(at..at.checked_add(bytes)?)?;
        Some(bytes.iter().rev().fold(0, |number, byte| number << 8 | usize::from(*byte)))
    };
    let (table, size, count) = match is_64_bit {
        true => (number(0x20, 8)?, number(0x36, 2)?, number(0x38, 2)?),
        false => (number(0x1c, 4)?, number(0x2a, 2)?, number(0x2c, 2)?),
    };
    let entries = (0..count).map_while(|index| table.checked_add(index.checked_mul(size)?));
    let mut interpreters = entries.filter(|entry| number(*entry, 4) == Some(PT_INTERP));
    let entry = interpreters.next()?;
    let (start, length) = match is_64_bit {
        true => (number(entry.checked_add(0x08)?, 8)?, number(entry.checked_add(0x20)?, 8)?),
        false => (number(entry.checked_add(0x04)?, 4)?, number(entry.checked_add(0x10)?, 4)?),
    };
    head.get(start..start.checked_add(length)?)?.split(|byte| *byte == 0).next()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn problem(head: &[u8]) -> Option<String> {
        let problem =
            Interpreter::of(head)?.problem(|path| path == "/bin/sh" || path == "/usr/bin/env");
        problem.map(|problem| problem.message)
    }

    #[test]
    fn a_script_needs_its_interpreter_and_line_ends_of_unix() {
        assert_eq!(problem(b"#!/bin/sh -e\necho\r\n"), None);
        assert_eq!(problem(b"#! /bin/sh"), None);
        assert_eq!(problem(b"#!bin/sh\n"), None);
        assert_eq!(problem(b"echo\r\n"), None);
        assert_eq!(problem(b"#!\n"), None);
        let missing = problem(b"#!/usr/bin/nowhere -x\n").unwrap();
        assert_eq!(missing, "its interpreter `/usr/bin/nowhere` does not exist");
        for head in [&b"#!/bin/sh\r\n"[..], b"#!/bin/sh -e\r\n", b"#!/usr/bin/env python3\r\n"] {
            let text = problem(head).unwrap();
            assert!(text.contains("ends with a carriage return"), "{text}");
            assert!(!text.contains('\r'), "{text}");
        }
    }

    #[test]
    fn env_searches_a_program() {
        let searched = |head: &[u8]| Interpreter::of(head).unwrap().searched;
        assert_eq!(searched(b"#!/usr/bin/env python3\n").as_deref(), Some("python3"));
        assert_eq!(searched(b"#!/usr/bin/env -S python3 -u\n").as_deref(), Some("python3"));
        for head in [&b"#!/usr/bin/env -i x\n"[..], b"#!/usr/bin/env A=1 x\n", b"#!/bin/sh x\n"] {
            assert_eq!(searched(head), None);
        }
    }

    #[test]
    fn a_program_needs_its_dynamic_linker() {
        let mut elf = vec![0; 200];
        elf[..6].copy_from_slice(b"\x7fELF\x02\x01");
        (elf[0x20], elf[0x36], elf[0x38]) = (64, 56, 1);
        (elf[64], elf[64 + 8], elf[64 + 0x20]) = (3, 150, 11);
        elf[150..161].copy_from_slice(b"/lib/ld.so\0");
        let missing = problem(&elf).unwrap();
        assert_eq!(missing, "its dynamic linker `/lib/ld.so` does not exist");
        for length in 0..elf.len() {
            let _ = Interpreter::of(&elf[..length]);
        }
        assert_eq!(Interpreter::of(&[b"\x7fELF\x02\x01".as_slice(), &[0xff; 99]].concat()), None);
    }
}
