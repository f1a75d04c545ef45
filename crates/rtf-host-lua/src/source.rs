//! Reads and compiles a plug-in's file, and detects its API style.

mod style;

use std::collections::HashMap;
use std::path::Path;

use mlua::chunk::ChunkMode;
use mlua::{Error, Function, Lua};
use rtf_host::LoadError;
use rtf_model::Location;

pub(crate) use style::Style;

/// A chunk name that Lua's messages can be split after: a path may contain colons.
const NAMELESS: &str = "=?";

pub(crate) struct CompiledFile {
    pub(crate) chunk: Function,
    pub(crate) style: Style,
}

/// A cache of compiled files, for tests that share a host.
#[derive(Default)]
pub(crate) struct CompiledFiles(HashMap<String, CachedFile>);

struct CachedFile {
    source: Vec<u8>,
    code: Vec<u8>,
    style: Style,
}

impl CompiledFiles {
    /// Compiles a file like [`compile`], unless the cache has the same content.
    pub(crate) fn compile(&mut self, lua: &Lua, name: &str) -> Result<CompiledFile, LoadError> {
        let source = read(Path::new(name), name)?;
        if let Some(known) = self.0.get(name).filter(|known| known.source == source) {
            let chunk = lua.load(known.code.as_slice()).set_mode(ChunkMode::Binary);
            let chunk = chunk
                .into_function()
                .map_err(|error| LoadError { message: error.to_string(), location: None })?;
            return Ok(CompiledFile { chunk, style: known.style });
        }
        let compiled = compile_source(lua, &source, name)?;
        let (code, style) = (compiled.chunk.dump(false), compiled.style);
        self.0.insert(name.to_owned(), CachedFile { source, code, style });
        Ok(compiled)
    }
}

/// Compiles a file without running it. `name` is its name in tracebacks.
pub(crate) fn compile(lua: &Lua, file: &Path, name: &str) -> Result<CompiledFile, LoadError> {
    compile_source(lua, &read(file, name)?, name)
}

fn read(file: &Path, name: &str) -> Result<Vec<u8>, LoadError> {
    let source = std::fs::read(file).map_err(|error| LoadError {
        message: format!("`{name}` cannot be read: {error}"),
        location: None,
    })?;
    Ok(strip_prefixes(source))
}

fn compile_source(lua: &Lua, source: &[u8], name: &str) -> Result<CompiledFile, LoadError> {
    let load = |chunk_name: &str| lua.load(source).set_name(chunk_name).into_function();
    let chunk = load(&format!("@{name}")).map_err(|error| {
        // Compiled again under a name that is easy to remove.
        let message = load(NAMELESS).err().map_or_else(|| error.to_string(), message_of);
        let (line, message) = split(&message);
        LoadError { message, location: Some(Location { file: name.to_owned(), line }) }
    })?;
    Ok(CompiledFile { chunk, style: Style::of(&String::from_utf8_lossy(source)) })
}

/// Removes a byte order mark and a first line for the shell (`#!/usr/bin/lua`), but not
/// its line break.
fn strip_prefixes(source: Vec<u8>) -> Vec<u8> {
    let source = source.strip_prefix(b"\xEF\xBB\xBF").map_or(source.clone(), <[u8]>::to_vec);
    if source.first() != Some(&b'#') {
        return source;
    }
    let end = source.iter().position(|&byte| byte == b'\n').unwrap_or(source.len());
    source[end..].to_vec()
}

fn message_of(error: Error) -> String {
    match error {
        Error::SyntaxError { message, .. } => message,
        error => error.to_string(),
    }
}

/// Splits `?:7: unexpected symbol near '='`.
fn split(message: &str) -> (u32, String) {
    let parts = message.strip_prefix("?:").and_then(|rest| rest.split_once(": "));
    match parts.and_then(|(line, text)| Some((line.parse().ok()?, text))) {
        Some((line, text)) => (line, text.to_owned()),
        None => (0, message.to_owned()),
    }
}
