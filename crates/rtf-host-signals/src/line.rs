//! A line of a program: its time and its values.

/// Parses a line into `values`, one for each signal, and returns its time, if lines have one.
/// `None` as a value is no sample.
///
/// # Errors
/// What the line should be.
pub(crate) fn parse(
    line: &str,
    has_time: bool,
    values: &mut [Option<f64>],
) -> Result<Option<f64>, String> {
    let count = values.len();
    let expected = || {
        let time = if has_time { "a time and " } else { "" };
        let noun = if count == 1 { "value" } else { "values" };
        format!("expected {time}{count} {noun}, separated by white space")
    };
    let mut fields = line.split_ascii_whitespace();
    let time = match has_time {
        true => {
            let time = fields.next().and_then(number).filter(|time| time.is_finite());
            Some(time.ok_or_else(expected)?)
        }
        false => None,
    };
    for value in values {
        *value = match fields.next() {
            Some("-") => None,
            Some(field) => Some(number(field).ok_or_else(expected)?),
            None => return Err(expected()),
        };
    }
    match fields.next() {
        None => Ok(time),
        Some(_) => Err(expected()),
    }
}

fn number(field: &str) -> Option<f64> {
    field.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::parse;

    #[test]
    fn a_line_has_a_time_and_a_value_for_each_signal() {
        let mut values = [None; 3];
        assert_eq!(parse(" 12.5\t1 -  -3e-2 ", true, &mut values), Ok(Some(12.5)));
        assert_eq!(values, [Some(1.0), None, Some(-0.03)]);
        assert_eq!(parse("1 inf nan", false, &mut values), Ok(None));
        assert_eq!(values[1], Some(f64::INFINITY));
        assert!(values[2].is_some_and(f64::is_nan));
    }

    #[test]
    fn other_lines_are_refused() {
        let mut values = [None; 2];
        let expected = "expected a time and 2 values, separated by white space";
        for line in ["1 2", "1 2 3 4", "x 1 2", "1 2 x", "- 1 2", "nan 1 2", "1,2,3", ""] {
            assert_eq!(parse(line, true, &mut values), Err(expected.to_owned()), "{line}");
        }
        let error = parse("1 2", false, &mut values[..1]).unwrap_err();
        assert_eq!(error, "expected 1 value, separated by white space");
    }
}
