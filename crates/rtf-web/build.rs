//! Creates the directory of the page, which other tools build, if it is not
//! there: what is embedded must have a place, and a change of it must be noticed.

fn main() -> std::io::Result<()> {
    let dist = "../../web/dist";
    std::fs::create_dir_all(dist)?;
    println!("cargo:rerun-if-changed={dist}");
    Ok(())
}
