//! Tests that start processes, see tests/frameworks/descendants.

#[cfg(test)]
mod tests {
    use std::ffi::{c_char, c_int, CString};

    extern "C" {
        fn descendants_hold(name: *const c_char) -> c_int;
    }

    fn hold(name: &str) {
        let name = CString::new(name).unwrap();
        // SAFETY: it reads the string.
        assert_eq!(unsafe { descendants_hold(name.as_ptr()) }, 1);
    }

    macro_rules! cases {
        ($($name:ident)*) => { $(#[test] fn $name() { hold(stringify!($name)); })* };
    }

    cases! {
        executes_itself executes_itself_twice needs_a_descendant_that_fails
        expects_a_descendant_that_fails executes_itself_without_environment
        expects_a_failure_without_environment spawns_itself
        needs_a_spawned_descendant_that_fails reads_what_a_descendant_prints
        has_an_environment_of_its_own forks_and_exits forks_and_exits_with_a_code
        forks_and_exits_at_once forks_and_aborts forks_and_returns forks_and_fails
        needs_a_fork_that_fails passes fails
    }

    /// The results of the inner run are no results of this one.
    #[test]
    fn runs_cargo_in_cargo() {
        let directory = std::env::temp_dir().join(format!("inner-{}", std::process::id()));
        std::fs::create_dir(&directory).unwrap();
        let manifest = "[package]\nname = \"inner\"\n[workspace]\n[lib]\npath = \"lib.rs\"\n";
        std::fs::write(directory.join("Cargo.toml"), manifest).unwrap();
        let tests = "#[test] fn inner_passes() {}\n#[test] fn inner_fails() { panic!() }\n";
        std::fs::write(directory.join("lib.rs"), tests).unwrap();
        let mut cargo = std::process::Command::new("cargo");
        cargo.args(["test", "--offline", "--lib"]).current_dir(&directory);
        let done = cargo.env("CARGO_TARGET_DIR", directory.join("target")).output().unwrap();
        std::fs::remove_dir_all(&directory).unwrap();
        let output = String::from_utf8_lossy(&done.stdout);
        print!("{output}");
        assert!(output.contains("1 passed; 1 failed"), "{done:?}");
    }
}
