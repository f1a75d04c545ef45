#[test]
fn is_broken() {
    let speed: u32 = "fast";
}
