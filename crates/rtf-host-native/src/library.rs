//! Loads a plug-in's library and checks its table.
#![expect(unsafe_code, reason = "loading foreign code")]

use std::error::Error;
use std::mem::offset_of;
use std::path::Path;

use libloading::os::unix::{Library, RTLD_LAZY, RTLD_LOCAL, RTLD_NOW};
use rtf_host::{CheckedFile, PluginKind};

use crate::abi::{RTF_ABI_MAJOR, RTF_KIND_FIXTURE, RTF_KIND_TEST, rtf_plugin_table};

/// The one symbol that a plug-in exports.
const SYMBOL: &str = "rtf_plugin";

/// The symbols of plug-ins that were built for the predecessor.
const OLD_SYMBOLS: [&str; 2] =
    ["robottestingframework_dll_factory", "robottestingframework_fixture_factory"];

/// Why a file is not a plug-in that this host can run.
#[derive(Debug, thiserror::Error)]
pub(crate) enum LibraryError {
    /// The loader rejected it.
    #[error("cannot be loaded: {0}")]
    Load(String),
    /// It exports no plug-in.
    #[error("exports no `{SYMBOL}`: is there an RTF_PLUGIN(Class) in it?")]
    NoSymbol,
    /// It was built for the predecessor.
    #[error(
        "was built for robot-testing-framework 2: build it again with rtf; \
         its source need not change"
    )]
    Predecessor,
    /// `rtf_plugin` returned null.
    #[error("`{SYMBOL}` returned no table")]
    NoTable,
    /// It was built for another version.
    #[error(
        "was built for version {found} of the plug-in interface, this host has version \
         {RTF_ABI_MAJOR}: build it again"
    )]
    Version {
        /// The plug-in's version.
        found: u32,
    },
    /// The table is shorter than in the first minor version.
    #[error("its table has {found} bytes instead of {wanted}")]
    Size {
        /// The plug-in's size.
        found: usize,
        /// The smallest size of this version.
        wanted: usize,
    },
    /// It is neither a test nor a fixture.
    #[error("its kind is {0}, neither a test nor a fixture")]
    Kind(i32),
    /// A function is missing without which it is no plug-in.
    #[error("its table has no `{0}` function")]
    Incomplete(&'static str),
    /// A test is used as a fixture, or the reverse.
    #[error("is a {found}, not a {wanted}")]
    WrongKind {
        /// The plug-in's kind.
        found: &'static str,
        /// The kind that the suite needs.
        wanted: &'static str,
    },
}

/// A loaded plug-in's table, valid until the process ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PluginTable(pub(crate) &'static rtf_plugin_table);

impl PluginTable {
    /// Loads a file and checks its table. Calls none of the plug-in's functions, but the
    /// loader runs constructors of static objects.
    pub(crate) fn load(file: &Path) -> Result<Self, LibraryError> {
        let file = if file.components().count() == 1 {
            Path::new(".").join(file)
        } else {
            file.to_owned()
        };
        // SAFETY: loading a library runs its initialisers, as the user wants; the runner
        // detects a crash.
        let library = unsafe { Library::open(Some(&file), RTLD_NOW | RTLD_LOCAL) };
        let library = library.map_err(|error| LibraryError::Load(cause(&error, &file)))?;
        // Never unloaded: the plug-in's threads and thread-local destructors may outlive
        // its last use.
        let library = std::mem::ManuallyDrop::new(library);
        // SAFETY: the type is that of every symbol of this name.
        let symbol =
            unsafe { library.get::<unsafe extern "C" fn() -> *const rtf_plugin_table>(SYMBOL) };
        let Ok(entry) = symbol else {
            // SAFETY: looked up, never called.
            let old = OLD_SYMBOLS.iter().any(|name| unsafe { library.get::<fn()>(*name) }.is_ok());
            return Err(if old { LibraryError::Predecessor } else { LibraryError::NoSymbol });
        };
        // SAFETY: it takes nothing and returns a table, by spec/plugin-abi.md.
        Self::examine(unsafe { entry() })
    }

    fn examine(table: *const rtf_plugin_table) -> Result<Self, LibraryError> {
        if table.is_null() {
            return Err(LibraryError::NoTable);
        }
        // SAFETY: in every version a table begins with the major version.
        let found = unsafe { (*table).abi_major };
        if found != RTF_ABI_MAJOR {
            return Err(LibraryError::Version { found });
        }
        let wanted = offset_of!(rtf_plugin_table, test_started);
        // SAFETY: in every minor version of this major version the size follows.
        let found = unsafe { (*table).size };
        if found < wanted {
            return Err(LibraryError::Size { found, wanted });
        }
        // SAFETY: by spec/plugin-abi.md, it has `size` bytes and is never freed.
        let table = unsafe { complete(table, found) };
        if table.create.is_none() {
            return Err(LibraryError::Incomplete("create"));
        }
        match table.kind {
            RTF_KIND_TEST if table.run.is_none() => Err(LibraryError::Incomplete("run")),
            RTF_KIND_TEST | RTF_KIND_FIXTURE => Ok(Self(table)),
            kind => Err(LibraryError::Kind(kind)),
        }
    }

    pub(crate) fn kind(self) -> PluginKind {
        if self.0.kind == RTF_KIND_FIXTURE { PluginKind::Fixture } else { PluginKind::Test }
    }

    /// The table, if the plug-in is of this kind.
    pub(crate) fn require(self, kind: PluginKind) -> Result<Self, LibraryError> {
        if self.kind() == kind {
            Ok(self)
        } else {
            Err(LibraryError::WrongKind { found: word(self.kind()), wanted: word(kind) })
        }
    }
}

/// Checks whether a file can be loaded, for `--check`.
pub(crate) fn check(file: &Path) -> CheckedFile {
    match PluginTable::load(file) {
        Ok(table) => CheckedFile::good(file, Some(vec![word(table.kind()).to_owned()])),
        Err(error) => CheckedFile::bad(file, error.to_string(), None),
    }
}

/// When the loader resolves the functions that a library calls.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Lookup {
    /// With the first call, which is the least work for one process.
    Lazy,
    /// At once, for all forks of this process.
    Now,
}

/// Loads a library that plug-ins are likely to need, if it is installed.
pub(crate) fn preload(name: &str, lookup: Lookup) {
    let lookup = match lookup {
        Lookup::Lazy => RTLD_LAZY,
        Lookup::Now => RTLD_NOW,
    };
    // SAFETY: only for libraries of the system, whose initialisers are known.
    let library = unsafe { Library::open(Some(name), lookup | RTLD_LOCAL) };
    std::mem::forget(library);
}

/// The table with all fields of this host's version: those that an older plug-in does not
/// have are null.
///
/// # Safety
/// `table` has `size` bytes, which are never freed.
unsafe fn complete(table: *const rtf_plugin_table, size: usize) -> &'static rtf_plugin_table {
    if size >= size_of::<rtf_plugin_table>() {
        // SAFETY: the caller's promise.
        return unsafe { &*table };
    }
    let mut copy = std::mem::MaybeUninit::<rtf_plugin_table>::zeroed();
    // SAFETY: the caller's promise; all fields may be zero, which makes functions null.
    unsafe {
        std::ptr::copy_nonoverlapping(table.cast::<u8>(), copy.as_mut_ptr().cast::<u8>(), size);
        Box::leak(Box::new(copy.assume_init()))
    }
}

fn word(kind: PluginKind) -> &'static str {
    match kind {
        PluginKind::Test => "test",
        PluginKind::Fixture => "fixture",
    }
}

/// The loader's message, which names the missing library or symbol, without the file's name.
fn cause(error: &libloading::Error, file: &Path) -> String {
    let message = error.source().map_or_else(|| error.to_string(), ToString::to_string);
    let own = format!("{}: ", file.display());
    message.strip_prefix(&own).map(str::to_owned).unwrap_or(message)
}
