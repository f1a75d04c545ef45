//! Hints that propose no change which a table could apply.

pub const HINTS: &[&str] = &[
    // What applies anyway.
    "its values outside of profiles apply",
    // Files that are no text, or too large for a table.
    "rename the file or its directory",
    "save it as UTF-8",
    "save the file as UTF-8",
    "split it into several suites",
    "limits have few levels",
    // Commands that show or run something else.
    "`rtf list s.xml` shows its tests",
    "`rtf campaign run` runs all episodes of a campaign, `rtf run --episode ID` one of them",
    "a campaign samples a large space of parameters",
    // About signals without a known unit, which a suite cannot have.
    "declare the unit of the signal, or write the constant without one",
    // The installation, and how a plug-in was built.
    "it is built and installed together with `rtf`",
    "it is installed together with `rtf`, in `share/rtf/fixtures`",
    "`rtf-host-lua --check` must exit with code 0",
    "the program was built for another system or processor",
    "link the plug-in with the library that defines it",
];
