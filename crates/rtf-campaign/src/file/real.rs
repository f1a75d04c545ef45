//! Reads real numbers from attributes.

use roxmltree::Node;
use rtf_plan::suite::{ElementReader, Spanned};

/// Reads a finite number. Reports an invalid or missing one.
pub(super) fn required(
    reader: &mut ElementReader<'_>,
    node: Node<'_, '_>,
    name: &str,
) -> Option<Spanned<f64>> {
    let Some(attribute) = reader.attribute(node, name) else {
        reader.missing(node, &format!("the attribute `{name}`"));
        return None;
    };
    let number = attribute.value.trim().parse::<f64>().ok().filter(|number| number.is_finite());
    if number.is_none() {
        reader.wrong(name, &attribute, "is not a number like `0.5` or `1e-3`", None);
    }
    Some(Spanned::new(number?, attribute.span))
}

/// Reads a number between 0 and `below`, both excluded.
pub(super) fn between_zero_and(
    reader: &mut ElementReader<'_>,
    node: Node<'_, '_>,
    name: &str,
    below: f64,
) -> Option<Spanned<f64>> {
    let number = required(reader, node, name)?;
    let valid = number.value > 0.0 && number.value < below;
    if !valid {
        let text = Spanned::new(number.value.to_string(), number.span);
        let expected = if below.is_finite() {
            format!("has to be between 0 and {below}, both excluded")
        } else {
            "has to be above 0".to_owned()
        };
        reader.wrong(name, &text, &expected, None);
    }
    valid.then_some(number)
}

/// Reads two numbers of which the first has to be less than the second.
pub(super) fn ascending(
    reader: &mut ElementReader<'_>,
    node: Node<'_, '_>,
    names: [&str; 2],
) -> Option<[f64; 2]> {
    let [low, high] = names.map(|name| required(reader, node, name));
    let (low, high) = (low?, high?);
    // The difference of two large numbers is not finite.
    let valid = low.value < high.value && (high.value - low.value).is_finite();
    if !valid {
        let text = Spanned::new(high.value.to_string(), high.span);
        let expected = format!("has to be greater than `{}`, {}", names[0], low.value);
        reader.wrong(names[1], &text, &expected, None);
    }
    valid.then_some([low.value, high.value])
}
