//! Its test program is none of Rust's harness.

fn main() {
    println!("all is well");
}
