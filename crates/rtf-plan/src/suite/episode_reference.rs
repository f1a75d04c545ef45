//! `${episode:name}`: a reference to a parameter of a campaign.
//!
//! A suite is planned once for all episodes, with this reference as the value of
//! `${param:name}`. `rtf-engine` replaces it whenever a process starts.

use rtf_model::Parameter;

use crate::placeholder;

const OPEN: &str = "${episode:";

/// Returns the reference to a parameter.
#[must_use]
pub fn to(name: &str) -> String {
    format!("{OPEN}{name}}}")
}

/// Checks whether a text contains a reference.
#[must_use]
pub fn mentions(text: &str) -> bool {
    text.contains(OPEN)
}

/// Replaces each reference by a text.
#[must_use]
pub fn replace(text: &str, with: &str) -> String {
    placeholder::replace(text, OPEN, |_| Some(with.into()))
}

/// Replaces the references to these parameters; others are kept.
#[must_use]
pub fn expand(text: &str, parameters: &[Parameter]) -> String {
    placeholder::replace(text, OPEN, |name| {
        let parameter = parameters.iter().find(|parameter| parameter.name == name)?;
        Some(parameter.value.as_str().into())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_are_replaced_and_the_rest_is_kept() {
        let value = "0.5".to_owned();
        let parameters = [Parameter { name: "payload".to_owned(), value }];
        let text = format!("--mass {} {}", to("payload"), to("other"));
        assert_eq!(expand(&text, &parameters), "--mass 0.5 ${episode:other}");
        assert_eq!(expand("${episode:payload", &parameters), "${episode:payload");
        assert_eq!(replace(&text, "1"), "--mass 1 1");
        assert!(mentions(&text) && !mentions("${param:payload}"));
    }
}
