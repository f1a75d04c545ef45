//! Scratch.
mod render;
fn main() {}
