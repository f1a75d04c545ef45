//! Rebuilds `rtf` when a file is added to the templates, which it embeds.

fn main() {
    println!("cargo:rerun-if-changed=templates");
}
