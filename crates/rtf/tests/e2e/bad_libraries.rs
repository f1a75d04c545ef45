//! Shared libraries that are not plug-ins, or cannot be loaded.

use std::process::Command;

use insta::assert_snapshot;

use crate::bad_input::refused;
use crate::bad_plugins::folder;
use crate::support::{Folder, root};

/// Builds a library from C.
pub fn build_c(folder: &Folder, name: &str, text: &str) {
    let source = folder.path().join("plugin.c");
    std::fs::write(&source, format!("#include <rtf/plugin.h>\n{text}")).expect("a file");
    let mut compiler = Command::new("cc");
    compiler.args(["-std=c99", "-shared", "-fPIC", "-o"]).arg(folder.path().join(name));
    compiler.arg("-I").arg(root().join("sdk/c/include")).arg(&source);
    let output = compiler.output().expect("a C compiler");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    std::fs::remove_file(source).expect("the source");
}

/// The source of a test that does `body`, for a version of the interface.
fn table(major: &str, body: &str) -> String {
    format!(
        "static void *create(const rtf_host *host) {{ return (void *)host; }}\n\
         static int32_t run(void *self) {{ (void)self; {body} return RTF_DONE; }}\n\
         static const rtf_plugin_table table = {{\n    .abi_major = {major}, .size = sizeof table, \
         .kind = RTF_KIND_TEST,\n    .create = create, .run = run}};\n\
         const rtf_plugin_table *rtf_plugin(void) {{ return &table; }}\n"
    )
}

/// The same table with the right version runs: the tests below fail for the
/// reason that they name.
#[test]
fn a_table_of_the_right_version_is_a_test() {
    let folder = folder("<test>Plugin.so</test>");
    build_c(&folder, "Plugin.so", &table("RTF_ABI_MAJOR", ""));
    let finished = folder.rtf(&["run", "arm.xml"]);
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
}

#[test]
fn another_version_of_the_interface() {
    let folder = folder("<test>Plugin.so</test>");
    build_c(&folder, "Plugin.so", &table("RTF_ABI_MAJOR + 1", ""));
    assert_snapshot!(refused(&folder, &["run", "arm.xml"]), @"
    error: the plug-in `Plugin.so` cannot be loaded: was built for version 2 of the plug-in interface, this host has version 1: build it again
     --> arm.xml:2:9
      |
    2 |   <test>Plugin.so</test>
      |         ^^^^^^^^^ needed here
      |
      = note: the file is [FOLDER]/Plugin.so

    1 error; nothing was started
    ");
}

#[test]
fn a_library_that_is_no_plug_in() {
    let folder = folder("<test>Plugin.so</test>");
    build_c(&folder, "Plugin.so", "int answer(void) { return 42; }\n");
    assert_snapshot!(refused(&folder, &["run", "arm.xml"]), @"
    error: the plug-in `Plugin.so` cannot be loaded: exports no `rtf_plugin`: is there an RTF_PLUGIN(Class) in it?
     --> arm.xml:2:9
      |
    2 |   <test>Plugin.so</test>
      |         ^^^^^^^^^ needed here
      |
      = note: the file is [FOLDER]/Plugin.so

    1 error; nothing was started
    ");
}

#[test]
fn an_undefined_symbol() {
    let folder = folder("<test>Plugin.so</test>");
    let text = format!("extern void move_arm(void);\n{}", table("RTF_ABI_MAJOR", "move_arm();"));
    build_c(&folder, "Plugin.so", &text);
    assert_snapshot!(refused(&folder, &["run", "arm.xml"]), @"
    error: the plug-in `Plugin.so` cannot be loaded: undefined symbol: move_arm
     --> arm.xml:2:9
      |
    2 |   <test>Plugin.so</test>
      |         ^^^^^^^^^ needed here
      |
      = note: the file is [FOLDER]/Plugin.so
      = help: link the plug-in with the library that defines it

    1 error; nothing was started
    ");
}

#[test]
fn a_file_that_is_no_library() {
    let folder = folder("<test>Plugin.so</test>");
    folder.file("Plugin.so", "no library\n");
    assert_snapshot!(refused(&folder, &["run", "arm.xml"]), @"
    error: the plug-in `Plugin.so` cannot be loaded: file too short
     --> arm.xml:2:9
      |
    2 |   <test>Plugin.so</test>
      |         ^^^^^^^^^ needed here
      |
      = note: the file is [FOLDER]/Plugin.so

    1 error; nothing was started
    ");
}
