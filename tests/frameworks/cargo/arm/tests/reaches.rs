use std::io::Write as _;

#[test]
fn passes() {
    assert_eq!(arm::reach(2), 0.5);
}

#[test]
fn fails() {
    assert!(arm::reach(2) > 1.0, "the elbow is \"off\"\nand late"); // line: fails
}

#[test]
fn differs() {
    assert_eq!("first\nsecond", "third"); // line: differs
}

#[test]
fn unwraps() {
    let speed: Result<f64, _> = "seven".parse();
    speed.unwrap(); // line: unwraps
}

#[test]
fn returns_error() -> Result<(), String> {
    Err("no robot, \"left\"".to_owned())
}

#[test]
#[ignore = "needs a gripper, left"]
fn is_ignored() {}

#[test]
#[ignore]
fn is_ignored_without_reason() {}

#[test]
#[should_panic(expected = "too fast")]
fn should_panic() {
    panic!("much too fast");
}

#[test]
#[should_panic]
fn should_panic_but_returns() {} // line: should_panic_but_returns

#[test]
#[should_panic(expected = "too fast")]
fn should_panic_otherwise() {
    panic!("too slow"); // line: should_panic_otherwise
}

#[test]
fn prints() {
    println!("to stdout: <ä>");
    eprintln!("to stderr");
    print!("without end");
}

#[test]
fn prints_report() {
    println!("test result: FAILED. 0 passed; 1 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.00s");
    println!("test prints_report ... FAILED");
}

#[test]
fn panics_in_thread() {
    std::thread::spawn(|| panic!("lost arm")).join().unwrap_err();
}

#[test]
fn is_in_its_package() {
    assert!(std::path::Path::new("Cargo.toml").exists());
    assert_eq!(std::env::var("CARGO_PKG_VERSION_MAJOR").as_deref(), Ok("0"));
    assert_eq!(std::env::var("CARGO_PKG_NAME").as_deref(), Ok("arm"));
    assert_eq!(
        std::env::var("CARGO_MANIFEST_DIR").map(Into::into),
        Ok(std::env::current_dir().unwrap())
    );
    let park = std::process::Command::new(env!("CARGO_BIN_EXE_park")).status();
    assert!(park.unwrap().success());
}

#[test]
fn größe_ist_ok() {}

/// The second panic ends the process.
#[test]
fn panics_twice() {
    struct Arm;
    impl Drop for Arm {
        fn drop(&mut self) {
            panic!("cannot park");
        }
    }
    let _arm = Arm;
    panic!("too hot"); // line: panics_twice
}

#[test]
fn aborts() {
    std::io::stdout().write_all(b"about to abort\n").unwrap();
    std::process::abort();
}

#[test]
fn exits() {
    std::process::exit(0);
}

#[test]
fn exits_as_if_failed() {
    std::process::exit(101);
}

#[test]
fn hangs() {
    wait_for_robot();
}

#[inline(never)]
fn wait_for_robot() {
    loop {
        std::thread::sleep(std::time::Duration::from_secs(1000));
    }
}
