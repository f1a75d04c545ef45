//! An arm.

/// The reach of an arm with this many joints, in metres.
///
/// ```
/// assert_eq!(arm::reach(3), 0.5); // Fails, but doc tests do not run.
/// ```
pub fn reach(joints: u32) -> f64 {
    0.25 * f64::from(joints)
}

#[cfg(test)]
mod tests {
    use super::reach;

    #[test]
    fn moves() {
        assert!(reach(2) > 0.0);
    }

    mod joints {
        #[test]
        fn are_counted() {
            assert_eq!(super::reach(4), 0.75, "four joints"); // line: are_counted
        }
    }
}
