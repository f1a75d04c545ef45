//! The time on the clock of the place where the machine is.

use std::path::Path;

use jiff::tz::TimeZone;
use jiff::{Timestamp, Zoned};

/// The time zone of the machine, on systems that have this file.
const LOCAL_ZONE: &str = "/etc/localtime";

/// The present local time. [`Zoned::now`] would look up the name of the zone, and list all zones for
/// it: several hundred system calls.
#[must_use]
pub fn now() -> Zoned {
    let zone = match std::env::var_os("TZ") {
        None => read_zone(Path::new(LOCAL_ZONE)),
        Some(_) => None,
    };
    Timestamp::now().to_zoned(zone.unwrap_or_else(TimeZone::system))
}

fn read_zone(file: &Path) -> Option<TimeZone> {
    TimeZone::tzif("", &std::fs::read(file).ok()?).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_offset_is_that_of_the_system() {
        let (expected, now) = (Zoned::now(), now());
        assert_eq!(now.offset(), expected.offset());
        assert!((now.timestamp().as_second() - expected.timestamp().as_second()).abs() <= 60);
    }

    #[test]
    fn what_is_no_zone_is_ignored() {
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("zone");
        std::fs::write(&file, "Europe/Berlin").unwrap();
        assert_eq!(read_zone(&file), None);
        assert_eq!(read_zone(&dir.path().join("missing")), None);
    }
}
