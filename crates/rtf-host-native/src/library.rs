//! From a file to a plug-in's table, or to what is wrong with the file.
#![expect(unsafe_code, reason = "loading foreign code")]

use std::error::Error;
use std::mem::offset_of;
use std::path::Path;

use libloading::os::unix::{Library, RTLD_LAZY, RTLD_LOCAL, RTLD_NOW};
use rtf_host::{CheckedFile, Role};

use crate::abi::{RTF_ABI_MAJOR, RTF_KIND_FIXTURE, RTF_KIND_TEST, rtf_plugin_table};

/// The one symbol that a plug-in exports.
const SYMBOL: &str = "rtf_plugin";

/// What plug-ins of the predecessor export instead.
const OLD_SYMBOLS: [&str; 2] =
    ["robottestingframework_dll_factory", "robottestingframework_fixture_factory"];

/// Why a file is not a plug-in that this host can run.
#[derive(Debug, thiserror::Error)]
pub(crate) enum LibraryError {
    /// The loader refused it.
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
    /// Neither a test nor a fixture.
    #[error("its kind is {0}, neither a test nor a fixture")]
    Kind(i32),
    /// A function is missing without which it is no plug-in.
    #[error("its table has no `{0}` function")]
    Incomplete(&'static str),
    /// It is used as what it is not.
    #[error("is a {found}, not a {wanted}")]
    WrongRole {
        /// What it is.
        found: &'static str,
        /// As what it was to be loaded.
        wanted: &'static str,
    },
}

/// A loaded plug-in's table, valid until the process ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Table(pub(crate) &'static rtf_plugin_table);

impl Table {
    /// Loads a file and looks at its table. None of the plug-in's functions is
    /// called, but what the loader runs by itself (constructors of static
    /// objects) does run.
    pub(crate) fn load(file: &Path) -> Result<Self, LibraryError> {
        let file = if file.components().count() == 1 {
            Path::new(".").join(file)
        } else {
            file.to_owned()
        };
        // SAFETY: loading a library runs its initialisers. Whoever names a
        // plug-in wants it run; a crash in it is seen by the runner.
        let library = unsafe { Library::open(Some(&file), RTLD_NOW | RTLD_LOCAL) };
        let library = library.map_err(|error| LibraryError::Load(cause(&error, &file)))?;
        // Threads and thread-local destructors of the plug-in may outlive any
        // use of it, so that it stays until the process ends.
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
        // SAFETY: it has as many bytes as it says, and stays, by spec/plugin-abi.md.
        let table = unsafe { whole(table, found) };
        if table.create.is_none() {
            return Err(LibraryError::Incomplete("create"));
        }
        match table.kind {
            RTF_KIND_TEST if table.run.is_none() => Err(LibraryError::Incomplete("run")),
            RTF_KIND_TEST | RTF_KIND_FIXTURE => Ok(Self(table)),
            kind => Err(LibraryError::Kind(kind)),
        }
    }

    /// What the plug-in is.
    pub(crate) fn role(self) -> Role {
        if self.0.kind == RTF_KIND_FIXTURE { Role::Fixture } else { Role::Test }
    }

    /// The same, when it is what it is used as.
    pub(crate) fn used_as(self, role: Role) -> Result<Self, LibraryError> {
        if self.role() == role {
            Ok(self)
        } else {
            Err(LibraryError::WrongRole { found: word(self.role()), wanted: word(role) })
        }
    }
}

/// Says of a file whether it can be loaded, for `--check`.
pub(crate) fn check(file: &Path) -> CheckedFile {
    match Table::load(file) {
        Ok(table) => CheckedFile::good(file, Some(vec![word(table.role()).to_owned()])),
        Err(error) => CheckedFile::bad(file, error.to_string(), None),
    }
}

/// When the functions that a library calls are looked up.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Lookup {
    /// As they are called, which is the least work for one process.
    Lazy,
    /// At once: forks of this process need not look for them any more.
    Now,
}

/// Loads a library that plug-ins are likely to need, if it is there.
pub(crate) fn preload(name: &str, lookup: Lookup) {
    let lookup = match lookup {
        Lookup::Lazy => RTLD_LAZY,
        Lookup::Now => RTLD_NOW,
    };
    // SAFETY: only for libraries of the system, whose initialisers are known.
    let library = unsafe { Library::open(Some(name), lookup | RTLD_LOCAL) };
    std::mem::forget(library);
}

/// The table with all fields that this host knows: those that an older plug-in
/// does not have are null.
///
/// # Safety
/// `table` has `size` bytes, which stay until the process ends.
unsafe fn whole(table: *const rtf_plugin_table, size: usize) -> &'static rtf_plugin_table {
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

fn word(role: Role) -> &'static str {
    match role {
        Role::Test => "test",
        Role::Fixture => "fixture",
    }
}

/// The loader's own words, which name the missing library or symbol. The file
/// is named beside them already.
fn cause(error: &libloading::Error, file: &Path) -> String {
    let words = error.source().map_or_else(|| error.to_string(), ToString::to_string);
    let own = format!("{}: ", file.display());
    words.strip_prefix(&own).map(str::to_owned).unwrap_or(words)
}
