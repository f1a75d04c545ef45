//! YARP's network, for plug-ins that open ports without making a `yarp::os::Network`: in
//! robot-testing-framework 1.x and 2.x, a fixture in the same process had made one.
//!
//! There is no link to YARP: its functions are looked up in the library that a plug-in has loaded.
#![expect(unsafe_code, reason = "functions of a library that is already loaded")]

use std::ffi::{CStr, CString, c_int, c_void};

/// The library's name, up to its version; in YARP 2, the last two letters are capitals.
const LIBRARIES: [&[u8]; 2] = [b"libYARP_os.so", b"libYARP_OS.so"];

const INITIALIZED: &CStr = c"_ZN4yarp2os11NetworkBase11initializedEv";
const INIT: &CStr = c"_ZN4yarp2os11NetworkBase11initMinimumEv";
const FINISH: &CStr = c"_ZN4yarp2os11NetworkBase11finiMinimumEv";

/// YARP's network, which the host has initialised.
#[derive(Debug)]
pub(crate) struct YarpNetwork {
    finish: unsafe extern "C" fn(),
}

impl YarpNetwork {
    /// Initialises the network, if the library is loaded and the plug-in has not done so.
    pub(crate) fn init() -> Option<Self> {
        let library = loaded_library()?;
        // SAFETY: the functions of YARP with these names have these types in all its versions.
        unsafe {
            let init: unsafe extern "C" fn() = std::mem::transmute(function(library, INIT)?);
            let finish: unsafe extern "C" fn() = std::mem::transmute(function(library, FINISH)?);
            let initialized: unsafe extern "C" fn() -> bool =
                std::mem::transmute(function(library, INITIALIZED)?);
            if initialized() {
                return None;
            }
            init();
            Some(Self { finish })
        }
    }

    /// Undoes the initialisation. A network that the plug-in has made itself stays.
    pub(crate) fn finish(self) {
        // SAFETY: it takes nothing, and is called once for the initialisation.
        unsafe { (self.finish)() };
    }
}

fn function(library: *mut c_void, name: &CStr) -> Option<*mut c_void> {
    // SAFETY: the handle is open.
    let found = unsafe { libc::dlsym(library, name.as_ptr()) };
    (!found.is_null()).then_some(found)
}

/// A handle of the library, which is never closed.
fn loaded_library() -> Option<*mut c_void> {
    let mut path: Option<CString> = None;
    // SAFETY: `find` gets the address of `path`, which lives until the call returns.
    unsafe { libc::dl_iterate_phdr(Some(find), (&raw mut path).cast()) };
    // SAFETY: the library is loaded, so that no initialiser runs.
    let library = unsafe { libc::dlopen(path?.as_ptr(), libc::RTLD_LAZY | libc::RTLD_NOLOAD) };
    (!library.is_null()).then_some(library)
}

/// Keeps the path of the library; not 0 if it is found.
unsafe extern "C" fn find(info: *mut libc::dl_phdr_info, _size: usize, path: *mut c_void) -> c_int {
    // SAFETY: the loader passes valid information, with a null or a text that ends with zero.
    let name = unsafe {
        match (*info).dlpi_name {
            name if name.is_null() => return 0,
            name => CStr::from_ptr(name),
        }
    };
    let file = name.to_bytes().rsplit(|byte| *byte == b'/').next().unwrap_or_default();
    let is_found = LIBRARIES.iter().any(|library| file.starts_with(library));
    if is_found {
        // SAFETY: the address of an `Option<CString>`, by `loaded_library`.
        unsafe { *path.cast::<Option<CString>>() = Some(name.to_owned()) };
    }
    c_int::from(is_found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_the_library_there_is_no_network() {
        assert!(YarpNetwork::init().is_none());
    }
}
