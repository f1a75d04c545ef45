//! Units of constants and signals.

use rtf_monitor::{Formula, Monitor, UnitError};

/// The unit of a signal is the part of its name after `_in_`; `u…` has no known unit.
fn check(text: &str) -> Result<Formula, Vec<UnitError>> {
    let unit_of = |name: &str| match name.split_once("_in_") {
        Some((_, unit)) => Some(unit.replace("_per_", "/")),
        None if name.starts_with('u') => None,
        None => Some(String::new()),
    };
    Formula::parse(text).unwrap().check_units(&unit_of)
}

#[test]
fn compatible_units() {
    for text in [
        "q_in_rad < 5deg",
        "abs(q_in_rad - goal_in_deg) < 0.02",
        "rate(q_in_rad) < 3rad/s and rate(q_in_rad) < 30deg/s",
        "v_in_m_per_s * 2s < 3m",
        "p_in_W == i_in_A * u_in_V",
        "ratio < 20% and ratio < 0.2",
        "temperature_in_degC < 80°C",
        "x_in_ticks < 5ticks",
        "min(q_in_rad, 3deg, 1) < 1rad",
        "unknown < 5",
        "unknown < q_in_rad",
        "w_in_rad_per_s * r_in_m / 1rad < 2m/s",
        "f_in_Hz > 1 / 10ms",
        "reached_in_rad",
    ] {
        let checked = check(text);
        assert!(checked.is_ok(), "{text}: {checked:?}");
        assert!(Monitor::new(&checked.unwrap()).is_ok());
    }
}

#[test]
fn errors_are_reported_at_once_and_with_positions() {
    let text = "q_in_rad < 5m and rate(q_in_rad) > 1rad or unknown < 3deg";
    let errors = check(text).unwrap_err();
    let found: Vec<_> =
        errors.iter().map(|error| (&text[error.range.clone()], error.message.as_str())).collect();
    assert_eq!(
        found,
        [
            ("5m", "the units do not match: `rad` and `m`"),
            ("1rad", "the units do not match: `rad/s` and `rad`"),
            ("3deg", "`deg` cannot be converted: the unit of the signal is not known"),
        ]
    );
    let text = "5deg > q_in_m";
    assert_eq!(check(text).unwrap_err()[0].range, 0..4);
    assert_eq!(
        check("ratio + q_in_m < 1").unwrap_err()[0].message,
        "the units do not match: a pure number and `m`"
    );
    assert!(check("q_in_degC < 300K").is_err());
}

#[test]
fn constants_with_units_are_converted_before_monitoring() {
    let formula = Formula::parse("q < 5deg").unwrap();
    assert_eq!(
        Monitor::new(&formula).unwrap_err().to_string(),
        "the units of the constants are not converted"
    );
}
