//! The table of functions that a plug-in gets from its host.
#![expect(unsafe_code, reason = "called by foreign code with its pointers")]

// `rtf-fuzz` includes this file: without a path, it would look elsewhere.
#[path = "host_table/episodes.rs"]
mod episodes;

use std::ffi::{c_char, c_int, c_void};
use std::time::Duration;

use ::rtf_host::{CaseEnd, FaultRequest, Inquiry, Sample, Session};
use rtf_model::protocol::{FixtureValue, MonitorDeclaration, Plugin};
use rtf_model::{
    Alignment, Attachment, Measurement, Message, MessageKind, Parameter, PictureCheck,
    TrajectoryCheck, value_text,
};
use serde_json::Value;

use crate::abi::{
    RTF_ABI_MAJOR, RTF_ABI_MINOR, RTF_ALIGN_DTW, RTF_ALIGN_TIME, RTF_DONE, RTF_FAULT_INJECT,
    RTF_FAULT_REMOVE, RTF_MESSAGE_CHECK, RTF_MESSAGE_ERROR, RTF_MESSAGE_FAILURE,
    RTF_MESSAGE_REPORT, RTF_STOPPED, RTF_VALUE_JSON, RTF_VALUE_TEXT, rtf_attachment, rtf_case,
    rtf_host, rtf_measurement, rtf_message, rtf_monitor, rtf_parameter, rtf_picture, rtf_question,
    rtf_sample, rtf_text, rtf_trajectory,
};
use crate::conversion::{comparison, finite, lend, location, slice, text};

/// The context of the functions: one per plug-in, never freed, because the plug-in's
/// threads may still use it.
#[derive(Debug)]
struct HostContext {
    session: Session,
    plugin: &'static Plugin,
    /// The test's values of a matrix. They refer to `plugin`.
    parameters: Vec<rtf_parameter>,
    /// The values of fixtures. They refer to leaked texts.
    fixture_values: Vec<rtf_parameter>,
}

/// Makes the table for a plug-in.
pub(crate) fn for_plugin(session: &Session, plugin: &Plugin) -> &'static rtf_host {
    let plugin: &'static Plugin = Box::leak(Box::new(plugin.clone()));
    let parameters = entries(&plugin.parameters);
    let fixture_values = entries(Vec::leak(fixture_value_texts(plugin)));
    let context = HostContext { session: session.clone(), plugin, parameters, fixture_values };
    let context = Box::into_raw(Box::new(context)).cast::<c_void>();
    Box::leak(Box::new(rtf_host {
        abi_major: RTF_ABI_MAJOR,
        abi_minor: RTF_ABI_MINOR,
        size: size_of::<rtf_host>(),
        context,
        message,
        measure,
        attach,
        collapsed,
        interrupted,
        wait,
        name,
        param,
        environment,
        repetition,
        sample,
        case_begin,
        case_end,
        plan_cases,
        skip,
        parameters: self::parameters,
        provide,
        fixture_values: self::fixture_values,
        ask,
        check_trajectory,
        monitor,
        fault,
        check_picture,
        slots: episodes::slots,
        take_episode: episodes::take_episode,
        enter_episode: episodes::enter_episode,
        leave_episode: episodes::leave_episode,
        finish_episode: episodes::finish_episode,
    }))
}

fn entries(values: &'static [Parameter]) -> Vec<rtf_parameter> {
    let entry =
        |own: &'static Parameter| rtf_parameter { name: lend(&own.name), value: lend(&own.value) };
    values.iter().map(entry).collect()
}

fn fixture_value_texts(plugin: &Plugin) -> Vec<Parameter> {
    let values = plugin.fixture_values.iter();
    let text = |own: &FixtureValue| Parameter {
        name: own.name.clone(),
        value: value_text(&own.value).into_owned(),
    };
    values.map(text).collect()
}

unsafe extern "C" fn message(context: *mut c_void, message: *const rtf_message) {
    // SAFETY: the pointers are valid by spec/plugin-abi.md.
    unsafe {
        let message = &*message;
        let kind = match message.kind {
            RTF_MESSAGE_REPORT => MessageKind::Report,
            RTF_MESSAGE_CHECK => MessageKind::Check,
            RTF_MESSAGE_FAILURE => MessageKind::Failure,
            RTF_MESSAGE_ERROR => MessageKind::Error,
            // An unknown kind must not look harmless.
            _ => MessageKind::Error,
        };
        self::context(context).session.message(Message {
            comparison: message.comparison.as_ref().map(|numbers| comparison(numbers)),
            critical: message.critical != 0,
            ..Message::new(kind, text(message.text), location(message.file, message.line))
        });
    }
}

unsafe extern "C" fn measure(context: *mut c_void, measurement: *const rtf_measurement) -> c_int {
    // SAFETY: the pointers are valid by spec/plugin-abi.md.
    unsafe {
        let measurement = &*measurement;
        let holds = self::context(context).session.measure(Measurement {
            name: text(measurement.name),
            value: finite(measurement.value),
            unit: text(measurement.unit),
            low: measurement.low.as_ref().copied().filter(|low| *low != f64::NEG_INFINITY),
            high: measurement.high.as_ref().copied().filter(|high| *high != f64::INFINITY),
            location: location(measurement.file, measurement.line),
            ..Measurement::default()
        });
        c_int::from(holds)
    }
}

unsafe extern "C" fn sample(context: *mut c_void, sample: *const rtf_sample) -> c_int {
    // SAFETY: the pointers are valid by spec/plugin-abi.md.
    unsafe {
        let sample = &*sample;
        let place = location(sample.file, sample.line);
        let holds = self::context(context).session.sample(&Sample {
            name: &text(sample.name),
            value: sample.value,
            unit: &text(sample.unit),
            low: sample.low.as_ref().copied().filter(|low| *low != f64::NEG_INFINITY),
            high: sample.high.as_ref().copied().filter(|high| *high != f64::INFINITY),
            time: sample.time.as_ref().copied(),
            place: place.as_ref().map(|place| (place.file.as_str(), place.line)),
        });
        c_int::from(holds)
    }
}

unsafe extern "C" fn check_trajectory(context: *mut c_void, check: *const rtf_trajectory) {
    // SAFETY: the pointers are valid by spec/plugin-abi.md.
    unsafe {
        let check = &*check;
        let session = &self::context(context).session;
        let align = match check.align {
            RTF_ALIGN_TIME => Alignment::Time,
            RTF_ALIGN_DTW => Alignment::Dtw,
            other => {
                let text = format!("a trajectory has the unknown alignment {other}");
                let location = location(check.file, check.line);
                return session.message(Message::new(MessageKind::Error, text, location));
            }
        };
        session.check_trajectory(TrajectoryCheck {
            name: text(check.name),
            reference: text(check.reference),
            tolerance: check.tolerance,
            align,
            band: check.band.as_ref().copied(),
            location: location(check.file, check.line),
            case: None,
        });
    }
}

unsafe extern "C" fn monitor(context: *mut c_void, monitor: *const rtf_monitor) {
    // SAFETY: the pointers are valid by spec/plugin-abi.md.
    unsafe {
        let monitor = &*monitor;
        let declared = MonitorDeclaration::new(
            &text(monitor.formula),
            &text(monitor.name),
            &text(monitor.severity),
            location(monitor.file, monitor.line),
        );
        let session = &self::context(context).session;
        match declared {
            Ok(declared) => session.monitor(declared),
            Err(problem) => report_error(session, problem),
        }
    }
}

unsafe extern "C" fn fault(
    context: *mut c_void,
    action: i32,
    name: rtf_text,
    file: *const c_char,
    line: u32,
) -> i32 {
    // SAFETY: the pointers are valid by spec/plugin-abi.md.
    let (context, name, location) =
        unsafe { (self::context(context), text(name), location(file, line)) };
    let request = match action {
        RTF_FAULT_INJECT => FaultRequest::Inject,
        RTF_FAULT_REMOVE => FaultRequest::Remove,
        other => {
            report_error(&context.session, format!("unknown action {other} of a fault"));
            return RTF_STOPPED;
        }
    };
    match context.session.fault(context.plugin, request, &name, location) {
        true => RTF_DONE,
        false => RTF_STOPPED,
    }
}

unsafe extern "C" fn attach(context: *mut c_void, attachment: *const rtf_attachment) {
    // SAFETY: the pointers are valid by spec/plugin-abi.md.
    unsafe {
        let attachment = &*attachment;
        let path = text(attachment.path);
        let mut name = text(attachment.name);
        if name.is_empty() {
            let last = std::path::Path::new(&path).file_name();
            name = last.map_or_else(|| path.clone(), |last| last.to_string_lossy().into_owned());
        }
        let media_type = text(attachment.media_type);
        let session = &self::context(context).session;
        if let Err(error) = session.attach(Attachment {
            name,
            path: path.clone(),
            media_type,
            ..Attachment::default()
        }) {
            report_error(session, format!("`{path}` cannot be attached: {error}"));
        }
    }
}

unsafe extern "C" fn check_picture(context: *mut c_void, check: *const rtf_picture) {
    // SAFETY: the pointers are valid by spec/plugin-abi.md.
    unsafe {
        let check = &*check;
        let path = text(check.picture);
        let session = &self::context(context).session;
        let reference = PictureCheck {
            reference: text(check.reference),
            tolerance: check.tolerance,
            location: location(check.file, check.line),
        };
        if let Err(error) = session.check_picture((text(check.name), path.clone()), reference) {
            report_error(session, format!("`{path}` cannot be attached: {error}"));
        }
    }
}

unsafe extern "C" fn collapsed(context: *mut c_void, reason: rtf_text) {
    // SAFETY: the pointers are valid by spec/plugin-abi.md.
    unsafe { self::context(context).session.collapsed(&text(reason)) }
}

unsafe extern "C" fn interrupted(context: *mut c_void) -> c_int {
    // SAFETY: the context is that of the table.
    c_int::from(unsafe { self::context(context) }.session.interrupted())
}

unsafe extern "C" fn wait(context: *mut c_void, seconds: f64) -> c_int {
    // SAFETY: the context is that of the table.
    c_int::from(unsafe { self::context(context) }.session.wait(duration(seconds)))
}

fn duration(seconds: f64) -> Duration {
    let at_least_zero = if seconds > 0.0 { seconds } else { 0.0 };
    Duration::try_from_secs_f64(at_least_zero).unwrap_or(Duration::MAX)
}

unsafe extern "C" fn ask(
    context: *mut c_void,
    question: *const rtf_question,
    answer: *mut rtf_text,
) -> i32 {
    // SAFETY: the pointers are valid by spec/plugin-abi.md.
    unsafe {
        let question = &*question;
        let choices = slice(question.choices, question.choice_count);
        let given = |value: rtf_text| Some(text(value)).filter(|value| !value.is_empty());
        let answered = self::context(context).session.ask(Inquiry {
            text: text(question.text),
            choices: choices.iter().map(|choice| text(*choice)).collect(),
            default: given(question.default_answer),
            timeout: duration(question.timeout),
            picture: given(question.picture),
            location: location(question.file, question.line),
        });
        match answered {
            Some(text) => {
                *answer = lend(String::leak(text));
                RTF_DONE
            }
            None => RTF_STOPPED,
        }
    }
}

unsafe extern "C" fn name(context: *mut c_void) -> rtf_text {
    // SAFETY: the context is that of the table.
    lend(&unsafe { self::context(context) }.plugin.name)
}

unsafe extern "C" fn param(context: *mut c_void) -> rtf_text {
    // SAFETY: the context is that of the table.
    lend(&unsafe { self::context(context) }.plugin.param)
}

unsafe extern "C" fn environment(context: *mut c_void) -> rtf_text {
    // SAFETY: the context is that of the table.
    lend(&unsafe { self::context(context) }.plugin.environment)
}

unsafe extern "C" fn repetition(context: *mut c_void) -> u32 {
    // SAFETY: the context is that of the table.
    unsafe { self::context(context) }.plugin.repetition.max(1)
}

unsafe extern "C" fn case_begin(context: *mut c_void, test_case: *const rtf_case) -> c_int {
    // SAFETY: the pointers are valid by spec/plugin-abi.md.
    unsafe {
        let case = &*test_case;
        let parameters = slice(case.parameters, case.parameter_count);
        let parameters = parameters
            .iter()
            .map(|own| Parameter { name: text(own.name), value: text(own.value) })
            .collect();
        let location = location(case.file, case.line);
        let session = &self::context(context).session;
        c_int::from(session.begin_case(text(case.name), parameters, location))
    }
}

unsafe extern "C" fn case_end(context: *mut c_void, result: i32) {
    let end = if result == RTF_DONE { CaseEnd::Done } else { CaseEnd::Stopped };
    // SAFETY: the context is that of the table.
    unsafe { self::context(context) }.session.end_case(end);
}

unsafe extern "C" fn plan_cases(context: *mut c_void, names: *const rtf_text, count: usize) {
    // SAFETY: the pointers are valid by spec/plugin-abi.md.
    unsafe {
        let names = slice(names, count).iter().map(|name| text(*name)).collect();
        self::context(context).session.plan_cases(names);
    }
}

unsafe extern "C" fn skip(context: *mut c_void, reason: rtf_text) {
    // SAFETY: the pointers are valid by spec/plugin-abi.md.
    unsafe { self::context(context).session.skip(&text(reason)) }
}

unsafe extern "C" fn parameters(context: *mut c_void, count: *mut usize) -> *const rtf_parameter {
    // SAFETY: the pointers are valid by spec/plugin-abi.md.
    unsafe { list_entries(&self::context(context).parameters, count) }
}

unsafe extern "C" fn provide(context: *mut c_void, name: rtf_text, kind: i32, value: rtf_text) {
    // SAFETY: the pointers are valid by spec/plugin-abi.md.
    let (session, name, value) =
        unsafe { (&self::context(context).session, text(name), text(value)) };
    let value = match kind {
        RTF_VALUE_TEXT => Ok(Value::String(value)),
        RTF_VALUE_JSON => serde_json::from_str(&value)
            .map_err(|error| format!("the value of `{name}` is not JSON: {error}")),
        _ => Err(format!("the value of `{name}` has the unknown kind {kind}")),
    };
    match value {
        Ok(value) => session.provide(name, value),
        Err(error) => report_error(session, error),
    }
}

unsafe extern "C" fn fixture_values(
    context: *mut c_void,
    count: *mut usize,
) -> *const rtf_parameter {
    // SAFETY: the pointers are valid by spec/plugin-abi.md.
    unsafe { list_entries(&self::context(context).fixture_values, count) }
}

/// # Safety
/// `count` is valid.
unsafe fn list_entries(entries: &[rtf_parameter], count: *mut usize) -> *const rtf_parameter {
    // SAFETY: the caller's promise.
    unsafe { *count = entries.len() };
    entries.as_ptr()
}

/// Reports an error of a call that the plug-in made.
fn report_error(session: &Session, text: String) {
    session.message(Message::new(MessageKind::Error, text, None));
}

/// # Safety
/// The pointer is the `context` of a table that [`for_plugin`] made.
unsafe fn context(context: *mut c_void) -> &'static HostContext {
    // SAFETY: it was made from such a box, which is never freed.
    unsafe { &*context.cast::<HostContext>() }
}
