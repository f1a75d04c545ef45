//! The units that are known by name. `spec/monitors.md` has the same table.

use std::f64::consts::{PI, TAU};

/// Base units and their exponents.
type Powers = &'static [(&'static str, i32)];

const NUMBER: Powers = &[];
const ANGLE: Powers = &[("rad", 1)];
const LENGTH: Powers = &[("m", 1)];
const TIME: Powers = &[("s", 1)];
const FREQUENCY: Powers = &[("s", -1)];
const ANGULAR_RATE: Powers = &[("rad", 1), ("s", -1)];
const MASS: Powers = &[("kg", 1)];
const FORCE: Powers = &[("kg", 1), ("m", 1), ("s", -2)];
const ENERGY: Powers = &[("kg", 1), ("m", 2), ("s", -2)];
const POWER: Powers = &[("kg", 1), ("m", 2), ("s", -3)];
const PRESSURE: Powers = &[("kg", 1), ("m", -1), ("s", -2)];
const CURRENT: Powers = &[("A", 1)];
const VOLTAGE: Powers = &[("kg", 1), ("m", 2), ("s", -3), ("A", -1)];
const RESISTANCE: Powers = &[("kg", 1), ("m", 2), ("s", -3), ("A", -2)];
const DATA: Powers = &[("B", 1)];
// Degrees Celsius have another zero than kelvins, so no factor converts them.
const CELSIUS: Powers = &[("°C", 1)];
const KELVIN: Powers = &[("K", 1)];

/// Names, sizes and base units.
const UNITS: [(&str, f64, Powers); 61] = [
    ("%", 0.01, NUMBER),
    ("rad", 1.0, ANGLE),
    ("mrad", 1e-3, ANGLE),
    ("deg", PI / 180.0, ANGLE),
    ("°", PI / 180.0, ANGLE),
    ("rev", TAU, ANGLE),
    ("rpm", TAU / 60.0, ANGULAR_RATE),
    ("m", 1.0, LENGTH),
    ("km", 1e3, LENGTH),
    ("cm", 1e-2, LENGTH),
    ("mm", 1e-3, LENGTH),
    ("um", 1e-6, LENGTH),
    ("µm", 1e-6, LENGTH),
    ("s", 1.0, TIME),
    ("ms", 1e-3, TIME),
    ("us", 1e-6, TIME),
    ("µs", 1e-6, TIME),
    ("ns", 1e-9, TIME),
    ("min", 60.0, TIME),
    ("h", 3600.0, TIME),
    ("Hz", 1.0, FREQUENCY),
    ("kHz", 1e3, FREQUENCY),
    ("MHz", 1e6, FREQUENCY),
    ("kg", 1.0, MASS),
    ("g", 1e-3, MASS),
    ("N", 1.0, FORCE),
    ("kN", 1e3, FORCE),
    ("mN", 1e-3, FORCE),
    ("Nm", 1.0, ENERGY),
    ("mNm", 1e-3, ENERGY),
    ("J", 1.0, ENERGY),
    ("kJ", 1e3, ENERGY),
    ("Wh", 3600.0, ENERGY),
    ("W", 1.0, POWER),
    ("mW", 1e-3, POWER),
    ("kW", 1e3, POWER),
    ("Pa", 1.0, PRESSURE),
    ("hPa", 1e2, PRESSURE),
    ("kPa", 1e3, PRESSURE),
    ("bar", 1e5, PRESSURE),
    ("mbar", 1e2, PRESSURE),
    ("A", 1.0, CURRENT),
    ("mA", 1e-3, CURRENT),
    ("V", 1.0, VOLTAGE),
    ("mV", 1e-3, VOLTAGE),
    ("kV", 1e3, VOLTAGE),
    ("ohm", 1.0, RESISTANCE),
    ("Ω", 1.0, RESISTANCE),
    ("°C", 1.0, CELSIUS),
    ("degC", 1.0, CELSIUS),
    ("K", 1.0, KELVIN),
    ("B", 1.0, DATA),
    ("bytes", 1.0, DATA),
    ("kB", 1e3, DATA),
    ("KB", 1e3, DATA),
    ("MB", 1e6, DATA),
    ("GB", 1e9, DATA),
    ("KiB", 1024.0, DATA),
    ("MiB", 1_048_576.0, DATA),
    ("GiB", 1_073_741_824.0, DATA),
    ("bit", 0.125, DATA),
];

/// The size and base units of a name.
pub(super) fn find(name: &str) -> Option<(f64, Powers)> {
    let found = UNITS.iter().find(|(known, _, _)| *known == name);
    found.map(|(_, scale, powers)| (*scale, *powers))
}
