//! The arguments with which Lua calls the functions of the host.

use std::time::Duration;

use mlua::{Lua, LuaString, Table};
use rtf_host::{Inquiry, Sample, Session};
use rtf_model::{
    Alignment, Comparison, Location, Measurement, Message, MessageKind, TrajectoryCheck,
};

/// No sleep is longer: more seconds than any clock can add.
const LONGEST: Duration = Duration::from_secs(1 << 40);

/// `kind, text, file, line, comparison, critical`
pub(crate) type MessageArgs =
    (String, LuaString, Option<LuaString>, Option<u32>, Option<Table>, Option<bool>);

pub(crate) fn message(
    (kind, text, file, line, comparison, critical): MessageArgs,
) -> mlua::Result<Message> {
    let kind = match kind.as_str() {
        "report" => MessageKind::Report,
        "check" => MessageKind::Check,
        "failure" => MessageKind::Failure,
        _ => MessageKind::Error,
    };
    Ok(Message {
        comparison: comparison.map(|numbers| comparison_of(&numbers)).transpose()?,
        critical: critical.unwrap_or(false),
        ..Message::new(kind, text.to_string_lossy(), location(file.as_ref(), line))
    })
}

/// `text, choices, timeout, default, picture, file, line`
pub(crate) type QuestionArgs = (
    LuaString,
    Vec<LuaString>,
    f64,
    Option<LuaString>,
    Option<LuaString>,
    Option<LuaString>,
    Option<u32>,
);

pub(crate) fn inquiry(
    (text, choices, timeout, default, picture, file, line): QuestionArgs,
) -> Inquiry {
    Inquiry {
        text: text.to_string_lossy(),
        choices: choices.iter().map(LuaString::to_string_lossy).collect(),
        default: default.as_ref().map(LuaString::to_string_lossy),
        timeout: duration(timeout),
        picture: picture.as_ref().map(LuaString::to_string_lossy),
        location: location(file.as_ref(), line),
    }
}

pub(crate) fn duration(seconds: f64) -> Duration {
    Duration::try_from_secs_f64(seconds.max(0.0)).unwrap_or(LONGEST).min(LONGEST)
}

/// `name, value, unit, low, high, file, line`
pub(crate) type MeasureArgs =
    (LuaString, f64, LuaString, Option<f64>, Option<f64>, Option<LuaString>, Option<u32>);

pub(crate) fn measurement((name, value, unit, low, high, file, line): MeasureArgs) -> Measurement {
    Measurement {
        name: name.to_string_lossy(),
        value: finite(value),
        unit: unit.to_string_lossy(),
        low: low.and_then(finite),
        high: high.and_then(finite),
        location: location(file.as_ref(), line),
        ..Measurement::default()
    }
}

/// `name, value, unit, low, high, time, file, line`
pub(crate) type SampleArgs = (
    LuaString,
    f64,
    LuaString,
    Option<f64>,
    Option<f64>,
    Option<f64>,
    Option<LuaString>,
    Option<u32>,
);

/// Takes a sample; returns whether it is within its limits.
pub(crate) fn sample(
    session: &Session,
    (name, value, unit, low, high, time, file, line): SampleArgs,
) -> bool {
    let file = file.as_ref().map(LuaString::to_string_lossy);
    session.sample(&Sample {
        name: &name.to_string_lossy(),
        value,
        unit: &unit.to_string_lossy(),
        low: low.and_then(finite),
        high: high.and_then(finite),
        time,
        place: file.as_deref().map(|file| (file, line.unwrap_or(0))),
    })
}

/// A check of a trajectory: name, reference, tolerance, alignment, band, place.
pub(crate) struct Trajectory(pub(crate) TrajectoryCheck);

impl mlua::FromLuaMulti for Trajectory {
    fn from_lua_multi(values: mlua::MultiValue, lua: &Lua) -> mlua::Result<Self> {
        type Arguments =
            (LuaString, LuaString, f64, bool, Option<f64>, Option<LuaString>, Option<u32>);
        let (name, reference, tolerance, warps, band, file, line) =
            Arguments::from_lua_multi(values, lua)?;
        Ok(Self(TrajectoryCheck {
            name: name.to_string_lossy(),
            reference: reference.to_string_lossy(),
            tolerance,
            align: if warps { Alignment::Dtw } else { Alignment::Time },
            band,
            location: location(file.as_ref(), line),
            case: None,
        }))
    }
}

fn comparison_of(numbers: &Table) -> mlua::Result<Comparison> {
    let all = |name| -> mlua::Result<Vec<Option<f64>>> {
        Ok(numbers.get::<Vec<f64>>(name)?.into_iter().map(finite).collect())
    };
    Ok(Comparison {
        expected: all("expected")?,
        got: all("got")?,
        tolerance: numbers.get("tolerance")?,
        worst: numbers.get("worst")?,
    })
}

pub(crate) fn location(file: Option<&LuaString>, line: Option<u32>) -> Option<Location> {
    Some(Location { file: file?.to_string_lossy(), line: line.unwrap_or(0) })
}

/// JSON has only finite numbers.
fn finite(number: f64) -> Option<f64> {
    number.is_finite().then_some(number)
}
