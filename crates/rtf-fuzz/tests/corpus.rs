//! The targets with the inputs of the repository, among which are those that were found.

use rtf_fuzz::TARGETS;

#[test]
fn every_property_holds_for_every_stored_input() {
    for target in TARGETS {
        let inputs = target.replay().unwrap();
        assert!(inputs > 0, "the target `{}` has no inputs", target.name);
        println!("{:<20} {inputs} inputs", target.name);
    }
}
