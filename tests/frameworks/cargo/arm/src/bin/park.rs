fn main() {}

#[test]
fn parks() {}
